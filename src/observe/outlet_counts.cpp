#include "impinge/observe/outlet_counts.hpp"

#include <fmt/format.h>

#include "impinge/observe/column.hpp"

namespace impinge {

template <int Dim>
OutletCounts<Dim>::OutletCounts(const Scene<Dim>& scene) {
  for (const Outlet<Dim>& outlet : scene.outlets)
    if (outlet.region) names_.push_back(in_column(outlet.name));
}

template <int Dim>
std::vector<std::string> OutletCounts<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const std::string& name : names_) columns.push_back(fmt::format("{} [1]", name));
  return columns;
}

template <int Dim>
std::vector<std::int64_t> OutletCounts<Dim>::measure(const std::vector<Outlet<Dim>>& outlets) const {
  std::vector<std::int64_t> counts;
  for (const Outlet<Dim>& outlet : outlets)
    if (outlet.region) counts.push_back(outlet.out);
  return counts;
}

template class OutletCounts<2>;
template class OutletCounts<3>;

}  // namespace impinge
