#pragma once
// The particles of one rank, as a structure of arrays: [owned | halo | mirror images].

#include <cstdint>
#include <span>
#include <vector>

#include "impinge/core/vector.hpp"

namespace impinge {

/// What a particle is. The values are those of the file format.
enum class ParticleType : std::uint8_t {
  fluid = 0,  ///< moves freely, carries a pressure unknown
  inlet = 1,  ///< rigid buffer that moves at the jet's speed, p = 0
  wall = 2,   ///< first row of a wall, with a pressure unknown; on a mirror: measures the pressure
  ghost = 3   ///< rows behind the wall row that complete number density and divergence
};

/// What travels with a particle that changes its rank.
template <int Dim>
struct ParticleRecord {
  Vector<Dim> position;     ///< [m]
  Vector<Dim> velocity;     ///< [m/s]
  double pressure;          ///< [Pa]
  double pressure_impulse;  ///< [Pa s]
  std::int64_t id;
  ParticleType type;
};

/// Structure of arrays. Entries [0, owned) belong to this rank. Behind them stands the halo, copies of other ranks'
/// particles and periodic images within reach, and behind it the mirror images. All arrays have length size().
template <int Dim>
struct Particles {
  int owned = 0;
  std::vector<Vector<Dim>> position;     ///< [m]
  std::vector<Vector<Dim>> velocity;     ///< [m/s]
  std::vector<double> pressure;          ///< [Pa]
  std::vector<double> pressure_impulse;  ///< integral of p dt over the averaging window [Pa s]; owned entries
  std::vector<double> number_density;    ///< n [-]; owned entries are valid
  std::vector<std::int64_t> id;          ///< never used twice in a run
  std::vector<ParticleType> type;
  std::vector<std::uint8_t> free_surface;  ///< 1 where the free-surface criterion holds

  int size() const { return static_cast<int>(position.size()); }

  /// Sets the length of every array; new entries are zero.
  void resize(int size);

  /// Becomes a copy of the owned particles of another object.
  void copy_owned(const Particles& other);

  /// Puts the owned particles, none of them halo, into another order: entry k comes from order[k].
  void reorder(std::span<const int> order);

  /// Appends an owned particle. Only while there is no halo.
  void append(const ParticleRecord<Dim>& record);

  ParticleRecord<Dim> record(int i) const;
  void set_record(int i, const ParticleRecord<Dim>& record);
};

}  // namespace impinge
