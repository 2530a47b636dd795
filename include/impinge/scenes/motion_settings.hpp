#pragma once
// Prescribed motions of walls: [[motion]] of a case file.

#include <optional>
#include <string>
#include <vector>

#include "impinge/boundaries/motion.hpp"
#include "impinge/config/case_file.hpp"
#include "impinge/config/key.hpp"

namespace impinge {

enum class MotionType { constant, harmonic, table };
constexpr auto words(MotionType) { return std::to_array<std::string_view>({"constant", "harmonic", "table"}); }

/// The word of a wall that does not move.
constexpr std::string_view no_motion = "none";

/// One table of [[motion]].
struct MotionEntry {
  static constexpr double never = 1e30;  ///< [s]

  std::string name;
  MotionType type = MotionType::constant;
  Numbers center{};                ///< of rotation [m]
  Numbers axis{0.0, 0.0, 1.0};     ///< of rotation, in three dimensions; of any length
  double start = 0.0;              ///< [s]
  double end = never;              ///< [s]
  Numbers velocity{};              ///< constant: of the centre [m/s]
  double spin = 0.0;               ///< constant: counter-clockwise [rad/s]
  Numbers amplitude{};             ///< harmonic: of the displacement [m]
  double angle = 0.0;              ///< harmonic: amplitude of the angle, counter-clockwise [deg]
  double frequency = 0.0;          ///< harmonic [Hz]
  double phase = 0.0;              ///< harmonic [deg]
  double ramp = 0.0;               ///< harmonic: time in which it rises [s]
  std::string file;                ///< table: its text; empty once it has been taken
  std::vector<double> times;       ///< table: since the start [s]
  std::vector<Numbers> positions;  ///< table: displacements at these [m]; empty: none
  std::vector<double> angles;      ///< table: angles at these, counter-clockwise [deg]; empty: none
};

/// Declares [[motion]].
void declare_motions(Keys& keys, std::vector<MotionEntry>& motions);

/// Reads the tables that files give into times, positions and angles, which take the place of the file in the resolved
/// case. `tables`: names and texts of the files; a name is relative to the case file that names it. Notes what is wrong
/// with them. To be called once, before the motions are used.
void take_motion_tables(Keys& keys, int dimension, const std::vector<NamedText>& tables,
                        std::vector<MotionEntry>& motions);

/// Sets names that are not given.
void derive_motions(const Keys& keys, std::vector<MotionEntry>& motions);

/// Notes names that are used twice, ends before starts, tables that are no motion, and axes without a direction.
void check_motions(Keys& keys, int dimension, const std::vector<MotionEntry>& motions);

/// True where all that the motion depends on has allowed values.
bool is_usable(const Keys& keys, const MotionEntry& motion);

/// Nothing if the table makes none.
template <int Dim>
std::optional<Motion<Dim>> motion_of(const MotionEntry& motion);

/// At most about `most` times from 0 to `end` that tell the motion [s]; the first is 0.
std::vector<double> times_of(const MotionEntry& motion, double end, std::size_t most);

}  // namespace impinge
