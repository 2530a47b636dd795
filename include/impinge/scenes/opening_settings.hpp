#pragma once
// Inlets and outlets of a scene: [[inlet]] and [[outlet]] of a case file.

#include <optional>
#include <string>
#include <vector>

#include "impinge/boundaries/inlet.hpp"
#include "impinge/config/key.hpp"
#include "impinge/geometry/outline.hpp"
#include "impinge/method/settings.hpp"
#include "impinge/scenes/shape_settings.hpp"

namespace impinge {

/// What an inlet's plane has of fluid: a line in two dimensions, one of the others in three.
enum class InletSection { line, circle, annulus, rectangle };
constexpr auto words(InletSection) {
  return std::to_array<std::string_view>({"line", "circle", "annulus", "rectangle"});
}

/// One table of [[inlet]].
struct InletEntry {
  static constexpr double never = 1e30;  ///< [s]

  std::string name;
  Numbers center{};     ///< of the inlet's plane [m]
  Numbers direction{};  ///< of the flow, of any length [-]
  InletSection section = InletSection::line;
  double width = 0.0;          ///< of a line or a rectangle [m]
  double height = 0.0;         ///< of a rectangle [m]
  Numbers across{};            ///< direction of a rectangle's width, of any length [-]
  double radius = 0.0;         ///< of a circle or an annulus [m]
  double inner_radius = 0.0;   ///< of an annulus [m]
  double speed = 0.0;          ///< [m/s]
  std::vector<double> times;   ///< of the speeds [s]
  std::vector<double> speeds;  ///< in the place of speed: linear in between [m/s]
  /// Distances from the axis of a circle or an annulus, or along the width from the middle [m], and what the speed is
  /// multiplied by there: linear in between, constant before and after; none: uniform.
  std::vector<double> profile_at, profile;
  double start = 0.0;   ///< [s]
  double stop = never;  ///< [s]
};

/// One table of [[outlet]].
struct OutletEntry : ShapeSettings {
  std::string name;
};

/// Declares [[inlet]] and [[outlet]].
void declare_openings(Keys& keys, std::vector<InletEntry>& inlets, std::vector<OutletEntry>& outlets);

/// Sets names and fixed points that are not given.
void derive_openings(const Keys& keys, int dimension, std::vector<InletEntry>& inlets,
                     std::vector<OutletEntry>& outlets);

/// Notes what is wrong with each inlet by itself, and inlets that overlap. The keys of `dimension` and `spacing` [m]
/// are usable.
void check_inlets(Keys& keys, int dimension, double spacing, const KernelSettings& kernel,
                  const std::vector<InletEntry>& inlets);

/// Notes shapes without an inside and names that are used twice.
void check_outlets(Keys& keys, int dimension, const std::vector<OutletEntry>& outlets);

/// True where what an inlet's place depends on has allowed values that make one. `spacing`: dp [m].
bool is_usable(const Keys& keys, int dimension, double spacing, const InletEntry& inlet);

/// The largest speed at any time and place [m/s].
double largest_speed(const InletEntry& inlet);

/// The mean of its profile over the section [-]; 1 without one.
double mean_of_profile(const InletEntry& inlet);

/// The inlet with its rows in place, if it blows at the start. Rows stand a little closer or farther apart than dp, so
/// that what enters has the inlet's width or area.
template <int Dim>
Inlet<Dim> inlet_of(const InletEntry& entry, double spacing, const KernelSettings& kernel);

/// The inlet, or where it has a profile the rings or strips that it is made of, about a spacing wide. Each of them is a
/// block by itself with the profile's mean over it, so that what enters is exact. Those that stand still are left out.
template <int Dim>
std::vector<Inlet<Dim>> parts_of(const InletEntry& entry, double spacing, const KernelSettings& kernel);

/// The part of an inlet's way between two distances past its plane, narrower by `margin` at both sides [m].
Outline way_of(const Inlet<2>& inlet, double width, double from, double to, double margin);

/// Nothing if its numbers make none.
template <int Dim>
std::optional<Outlet<Dim>> outlet_of(const OutletEntry& entry);

}  // namespace impinge
