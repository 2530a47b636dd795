#pragma once
// Walls that are mirrors: images of the particles complete every sum over neighbours beyond them.

#include <functional>
#include <map>
#include <span>
#include <vector>

#include "impinge/boundaries/wall_faces.hpp"
#include "impinge/core/vector.hpp"
#include "impinge/particles/neighbours.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// The images of this rank's particles, owned and halo, behind the mirrors. They stand behind the halo in every array
/// of particles and are made from what this rank has: nothing of them is sent.
///
/// Specular pairs: a particle i sees a particle j along the straight line and once more along every path that is
/// reflected at faces. The image of j stands where the path ends if it is unfolded; the faces are finite, so that not
/// every particle sees it. A path run backwards is the same path, so that pairs are symmetric. Images at flat faces are
/// the same for all that see them. At a curved face each pair has its own: at the plane that touches the face at q, the
/// point of the wall nearest to (d_j x_i + d_i x_j)/(d_i + d_j), with d the distances to the wall. Its share in the
/// sums is that of a ray tube, J = (l_1 + l_2)/(l_1 + l_2 + 2 k l_1 l_2/cos a), with l the lengths of the two parts of
/// the path, a its angle to the normal, and k the curvature, positive where the wall bulges into the fluid. In three
/// dimensions a tube spreads in the plane of incidence, with k_1, and across it, with k_2 and cos a in the place of
/// 1/cos a: J is the product of both.
template <int Dim>
class MirrorWalls final : public PairFilter<Dim> {
 public:
  using typename PairFilter<Dim>::OwnPair;

  /// No walls.
  MirrorWalls() = default;

  /// `reach`: largest radius of a sum over neighbours [m]; `spacing`: dp [m]. Planes that meet do so at right angles.
  MirrorWalls(const std::vector<Face<Dim>>& planes, const std::vector<Wall<Dim>>& walls, double reach, double spacing)
      : faces_(planes, walls, reach, spacing), reach_(reach), spacing_(spacing) {}

  bool empty() const { return faces_.count() == 0; }
  bool any_moves() const { return faces_.any_moves(); }
  const WallFaces<Dim>& faces() const { return faces_; }

  /// See WallFaces. Not collective.
  void move_to(double time, double velocity_time) { faces_.move_to(time, velocity_time); }

  /// Reflects owned fluid particles that have passed a face, with their velocity. `before`: where a particle was when
  /// the walls moved last [m]. Not collective.
  void confine(const std::function<Vector<Dim>(int)>& before, Particles<Dim>& particles) const;

  /// Appends the images at flat faces of all particles within reach, but for wall particles, behind the halo. Not
  /// collective.
  void append_images(Particles<Dim>& particles);

  /// Appends the images at curved faces, of each pair its own. `around`: the particles within reach of an owned one.
  /// Not collective.
  void append_own_images(const std::function<std::span<const int>(int)>& around, Particles<Dim>& particles);

  /// Index of the first image, and the particle that each image is of.
  int first_image() const { return first_image_; }
  std::span<const int> originals() const { return original_; }
  std::size_t count() const { return original_.size(); }
  /// Index of the first image that one particle alone sees.
  int first_own_image() const { return first_own_image_; }

  /// Gives the images the values of their originals: as they are, moved, or turned as a direction.
  template <class T>
  void copy(std::vector<T>& field) const {
    for_images([&](std::size_t, std::size_t at, std::size_t from) { field[at] = field[from]; });
  }
  void copy_positions(std::vector<Vector<Dim>>& position) const {
    for_images([&](std::size_t k, std::size_t at, std::size_t from) {
      position[at] = reflection(k).of_position(position[from]);
    });
  }
  void copy_directions(std::vector<Vector<Dim>>& direction) const {
    for_images([&](std::size_t k, std::size_t at, std::size_t from) {
      direction[at] = reflection(k).linear * direction[from];
    });
  }
  /// Velocities are mirrored in the frame of the wall: u' = V(y) + M (u - V(x)) at each face.
  void copy_velocities(const std::vector<Vector<Dim>>& position, std::vector<Vector<Dim>>& velocity) const;
  /// Those of a viscous fluid, which sticks to a wall that it does not slip along: there u' = V(y) - (u - V(x)).
  void copy_held_velocities(const std::vector<Vector<Dim>>& position, std::vector<Vector<Dim>>& velocity) const;

  /// What a force per mass g, and the acceleration a of fluid that follows a wall, change at an image, docs/method.md
  /// (17): its pressure exceeds its original's by rho b.(y - x), b = g - a, and to the mirrored velocity comes
  /// (I - M)(dt b + after (a - dV/dt)); at one face after the other. `after`: time that particles move on before they
  /// shall move along the wall [s]. `offset`: of the pressures [Pa]. Reads positions, changes velocities.
  void apply_force(double dt, double after, double density, const std::function<Vector<Dim>(const Vector<Dim>&)>& force,
                   Particles<Dim>& particles, std::vector<double>& offset) const;

  /// Calls use(image, its index, its original's index) for every image.
  template <class Use>
  void for_images(Use&& use) const {
    for (std::size_t k = 0; k < original_.size(); ++k)
      use(k, static_cast<std::size_t>(first_image_) + k, static_cast<std::size_t>(original_[k]));
  }

  bool has_tests(int i) const override { return tested_[static_cast<std::size_t>(i)] != 0; }
  double factor(int i, int j) const override;
  std::span<const OwnPair> own_pairs(int i) const override {
    if (own_start_.empty()) return {};
    const auto first = static_cast<std::size_t>(own_start_[static_cast<std::size_t>(i)]);
    return std::span(own_).subspan(first,
                                   static_cast<std::size_t>(own_start_[static_cast<std::size_t>(i) + 1]) - first);
  }

 private:
  const Reflection<Dim>& reflection(std::size_t image) const { return way(image).whole; }
  /// Where a curved face is nearest to a particle.
  struct FaceFoot {
    int face;
    Foot<Dim> foot;
  };

  void find_feet(const Particles<Dim>& particles);
  std::span<const FaceFoot> feet(int i) const;
  std::span<const NearFace> near(std::size_t i) const;
  std::vector<int> between(std::size_t i, std::size_t j, double length, bool is_straight) const;
  double own_factor(int i, int j, int face, const Meeting<Dim>& meeting) const;
  void append_paths(int particle, const Vector<Dim>& place, const MirrorPath& path, const Reflection<Dim>& outer);
  int way_of(const MirrorPath& path, const Reflection<Dim>& whole);
  Vector<Dim> velocity_of(std::size_t image, const Vector<Dim>& from, const Vector<Dim>& velocity) const;
  template <class Use>
  void along(std::size_t image, const Vector<Dim>& from, Use&& use) const;

  /// How images of one kind are made.
  struct Way {
    MirrorPath path;
    Reflection<Dim> whole;
    bool moves;           ///< at a wall that moves
    bool holds;           ///< at walls alone that a viscous fluid sticks to
    Face<Dim> plane;      ///< of a curved face, which is the last before the particle that sees the image
    Matrix<Dim> bending;  ///< likewise, see Foot [1/m]
  };
  const Way& way(std::size_t image) const { return ways_[static_cast<std::size_t>(way_[image])]; }

  WallFaces<Dim> faces_;
  double reach_ = 0.0;
  double spacing_ = 0.0;
  int first_image_ = 0;
  int first_own_image_ = 0;
  std::vector<int> original_;  // of each image
  std::vector<int> way_;       // likewise
  std::vector<Way> ways_;
  std::map<MirrorPath, int> known_;  // ways at flat faces
  std::vector<char> tested_;         // per owned particle
  std::vector<int> near_start_;      // per particle, halo included
  std::vector<NearFace> near_;
  std::vector<int> own_start_;
  std::vector<OwnPair> own_;
  std::vector<int> foot_start_;  // per particle, halo and images at flat faces included
  std::vector<FaceFoot> feet_;
  // Where everything was when the images were appended.
  std::span<const Vector<Dim>> position_;
  std::span<const std::int64_t> id_;
};

}  // namespace impinge
