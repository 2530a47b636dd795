#pragma once
// What each outlet of a scene has swallowed.

#include <cstdint>
#include <string>
#include <vector>

#include "impinge/boundaries/scene.hpp"

namespace impinge {

/// The fluid particles that have left through each outlet that is a region, since the start of the run, restarts
/// included. Each stands for the volume dp^2, in three dimensions dp^3.
template <int Dim>
class OutletCounts {
 public:
  explicit OutletCounts(const Scene<Dim>& scene);

  bool empty() const { return names_.empty(); }

  /// Names and units of the values.
  std::vector<std::string> columns() const;

  /// `outlets`: those of the scene, as they have counted. Not collective; the same on all ranks.
  std::vector<std::int64_t> measure(const std::vector<Outlet<Dim>>& outlets) const;

 private:
  std::vector<std::string> names_;
};

}  // namespace impinge
