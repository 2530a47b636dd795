#include "impinge/boundaries/mirror_walls.hpp"

#include <algorithm>
#include <cmath>

namespace impinge {
namespace {

constexpr double right_angle = 1e-9;    // largest product of the normals of two faces that meet at a right angle
constexpr double displacement = 1e-10;  // of a particle's own image, so that its line misses the edge it aims at [dp]
constexpr double nearly_right = 0.2;    // cosine of the angle between a curved face and a flat one that it meets
constexpr double least_share = 0.5;     // of a pair at a curved face
constexpr double most_share = 2.0;

template <int Dim>
bool are_perpendicular(const WallFaces<Dim>& faces, int one, int two) {
  if (!faces.is_flat(one) || !faces.is_flat(two)) return false;
  return std::abs(dot(faces.plane(one).normal, faces.plane(two).normal)) < right_angle;
}

/// True for faces back to back, of bodies that touch.
template <int Dim>
bool coincide(const Face<Dim>& one, const Face<Dim>& other) {
  constexpr double rounding = 1e-12;  // of a distance, over that from the origin
  return dot(one.normal, other.normal) < right_angle - 1.0 &&
         std::abs(one.distance(other.point)) <= rounding * (norm(one.point) + norm(other.point));
}

/// The paths that differ in the order of faces at right angles: all have the same image.
template <int Dim>
std::vector<MirrorPath> same_paths(const WallFaces<Dim>& faces, const MirrorPath& path) {
  std::vector<MirrorPath> all{path};
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (int place = 0; place + 1 < path.count; ++place) {
      MirrorPath other = all[k];
      int &one = other.face[static_cast<std::size_t>(place)], &two = other.face[static_cast<std::size_t>(place) + 1];
      if (!are_perpendicular(faces, one, two)) continue;
      std::swap(one, two);
      if (std::ranges::find(all, other) == all.end()) all.push_back(other);
    }
  }
  return all;
}

}  // namespace

template <int Dim>
void MirrorWalls<Dim>::confine(const std::function<Vector<Dim>(int)>& before, Particles<Dim>& particles) const {
  if (empty()) return;
  for (int i = 0; i < particles.owned; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (particles.type[self] == ParticleType::fluid)
      faces_.confine(before(i), particles.position[self], particles.velocity[self]);
  }
}

// The images of one particle along all paths that end with this one; `place` and `outer`: its image along this one.
template <int Dim>
void MirrorWalls<Dim>::append_paths(int particle, const Vector<Dim>& place, const MirrorPath& path,
                                    const Reflection<Dim>& outer) {
  if (path.count == MirrorPath::longest) return;
  const Vector<Dim> origin = position_[static_cast<std::size_t>(particle)];
  for (const int f : faces_.around(origin)) {
    if (!faces_.is_flat(f)) continue;
    const bool ends = faces_.has_ends(f);
    if (ends ? !(faces_.height(f, place) > 0.0 && faces_.distance(f, place) < reach_)
             : !(faces_.height(f, place) < reach_))
      continue;
    if (path.count > 0) {
      const int last = path.face[0];
      if (f == last || faces_.is_partner(f, last) || coincide(faces_.plane(f), faces_.plane(last))) continue;
      const bool perpendicular = are_perpendicular(faces_, f, last);
      if (perpendicular ? f < last : !ends) continue;
    }
    MirrorPath longer;
    longer = longer.then(f);
    for (const int g : path.faces()) longer = longer.then(g);
    const Reflection<Dim> whole = product(reflection_at(faces_.plane(f)), outer);
    original_.push_back(particle);
    way_.push_back(way_of(longer, whole));
    append_paths(particle, whole.of_position(origin), longer, whole);
  }
}

template <int Dim>
int MirrorWalls<Dim>::way_of(const MirrorPath& path, const Reflection<Dim>& whole) {
  const auto found = known_.find(path);
  if (found != known_.end()) return found->second;
  const auto moves = [&](int f) { return faces_.moves(f); };
  const auto holds = [&](int f) { return !faces_.slips(f); };
  const bool all_hold = std::ranges::all_of(path.faces(), holds);
  ways_.push_back({path, whole, std::ranges::any_of(path.faces(), moves), all_hold, {}, {}});
  const int number = static_cast<int>(ways_.size()) - 1;
  known_.emplace(path, number);
  return number;
}

template <int Dim>
void MirrorWalls<Dim>::append_images(Particles<Dim>& particles) {
  first_image_ = particles.size();
  original_.clear();
  way_.clear();
  ways_.clear();
  known_.clear();
  own_start_.clear();
  own_.clear();
  tested_.assign(static_cast<std::size_t>(particles.owned), 0);
  first_own_image_ = first_image_;
  if (empty()) return;
  position_ = particles.position;
  for (int i = 0; i < first_image_; ++i)
    if (particles.type[static_cast<std::size_t>(i)] != ParticleType::wall)
      append_paths(i, position_[static_cast<std::size_t>(i)], {}, {});
  first_own_image_ = first_image_ + static_cast<int>(original_.size());
  particles.resize(first_own_image_);
  for_images([&](std::size_t, std::size_t at, std::size_t from) {
    particles.set_record(static_cast<int>(at), particles.record(static_cast<int>(from)));
  });
  copy_positions(particles.position);
  copy_velocities(particles.position, particles.velocity);
  position_ = particles.position;
  id_ = particles.id;
  // Fluid behind a line does not see what is before it.
  std::vector<char> hides(static_cast<std::size_t>(faces_.count()), 0);
  for (int i = 0; faces_.has_lines() && i < first_image_; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (particles.type[self] == ParticleType::wall) continue;
    for (const int f : faces_.around(position_[self]))
      if (faces_.is_behind(f, position_[self])) hides[static_cast<std::size_t>(f)] = 1;
  }
  near_.clear();
  near_start_.assign(1, 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(first_image_); ++i) {
    faces_.append_near(position_[i], near_);
    near_start_.push_back(static_cast<int>(near_.size()));
    if (i >= tested_.size()) continue;
    const std::span<const NearFace> near = this->near(i);
    const auto is_hiding = [&](const NearFace& face) { return hides[static_cast<std::size_t>(face.face)] != 0; };
    tested_[i] = faces_.has_tests(position_[i], near) || std::ranges::any_of(near, is_hiding) ? 1 : 0;
  }
}

template <int Dim>
std::span<const NearFace> MirrorWalls<Dim>::near(std::size_t i) const {
  const auto first = static_cast<std::size_t>(near_start_[i]), last = static_cast<std::size_t>(near_start_[i + 1]);
  return std::span(near_).subspan(first, last - first);
}

// The faces that a path between two particles may meet beside those that it is reflected at.
template <int Dim>
std::vector<int> MirrorWalls<Dim>::between(std::size_t i, std::size_t j, double length, bool is_straight) const {
  std::vector<int> faces;
  for (const NearFace& one : near(i)) {
    const auto other = std::ranges::find(near(j), one.face, &NearFace::face);
    if (other != near(j).end() && faces_.may_meet(one, *other, length, is_straight)) faces.push_back(one.face);
  }
  return faces;
}

// Where curved faces are nearest to the particles before them, and to images of these at flat faces that meet a curved
// one at a right angle: there the image of the foot is the foot of the image.
template <int Dim>
void MirrorWalls<Dim>::find_feet(const Particles<Dim>& particles) {
  feet_.clear();
  foot_start_.assign(1, 0);
  for (int i = 0; i < first_own_image_; ++i) {
    const auto self = static_cast<std::size_t>(i);
    if (i < first_image_) {
      const ParticleType type = particles.type[self];
      const bool has_row = i < particles.owned && (type == ParticleType::fluid || type == ParticleType::wall);
      Foot<Dim> foot;
      if (has_row || type != ParticleType::wall)
        for (const int f : faces_.around(particles.position[self]))
          if (!faces_.is_flat(f) && faces_.find_foot(f, particles.position[self], foot)) feet_.push_back({f, foot});
    } else if constexpr (Dim == 3) {
      const std::size_t image = self - static_cast<std::size_t>(first_image_);
      const bool has_room = way(image).path.count < MirrorPath::longest;
      const auto original = static_cast<std::size_t>(original_[image]);
      for (int k = foot_start_[original]; has_room && k < foot_start_[original + 1]; ++k) {
        auto [face, foot] = feet_[static_cast<std::size_t>(k)];
        const auto is_beside = [&](int f) { return std::abs(dot(faces_.plane(f).normal, foot.normal)) < nearly_right; };
        if (!std::ranges::all_of(way(image).path.faces(), is_beside)) continue;
        const Reflection<Dim>& mirror = reflection(image);
        foot.point = mirror.of_position(foot.point);
        foot.normal = mirror.linear * foot.normal;
        foot.bending = product(mirror, product(Reflection<Dim>{foot.bending, {}}, mirror)).linear;
        feet_.push_back({face, foot});
      }
    }
    foot_start_.push_back(static_cast<int>(feet_.size()));
  }
}

template <int Dim>
std::span<const typename MirrorWalls<Dim>::FaceFoot> MirrorWalls<Dim>::feet(int i) const {
  const auto first = static_cast<std::size_t>(foot_start_[static_cast<std::size_t>(i)]);
  return std::span(feet_).subspan(first,
                                  static_cast<std::size_t>(foot_start_[static_cast<std::size_t>(i) + 1]) - first);
}

// What walls leave of a pair that meets at a curved face.
template <int Dim>
double MirrorWalls<Dim>::own_factor(int i, int j, int face, const Meeting<Dim>& meeting) const {
  const auto self = static_cast<std::size_t>(i), other = static_cast<std::size_t>(j);
  if (j >= first_image_) {
    // The face is seen before a flat one or, in it, behind.
    Vector<Dim> hit = meeting.plane.point;
    for (const int f : way(other - static_cast<std::size_t>(first_image_)).path.faces())
      if (faces_.plane(f).distance(hit) < 0.0) hit = reflection_at(faces_.plane(f)).of_position(hit);
    return faces_.holds(face, hit) ? 1.0 : 0.0;
  }
  if (!tested_[self]) return faces_.holds(face, meeting.plane.point) ? 1.0 : 0.0;
  const Reflection<Dim> reflection = reflection_at(meeting.plane);
  const Vector<Dim>&here = position_[self], &there = position_[other];
  const MirrorPath path = MirrorPath{}.then(face);
  const Vector<Dim> image = reflection.of_position(there);
  const std::vector<int> faces = between(self, other, norm(image - here), false);
  return id_[self] <= id_[other] ? faces_.path_factor(here, image, path, meeting.plane, faces)
                                 : faces_.path_factor(there, reflection.of_position(here), path, meeting.plane, faces);
}

template <int Dim>
void MirrorWalls<Dim>::append_own_images(const std::function<std::span<const int>(int)>& around,
                                         Particles<Dim>& particles) {
  if (!faces_.has_curves()) return;
  find_feet(particles);
  own_start_.assign(1, 0);
  for (int i = 0; i < particles.owned; ++i) {
    const Vector<Dim>& here = particles.position[static_cast<std::size_t>(i)];
    for (const auto& [f, foot] : feet(i)) {
      for (const int j : around(i)) {
        const auto other = static_cast<std::size_t>(j);
        if (j >= first_own_image_ || particles.type[other] == ParticleType::wall) continue;
        const auto found = std::ranges::find(feet(j), f, &FaceFoot::face);
        if (found == feet(j).end()) continue;
        const Vector<Dim>& there = particles.position[other];
        const Meeting<Dim> meeting = faces_.meeting(f, here, foot, there, found->foot);
        const Reflection<Dim> at_face = reflection_at(meeting.plane);
        if (norm(at_face.of_position(there) - here) >= reach_) continue;
        double share = std::clamp(meeting.share, least_share, most_share);
        share *= own_factor(i, j, f, meeting);
        if (share == 0.0) continue;
        own_.push_back({first_image_ + static_cast<int>(original_.size()), share});
        way_.push_back(static_cast<int>(ways_.size()));
        if (j < first_image_) {
          original_.push_back(j);
          ways_.push_back(
              {MirrorPath{}.then(f), at_face, faces_.moves(f), !faces_.slips(f), meeting.plane, meeting.bending});
        } else {
          const std::size_t image = other - static_cast<std::size_t>(first_image_);
          const Way flat = way(image);
          MirrorPath path = MirrorPath{}.then(f);
          for (const int g : flat.path.faces()) path = path.then(g);
          original_.push_back(original_[image]);
          ways_.push_back({path, product(at_face, flat.whole), flat.moves || faces_.moves(f),
                           flat.holds && !faces_.slips(f), meeting.plane, meeting.bending});
        }
      }
    }
    own_start_.push_back(static_cast<int>(own_.size()));
  }
  particles.resize(first_image_ + static_cast<int>(original_.size()));
  for_images([&](std::size_t k, std::size_t at, std::size_t from) {
    if (static_cast<int>(at) < first_own_image_) return;
    particles.set_record(static_cast<int>(at), particles.record(static_cast<int>(from)));
    particles.position[at] = reflection(k).of_position(particles.position[from]);
    particles.velocity[at] = velocity_of(k, particles.position[from], particles.velocity[from]);
  });
  position_ = particles.position;
  id_ = particles.id;
}

// Calls use(face, its reflection, place before, place behind) for the faces on the way from an image's original.
template <int Dim>
template <class Use>
void MirrorWalls<Dim>::along(std::size_t image, const Vector<Dim>& from, Use&& use) const {
  const Way& here = way(image);
  Vector<Dim> place = from;
  for (int k = here.path.count; k-- > 0;) {
    const int f = here.path.face[static_cast<std::size_t>(k)];
    const Reflection<Dim> single = here.path.count == 1 ? here.whole
                                   : faces_.is_flat(f)  ? reflection_at(faces_.plane(f))
                                                        : reflection_at(here.plane);
    const Vector<Dim> next = single.of_position(place);
    use(f, single, place, next);
    place = next;
  }
}

template <int Dim>
Vector<Dim> MirrorWalls<Dim>::velocity_of(std::size_t image, const Vector<Dim>& from,
                                          const Vector<Dim>& velocity) const {
  if (!way(image).moves) return reflection(image).linear * velocity;
  Vector<Dim> result = velocity;
  along(image, from, [&](int f, const Reflection<Dim>& single, const Vector<Dim>& before, const Vector<Dim>& behind) {
    result = faces_.velocity(f, behind) + single.linear * (result - faces_.velocity(f, before));
  });
  return result;
}

template <int Dim>
void MirrorWalls<Dim>::copy_velocities(const std::vector<Vector<Dim>>& position,
                                       std::vector<Vector<Dim>>& velocity) const {
  for_images([&](std::size_t k, std::size_t at, std::size_t from) {
    velocity[at] = velocity_of(k, position[from], velocity[from]);
  });
}

template <int Dim>
void MirrorWalls<Dim>::copy_held_velocities(const std::vector<Vector<Dim>>& position,
                                            std::vector<Vector<Dim>>& velocity) const {
  for_images([&](std::size_t k, std::size_t at, std::size_t from) {
    if (way(k).holds && !way(k).moves) {
      velocity[at] = way(k).path.count % 2 == 0 ? velocity[from] : -1.0 * velocity[from];
      return;
    }
    Vector<Dim> result = velocity[from];
    along(k, position[from],
          [&](int f, const Reflection<Dim>& single, const Vector<Dim>& before, const Vector<Dim>& behind) {
            const Vector<Dim> relative = result - faces_.velocity(f, before);
            result = faces_.velocity(f, behind) + (faces_.slips(f) ? single.linear * relative : -1.0 * relative);
          });
    velocity[at] = result;
  });
}

template <int Dim>
void MirrorWalls<Dim>::apply_force(double dt, double after, double density,
                                   const std::function<Vector<Dim>(const Vector<Dim>&)>& force,
                                   Particles<Dim>& particles, std::vector<double>& offset) const {
  offset.resize(count());
  for_images([&](std::size_t k, std::size_t at, std::size_t from) {
    double excess = 0.0;
    Vector<Dim> change, velocity = particles.velocity[from];
    along(k, particles.position[from],
          [&](int f, const Reflection<Dim>& single, const Vector<Dim>& before, const Vector<Dim>& behind) {
            const auto jump = [&](const Vector<Dim>& a) { return a - single.linear * a; };
            const Vector<Dim> middle = before + 0.5 * (behind - before);
            const Vector<Dim> flow = velocity - faces_.velocity(f, before);
            Vector<Dim> along_wall = 2.0 * faces_.turning(f, flow);
            if (!faces_.is_flat(f)) along_wall -= dot(flow, way(k).bending * flow) * way(k).plane.normal;
            const Vector<Dim> with_wall = faces_.turning(f, faces_.velocity(f, middle));
            const Vector<Dim> excess_force = force(middle) - faces_.acceleration(f, middle) - along_wall;
            excess += dot(excess_force, behind - before);
            change = single.linear * change + jump(dt * excess_force + after * (with_wall + along_wall));
            velocity = faces_.velocity(f, behind) + single.linear * flow;
          });
    offset[k] = density * excess;
    particles.velocity[at] += change;
  });
}

template <int Dim>
double MirrorWalls<Dim>::factor(int i, int j) const {
  const auto self = static_cast<std::size_t>(i), other = static_cast<std::size_t>(j);
  const Vector<Dim>& here = position_[self];
  const double length = norm(position_[other] - here);
  if (j < first_image_) {
    const std::vector<int> faces = between(self, other, length, true);
    return id_[self] <= id_[other] ? faces_.line_factor(here, position_[other], faces)
                                   : faces_.line_factor(position_[other], here, faces);
  }
  const std::size_t image = other - static_cast<std::size_t>(first_image_);
  const auto original = static_cast<std::size_t>(original_[image]);
  const Way& to = way(image);
  Vector<Dim> begin = here, end = position_[other];
  const bool backwards = id_[self] > id_[original];
  if (backwards) {
    begin = position_[original];
    end = {};
    const Vector<Dim> offset = here - to.whole.shift;
    for (int k = 0; k < Dim; ++k) end += offset[k] * to.whole.linear.row[static_cast<std::size_t>(k)];
  } else if constexpr (Dim == 2) {
    if (static_cast<std::size_t>(i) == original && to.path.count > 1)
      end += displacement * spacing_ * Vector<2>{{0.6, 0.8}};
  }
  if constexpr (Dim == 3)
    if (to.path.count > 1) end += displacement * spacing_ * Vector<3>{{0.36, 0.48, 0.8}};
  const std::vector<int> faces = between(self, original, length, false);
  if (to.path.count == 1) {
    const double share = faces_.path_factor(begin, end, to.path, {}, faces);
    // Beside a face, no wall keeps a particle from its own image: all of the share is gone where the face ends.
    return static_cast<std::size_t>(i) == original ? std::max(2.0 * share - 1.0, 0.0) : share;
  }
  double sum = 0.0;
  for (const MirrorPath& path : same_paths(faces_, to.path))
    sum += faces_.path_factor(begin, end, backwards ? path.reversed() : path, {}, faces);
  return std::min(sum, 1.0);
}

template class MirrorWalls<2>;
template class MirrorWalls<3>;

}  // namespace impinge
