#include "impinge/particles/kernel.hpp"

#include <cmath>
#include <utility>

#include "impinge/core/vector.hpp"

namespace impinge {

template <int Dim>
LatticeSums lattice_sums(KernelType type, double effective_radius) {
  const int reach = static_cast<int>(std::ceil(effective_radius));
  double sum = 0.0;
  double packing = 0.0;
  double second_moment = 0.0;
  int neighbours = 0;
  double half_space = 0.0;  // the surface's normal is the last axis; only neighbours on it or below count
  const auto add = [&](const Vector<Dim>& offset) {
    const double r = norm(offset);
    if (r == 0.0 || r >= effective_radius) return;
    const auto [weight, packed] = with_kernel(type, [&]<class Kernel>(Kernel) {
      const double w = Kernel::weight(r, effective_radius);
      return std::pair(w, packing_weight<Dim, Kernel>(w));
    });
    ++neighbours;
    sum += weight;
    packing += packed;
    second_moment += weight * r * r;
    if (offset[Dim - 1] < 0.0) half_space -= weight * offset[Dim - 1] / r;
  };
  const int depth = Dim == 3 ? reach : 0;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -depth; z <= depth; ++z) {
        Vector<Dim> offset;
        offset[0] = x;
        offset[1] = y;
        if constexpr (Dim == 3) offset[2] = z;
        add(offset);
      }
    }
  }
  return {sum, packing, second_moment / sum, Dim * half_space / sum, neighbours};
}

template LatticeSums lattice_sums<2>(KernelType, double);
template LatticeSums lattice_sums<3>(KernelType, double);

}  // namespace impinge
