#include "impinge/observe/place.hpp"

namespace impinge {

template <int Dim>
std::vector<Pose<Dim>> poses_of(const std::vector<Wall<Dim>>& walls, double time) {
  std::vector<Pose<Dim>> poses;
  for (const Wall<Dim>& wall : walls) poses.push_back(wall.motion ? (*wall.motion)(time) : Pose<Dim>{});
  return poses;
}

template <int Dim>
bool is_hidden(const std::vector<Wall<Dim>>& walls, const std::vector<Pose<Dim>>& poses, const Vector<Dim>& from,
               const Vector<Dim>& to) {
  constexpr double clearance = 1e-3;  // share of the way that is not looked at: `from` may stand on a wall
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Vector<Dim> begin = poses[w].origin_of(from + clearance * (to - from));
    if (walls[w].surface->meets(begin, poses[w].origin_of(to))) return true;
  }
  return false;
}

template std::vector<Pose<2>> poses_of(const std::vector<Wall<2>>&, double);
template std::vector<Pose<3>> poses_of(const std::vector<Wall<3>>&, double);
template bool is_hidden(const std::vector<Wall<2>>&, const std::vector<Pose<2>>&, const Vector<2>&, const Vector<2>&);
template bool is_hidden(const std::vector<Wall<3>>&, const std::vector<Pose<3>>&, const Vector<3>&, const Vector<3>&);

}  // namespace impinge
