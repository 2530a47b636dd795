#include "impinge/boundaries/face.hpp"

namespace impinge {

template <int Dim>
Reflection<Dim> reflection_at(const Face<Dim>& plane) {
  Reflection<Dim> result;
  for (int k = 0; k < Dim; ++k) result.linear.row[static_cast<std::size_t>(k)] -= 2.0 * plane.normal[k] * plane.normal;
  result.shift = 2.0 * dot(plane.point, plane.normal) * plane.normal;
  return result;
}

template <int Dim>
Reflection<Dim> product(const Reflection<Dim>& outer, const Reflection<Dim>& inner) {
  Reflection<Dim> result;
  for (int r = 0; r < Dim; ++r) {
    Vector<Dim>& row = result.linear.row[static_cast<std::size_t>(r)];
    row = {};
    for (int k = 0; k < Dim; ++k)
      row += outer.linear.row[static_cast<std::size_t>(r)][k] * inner.linear.row[static_cast<std::size_t>(k)];
  }
  result.shift = outer.linear * inner.shift + outer.shift;
  return result;
}

template Reflection<2> reflection_at(const Face<2>&);
template Reflection<3> reflection_at(const Face<3>&);
template Reflection<2> product(const Reflection<2>&, const Reflection<2>&);
template Reflection<3> product(const Reflection<3>&, const Reflection<3>&);

}  // namespace impinge
