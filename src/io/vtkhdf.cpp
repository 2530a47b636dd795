#include "impinge/io/vtkhdf.hpp"

#include <array>
#include <numeric>
#include <string>

namespace impinge {

void create_grid(Hdf5Writer& file) {
  file.create_group("/VTKHDF");
  file.attribute<std::int64_t>("/VTKHDF", "Version", std::array<std::int64_t, 2>{1, 0});
  file.attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
}

void write_cells(Hdf5Writer& file, const std::vector<std::int64_t>& begin, const std::vector<std::uint8_t>& types) {
  const std::int64_t points = begin.back();
  file.dataset("/VTKHDF/NumberOfPoints", std::vector<std::int64_t>{points});
  file.dataset("/VTKHDF/NumberOfCells", std::vector<std::int64_t>{static_cast<std::int64_t>(types.size())});
  file.dataset("/VTKHDF/NumberOfConnectivityIds", std::vector<std::int64_t>{points});
  file.dataset("/VTKHDF/Offsets", begin);
  std::vector<std::int64_t> places(static_cast<std::size_t>(points));
  std::iota(places.begin(), places.end(), std::int64_t{0});
  file.dataset("/VTKHDF/Connectivity", places);
  file.dataset("/VTKHDF/Types", types);
}

}  // namespace impinge
