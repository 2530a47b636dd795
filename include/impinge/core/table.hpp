#pragma once
// Where a value lies in a table.

#include <algorithm>
#include <cstddef>
#include <functional>

namespace impinge {

/// Two rows of a table and the share of the way from the first to the second [-].
struct TablePlace {
  std::size_t before;
  std::size_t after;
  double share;
};

/// Where a value lies among the rows of a table that is not empty; `of` gives a row's value, which rises from row to
/// row. Beyond the table it is the first or the last row.
template <class Rows, class Of = std::identity>
TablePlace place_in(const Rows& rows, double value, Of of = {}) {
  const auto next = std::ranges::upper_bound(rows, value, {}, of);
  const auto after = static_cast<std::size_t>(next - rows.begin());
  if (after == 0) return {0, 0, 0.0};
  const std::size_t before = after - 1;
  if (after == rows.size()) return {before, before, 0.0};
  const double first = std::invoke(of, rows[before]), last = std::invoke(of, rows[after]);
  return {before, after, (value - first) / (last - first)};
}

}  // namespace impinge
