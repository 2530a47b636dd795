#include "impinge/parallel/cell_curve.hpp"

#include <algorithm>
#include <bit>

namespace impinge {
namespace {

// The reflections and rotations of one level, whose bit is `level`; their own inverse axis by axis.
template <std::size_t n>
void turn(std::array<std::uint32_t, n>& x, std::size_t axis, std::uint32_t level) {
  const std::uint32_t below = level - 1;
  if (x[axis] & level) {
    x[0] ^= below;
  } else {
    const std::uint32_t change = (x[0] ^ x[axis]) & below;
    x[0] ^= change;
    x[axis] ^= change;
  }
}

}  // namespace

template <int Dim>
CellCurve<Dim>::CellCurve(const CellGrid<Dim>& cells)
    : levels_(std::bit_width(static_cast<unsigned>(std::ranges::max(cells.extent()) - 1))) {}

template <int Dim>
std::int64_t CellCurve<Dim>::key(const std::array<int, Dim>& coordinates) const {
  std::array<std::uint32_t, Dim> x;
  for (std::size_t k = 0; k < Dim; ++k) x[k] = static_cast<std::uint32_t>(coordinates[k]);
  const std::uint32_t top = levels_ > 0 ? 1U << (levels_ - 1) : 0U;
  for (std::uint32_t level = top; level > 1; level >>= 1)
    for (std::size_t k = 0; k < Dim; ++k) turn(x, k, level);
  for (std::size_t k = 1; k < Dim; ++k) x[k] ^= x[k - 1];
  std::uint32_t gray = 0;
  for (std::uint32_t level = top; level > 1; level >>= 1)
    if (x[Dim - 1] & level) gray ^= level - 1;
  std::int64_t key = 0;
  for (int level = levels_ - 1; level >= 0; --level)
    for (std::size_t k = 0; k < Dim; ++k) key = 2 * key + ((x[k] ^ gray) >> level & 1U);
  return key;
}

template <int Dim>
std::array<int, Dim> CellCurve<Dim>::coordinates(std::int64_t key) const {
  std::array<std::uint32_t, Dim> x{};
  for (int bit = bits() - 1; bit >= 0; --bit) {
    std::uint32_t& on_axis = x[static_cast<std::size_t>(Dim - 1 - bit % Dim)];
    on_axis = 2 * on_axis + static_cast<std::uint32_t>(key >> bit & 1);
  }
  const std::uint32_t gray = x[Dim - 1] >> 1;
  for (std::size_t k = Dim - 1; k > 0; --k) x[k] ^= x[k - 1];
  x[0] ^= gray;
  for (int level = 1; level < levels_; ++level)
    for (std::size_t k = Dim; k-- > 0;) turn(x, k, 1U << level);
  std::array<int, Dim> coordinates;
  for (std::size_t k = 0; k < Dim; ++k) coordinates[k] = static_cast<int>(x[k]);
  return coordinates;
}

template class CellCurve<2>;
template class CellCurve<3>;

}  // namespace impinge
