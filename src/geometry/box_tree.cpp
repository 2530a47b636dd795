#include "impinge/geometry/box_tree.hpp"

#include <cmath>
#include <numeric>

namespace impinge {
namespace {

constexpr int most_in_leaf = 4;

}  // namespace

BoxTree::BoxTree(const std::vector<Box<3>>& boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0);
  if (!boxes.empty()) build(boxes, 0, static_cast<int>(boxes.size()));
}

int BoxTree::build(const std::vector<Box<3>>& boxes, int first, int count) {
  Box<3> around = boxes[static_cast<std::size_t>(items_[static_cast<std::size_t>(first)])];
  for (int k = 1; k < count; ++k) {
    const Box<3>& box = boxes[static_cast<std::size_t>(items_[static_cast<std::size_t>(first + k)])];
    for (int axis = 0; axis < 3; ++axis) {
      around.low[axis] = std::min(around.low[axis], box.low[axis]);
      around.high[axis] = std::max(around.high[axis], box.high[axis]);
    }
  }
  const auto number = static_cast<std::size_t>(nodes_.size());
  nodes_.push_back({.box = around});
  if (count <= most_in_leaf) {
    nodes_[number].first = first;
    nodes_[number].count = count;
    return static_cast<int>(number);
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (around.high[k] - around.low[k] > around.high[axis] - around.low[axis]) axis = k;
  const auto middle = [&](int item) {
    const Box<3>& box = boxes[static_cast<std::size_t>(item)];
    return box.low[axis] + box.high[axis];
  };
  const auto begin = items_.begin() + first;
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](int a, int b) {
    const double one = middle(a), other = middle(b);
    return one < other || (one == other && a < b);
  });
  const int left = build(boxes, first, half), right = build(boxes, first + half, count - half);
  nodes_[number].left = left;
  nodes_[number].right = right;
  return static_cast<int>(number);
}

bool BoxTree::meets(const Box<3>& box, const Vector<3>& from, const Vector<3>& to, double margin) {
  double enter = 0.0, leave = 1.0;
  for (int k = 0; k < 3; ++k) {
    const double low = box.low[k] - margin, high = box.high[k] + margin, way = to[k] - from[k];
    if (way == 0.0) {
      if (from[k] < low || from[k] > high) return false;
      continue;
    }
    const double one = (low - from[k]) / way, other = (high - from[k]) / way;
    enter = std::max(enter, std::min(one, other));
    leave = std::min(leave, std::max(one, other));
  }
  return enter <= leave;
}

std::vector<Box<3>> BoxTree::parts(std::size_t count) const {
  std::vector<int> level;
  if (!empty()) level.push_back(0);
  bool is_split = true;
  while (is_split && level.size() < count) {
    is_split = false;
    std::vector<int> next;
    for (const int number : level) {
      const Node& node = nodes_[static_cast<std::size_t>(number)];
      if (node.left < 0) {
        next.push_back(number);
      } else {
        next.insert(next.end(), {node.left, node.right});
        is_split = true;
      }
    }
    level = next;
  }
  std::vector<Box<3>> result;
  for (const int number : level) result.push_back(nodes_[static_cast<std::size_t>(number)].box);
  return result;
}

}  // namespace impinge
