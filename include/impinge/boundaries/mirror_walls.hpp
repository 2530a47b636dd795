#pragma once
// Walls that are mirrors: images of the particles complete every sum over neighbours beyond them.

#include <span>
#include <vector>

#include "impinge/core/vector.hpp"
#include "impinge/particles/particles.hpp"

namespace impinge {

/// A flat wall: the fluid is where (x - point).normal > 0.
template <int Dim>
struct Face {
  Vector<Dim> point;   ///< on the face [m]
  Vector<Dim> normal;  ///< unit vector into the fluid [-]

  /// Signed distance of a position, positive in the fluid [m].
  double distance(const Vector<Dim>& position) const { return dot(position - point, normal); }
};

/// An affine map x -> linear x + shift that reflects at one or several faces.
template <int Dim>
struct Reflection {
  Matrix<Dim> linear = Matrix<Dim>::identity();
  Vector<Dim> shift;         ///< [m]
  double parity = 1.0;       ///< -1 for an odd number of reflections
  std::vector<int> faces{};  ///< that it reflects at

  Vector<Dim> of_position(const Vector<Dim>& r) const { return linear * r + shift; }
};

/// The images of this rank's particles, owned and halo, behind the mirrors. They stand behind the halo in every array
/// of particles and are made from what this rank has: nothing of them is sent.
template <int Dim>
class MirrorWalls {
 public:
  /// No walls.
  MirrorWalls() = default;

  /// `reach`: largest radius of a sum over neighbours [m]. Faces that meet do so at right angles.
  MirrorWalls(std::vector<Face<Dim>> faces, double reach);

  bool empty() const { return faces_.empty(); }

  /// Reflects owned fluid particles that have passed a face, with their velocity. `spacing`: dp [m]. Not collective.
  void confine(Particles<Dim>& particles, double spacing) const;

  /// Appends the images of all particles within reach of a face, but for wall particles, behind the halo. Not
  /// collective.
  void append_images(Particles<Dim>& particles);

  /// Index of the first image, and the particle that each image is of.
  int first_image() const { return first_image_; }
  std::span<const int> originals() const { return original_; }
  std::size_t count() const { return original_.size(); }
  const Reflection<Dim>& reflection(std::size_t image) const {
    return reflections_[static_cast<std::size_t>(reflection_[image])];
  }

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

  /// Calls use(image, its index, its original's index) for every image.
  template <class Use>
  void for_images(Use&& use) const {
    for (std::size_t k = 0; k < original_.size(); ++k)
      use(k, static_cast<std::size_t>(first_image_) + k, static_cast<std::size_t>(original_[k]));
  }

 private:
  std::vector<Face<Dim>> faces_;
  double reach_ = 0.0;
  std::vector<Reflection<Dim>> reflections_;  // at each face, and at those that meet
  int first_image_ = 0;
  std::vector<int> original_;    // of each image
  std::vector<int> reflection_;  // likewise
};

}  // namespace impinge
