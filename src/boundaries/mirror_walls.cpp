#include "impinge/boundaries/mirror_walls.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

constexpr double right_angle = 1e-9;  // largest product of the normals of two faces that meet at a right angle
constexpr double least_gap = 1e-9;    // between a particle and a face after a reflection [dp]
constexpr double rounding = 1e-15;    // of a position, over its distance from the origin

// The reflection at a face, then the other.
template <int Dim>
Reflection<Dim> product(const Reflection<Dim>& outer, const Face<Dim>& face, int number) {
  Reflection<Dim> single;
  for (int k = 0; k < Dim; ++k) single.linear.row[static_cast<std::size_t>(k)] -= 2.0 * face.normal[k] * face.normal;
  single.shift = 2.0 * dot(face.point, face.normal) * face.normal;
  Reflection<Dim> result;
  for (int r = 0; r < Dim; ++r) {
    Vector<Dim>& row = result.linear.row[static_cast<std::size_t>(r)];
    row = {};
    for (int k = 0; k < Dim; ++k)
      row += outer.linear.row[static_cast<std::size_t>(r)][k] * single.linear.row[static_cast<std::size_t>(k)];
  }
  result.shift = outer.linear * single.shift + outer.shift;
  result.parity = -outer.parity;
  result.faces = outer.faces;
  result.faces.push_back(number);
  return result;
}

}  // namespace

template <int Dim>
MirrorWalls<Dim>::MirrorWalls(std::vector<Face<Dim>> faces, double reach) : faces_(std::move(faces)), reach_(reach) {
  // Sets of faces that stand at right angles to each other, each set once.
  std::vector<Reflection<Dim>> open{{}};
  while (!open.empty()) {
    const Reflection<Dim> outer = open.back();
    open.pop_back();
    const int first = outer.faces.empty() ? 0 : outer.faces.back() + 1;
    for (int number = first; number < static_cast<int>(faces_.size()); ++number) {
      const Face<Dim>& face = faces_[static_cast<std::size_t>(number)];
      const bool meets = std::ranges::all_of(outer.faces, [&](int other) {
        return std::abs(dot(face.normal, faces_[static_cast<std::size_t>(other)].normal)) < right_angle;
      });
      if (!meets) continue;
      open.push_back(product(outer, face, number));
      reflections_.push_back(open.back());
    }
  }
}

template <int Dim>
void MirrorWalls<Dim>::confine(Particles<Dim>& particles, double spacing) const {
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::fluid) continue;
    for (const Face<Dim>& face : faces_) {
      const double depth = -face.distance(particles.position[i]);
      if (!(depth >= 0.0)) continue;
      const double gap = std::max(least_gap * spacing, rounding * norm(particles.position[i]));
      particles.position[i] += 2.0 * std::max(depth, 0.5 * (depth + gap)) * face.normal;
      if (depth > 0.0) particles.velocity[i] -= 2.0 * dot(particles.velocity[i], face.normal) * face.normal;
    }
  }
}

template <int Dim>
void MirrorWalls<Dim>::append_images(Particles<Dim>& particles) {
  first_image_ = particles.size();
  original_.clear();
  reflection_.clear();
  if (faces_.empty()) return;
  std::vector<double> distance(faces_.size());
  for (int i = 0; i < first_image_; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (particles.type[self] == ParticleType::wall) continue;
    bool near = false;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      distance[f] = faces_[f].distance(particles.position[self]);
      near |= distance[f] < reach_;
    }
    if (!near) continue;
    for (std::size_t r = 0; r < reflections_.size(); ++r) {
      const auto within = [&](int face) { return distance[static_cast<std::size_t>(face)] < reach_; };
      if (!std::ranges::all_of(reflections_[r].faces, within)) continue;
      original_.push_back(i);
      reflection_.push_back(static_cast<int>(r));
    }
  }
  particles.resize(first_image_ + static_cast<int>(original_.size()));
  for_images([&](std::size_t, std::size_t at, std::size_t from) {
    particles.set_record(static_cast<int>(at), particles.record(static_cast<int>(from)));
  });
  copy_positions(particles.position);
  copy_directions(particles.velocity);
}

template class MirrorWalls<2>;
template class MirrorWalls<3>;

}  // namespace impinge
