#include "impinge/method/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "impinge/method/step_report.hpp"

namespace impinge {
namespace {

/// The largest value of a number that becomes an integer; nothing for one that stays what it is.
std::optional<double> largest(const std::string& name) {
  constexpr double exact = 9007199254740992.0;  // up to there every integer is a double
  if (name == "limit") return static_cast<double>(step_limit_names.size() - 1);
  if (name == "iterations" || name.starts_with("coarse_")) return std::numeric_limits<int>::max();
  if (name.starts_with("outlet_")) return exact;
  for (const char* count : {"step", "particles", "fluid", "in", "out", "lost", "next_id", "cells"})
    if (name == count) return exact;
  return {};
}

std::string problem_of_number(const std::string& name, double value) {
  if (!std::isfinite(value)) return fmt::format("{} is not a finite number", name);
  const auto most = largest(name);
  if (most && !(value >= 0.0 && value <= *most && value == std::floor(value)))
    return fmt::format("{} = {} is out of range", name, value);
  for (const char* positive : {"time", "dt", "free_dt", "max_speed"})
    if (name == positive && value < 0.0) return fmt::format("{} = {} is negative", name, value);
  return "";
}

/// True where the rows have at most `longest` entries and a positive diagonal.
bool are_rows(const CoarseRows& coarse, std::int64_t longest, std::int64_t first_node, std::int64_t nodes) {
  if (coarse.length.size() != coarse.cell.size() || coarse.value.size() != coarse.column.size()) return false;
  std::size_t entry = 0;
  for (std::size_t row = 0; row < coarse.length.size(); ++row) {
    const std::int64_t length = coarse.length[row];
    if (length < 0 || length > longest || entry + static_cast<std::size_t>(length) > coarse.column.size()) return false;
    bool has_diagonal = false;
    for (const std::size_t end = entry + static_cast<std::size_t>(length); entry < end; ++entry) {
      const std::int64_t column = coarse.column[entry];
      if (column < 0 || column >= nodes || !std::isfinite(coarse.value[entry])) return false;
      has_diagonal |= column == first_node + static_cast<std::int64_t>(row) && coarse.value[entry] > 0.0;
    }
    if (!has_diagonal) return false;
  }
  return entry == coarse.column.size();
}

}  // namespace

template <int Dim>
std::string problem_of(const Checkpoint<Dim>& state, int ranks, std::int64_t first_node, std::int64_t nodes) {
  for (const auto& [name, value] : state.numbers)
    if (const std::string problem = problem_of_number(name, value); !problem.empty()) return problem;
  const auto is_finite = [](const Vector<Dim>& value) { return std::isfinite(norm(value)); };
  if (!std::ranges::all_of(state.particles.position, is_finite) ||
      !std::ranges::all_of(state.searched_position, is_finite))
    return "a position is not finite";
  const std::vector<Segment>& segments = state.segments;
  if (!std::ranges::all_of(segments, [&](const Segment& part) { return part.rank >= 0 && part.rank < ranks; }))
    return "a cell's owner is no rank";
  if (!segments.empty() &&
      (segments.front().first != 0 ||
       std::ranges::adjacent_find(segments, std::greater_equal{}, &Segment::first) != segments.end()))
    return "the cells' owners are in no order";
  const CoarseRows& coarse = state.coarse;
  if (!are_rows(coarse, coarse_stencil<Dim>, first_node, nodes) ||
      std::ranges::adjacent_find(coarse.cell, std::greater_equal{}) != coarse.cell.end())
    return "the coarse matrix is none";
  return "";
}

template std::string problem_of(const Checkpoint<2>&, int, std::int64_t, std::int64_t);
template std::string problem_of(const Checkpoint<3>&, int, std::int64_t, std::int64_t);

}  // namespace impinge
