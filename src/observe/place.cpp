#include "impinge/observe/place.hpp"

namespace impinge {

std::vector<Pose<2>> poses_of(const std::vector<Wall>& walls, double time) {
  std::vector<Pose<2>> poses;
  for (const Wall& wall : walls) poses.push_back(wall.motion ? (*wall.motion)(time) : Pose<2>{});
  return poses;
}

Vector<2> origin_of(const Pose<2>& pose, const Vector<2>& x) {
  const Vector<2> turned = x - pose.shift;
  Vector<2> result;
  for (int k = 0; k < 2; ++k) result += turned[k] * pose.rotation.row[static_cast<std::size_t>(k)];
  return result;
}

bool is_hidden(const std::vector<Wall>& walls, const std::vector<Pose<2>>& poses, const Vector<2>& from,
               const Vector<2>& to) {
  constexpr double clearance = 1e-3;  // share of the way that is not looked at: `from` may stand on a wall
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Vector<2> begin = origin_of(poses[w], from + clearance * (to - from));
    if (walls[w].outline.first_hit(begin, origin_of(poses[w], to))) return true;
  }
  return false;
}

}  // namespace impinge
