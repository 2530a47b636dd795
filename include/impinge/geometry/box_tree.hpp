#pragma once
// A tree of boxes around items, by which those near a point or a line are found.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "impinge/core/vector.hpp"

namespace impinge {

class BoxTree {
 public:
  BoxTree() = default;
  /// One box per item [m].
  explicit BoxTree(const std::vector<Box<3>>& boxes);

  bool empty() const { return nodes_.empty(); }
  /// Around all items [m].
  const Box<3>& bounds() const { return nodes_.front().box; }

  /// Calls square = use(item) for the items whose boxes are nearer to a point than the root of the least square so far,
  /// at first `square` [m^2].
  template <class Use>
  void nearest(const Vector<3>& point, double square, Use&& use) const {
    if (!empty()) nearest_in(0, point, square, use);
  }

  /// Calls use(item) for the items whose boxes, made larger by a margin [m], meet a line.
  template <class Use>
  void along(const Vector<3>& from, const Vector<3>& to, double margin, Use&& use) const {
    if (!empty()) along_in(0, from, to, margin, use);
  }

  /// Boxes around parts of the items, about as many as asked for [m].
  std::vector<Box<3>> parts(std::size_t count) const;

 private:
  struct Node {
    Box<3> box;
    int first = 0, count = 0;  // items of a leaf
    int left = -1, right = -1;
  };

  int build(const std::vector<Box<3>>& boxes, int first, int count);
  static double square_distance(const Box<3>& box, const Vector<3>& point) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double off = std::max({box.low[k] - point[k], point[k] - box.high[k], 0.0});
      sum += off * off;
    }
    return sum;
  }
  static bool meets(const Box<3>& box, const Vector<3>& from, const Vector<3>& to, double margin);

  template <class Use>
  void nearest_in(int number, const Vector<3>& point, double& square, Use& use) const {
    const Node& node = nodes_[static_cast<std::size_t>(number)];
    if (node.left < 0) {
      for (int k = 0; k < node.count; ++k) square = use(items_[static_cast<std::size_t>(node.first + k)]);
      return;
    }
    int near = node.left, far = node.right;
    double near_square = square_distance(nodes_[static_cast<std::size_t>(near)].box, point);
    double far_square = square_distance(nodes_[static_cast<std::size_t>(far)].box, point);
    if (far_square < near_square) {
      std::swap(near, far);
      std::swap(near_square, far_square);
    }
    if (near_square < square) nearest_in(near, point, square, use);
    if (far_square < square) nearest_in(far, point, square, use);
  }
  template <class Use>
  void along_in(int number, const Vector<3>& from, const Vector<3>& to, double margin, Use& use) const {
    const Node& node = nodes_[static_cast<std::size_t>(number)];
    if (!meets(node.box, from, to, margin)) return;
    for (int k = 0; k < node.count; ++k) use(items_[static_cast<std::size_t>(node.first + k)]);
    if (node.left < 0) return;
    along_in(node.left, from, to, margin, use);
    along_in(node.right, from, to, margin, use);
  }

  std::vector<Node> nodes_;
  std::vector<int> items_;
};

}  // namespace impinge
