#pragma once
// What snapshots and checkpoints have in common: the header and, in the VTKHDF layout (UnstructuredGrid of vertices,
// one piece per rank), the particles.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "impinge/io/hdf5_file.hpp"
#include "impinge/io/snapshot.hpp"
#include "impinge/particles/fields.hpp"

namespace impinge {

/// How a value stands in a file: as a number of a dataset of one dimension.
template <class T>
struct Stored {
  using Number = typename std::conditional_t<std::is_enum_v<T>, std::underlying_type<T>, std::type_identity<T>>::type;
  static constexpr int columns = 0;
  static constexpr int numbers = 1;
  static void append(std::vector<Number>& all, const T& value) { all.push_back(static_cast<Number>(value)); }
  static T value(const Number* place) { return static_cast<T>(*place); }
};

/// A vector stands in a file as a row of three columns.
template <int Dim>
struct Stored<Vector<Dim>> {
  using Number = double;
  static constexpr int columns = 3;
  static constexpr int numbers = 3;
  static void append(std::vector<double>& all, const Vector<Dim>& value) {
    for (int k = 0; k < 3; ++k) all.push_back(k < Dim ? value[k] : 0.0);
  }
  static Vector<Dim> value(const double* place) {
    Vector<Dim> result;
    for (int k = 0; k < Dim; ++k) result[k] = place[k];
    return result;
  }
};

/// The numbers of a dataset for the first `count` values.
template <class T>
std::vector<typename Stored<T>::Number> to_numbers(const std::vector<T>& values, int count) {
  std::vector<typename Stored<T>::Number> all;
  all.reserve(static_cast<std::size_t>(count) * Stored<T>::numbers);
  for (int i = 0; i < count; ++i) Stored<T>::append(all, values[static_cast<std::size_t>(i)]);
  return all;
}

/// The values for the numbers of a dataset.
template <class T>
std::vector<T> to_values(const std::vector<typename Stored<T>::Number>& numbers) {
  std::vector<T> values;
  values.reserve(numbers.size() / Stored<T>::numbers);
  for (std::size_t k = 0; k < numbers.size(); k += Stored<T>::numbers)
    values.push_back(Stored<T>::value(numbers.data() + k));
  return values;
}

/// The dataset of a saved field.
std::string dataset_path(std::string_view field);

/// The dataset of the positions.
inline constexpr const char* points_path = "/VTKHDF/Points";

/// The point datum that is no field: the rank that owns the particle.
inline constexpr const char* rank_name = "rank";

/// A snapshot or checkpoint that one rank reads. Throws FileError where the file is neither.
class StateReader : public Hdf5Reader {
 public:
  explicit StateReader(const std::string& path);
  SnapshotHeader header() const;

  /// This rank's particles, `count` of them, by read.operator()<Number>(dataset path, columns). Throws FileError where
  /// a particle is of no known type or there are more than a rank can hold.
  template <int Dim, class Read>
  Particles<Dim> particles(std::int64_t count, Read&& read) const {
    constexpr int most = std::numeric_limits<int>::max();
    if (count > most) fail(fmt::format("{} particles are more than one rank can hold, which is {}", count, most));
    Particles<Dim> result;
    result.owned = static_cast<int>(count);
    for_fields<Dim>([&]<class T>(const Field<Dim, T>& field) {
      if (!field.is_saved) return;
      result.*field.values = to_values<T>(
          read.template operator()<typename Stored<T>::Number>(dataset_path(field.name), Stored<T>::columns));
    });
    check_types(result.type);
    return result;
  }

 private:
  void check_types(std::span<const ParticleType> types) const;
};

/// Writes header, owned particles and, where it has been averaged, the mean pressure of the walls (/wall). Collective.
template <int Dim>
void write_state(Hdf5Writer& file, int rank, const Particles<Dim>& particles, const SnapshotHeader& header);

}  // namespace impinge
