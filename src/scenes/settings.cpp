#include "impinge/scenes/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "impinge/boundaries/wall.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/scenes/open_scene_settings.hpp"

namespace impinge {
namespace {

double radians(double degrees) { return std::min(degrees * std::numbers::pi / 180.0, 0.5 * std::numbers::pi); }

/// What the plate must catch, in the plate's coordinate [m].
struct Reach {
  double low, high;    ///< ends of the stretch that the straight, prolonged jet meets
  double thin, thick;  ///< where Cp falls to 0.01 in the thin and in the thick sheet
};

Reach reach_of(const JetSettings& jet) {
  const AnalyticJet flow(jet.width, 1.0, 1.0, radians(jet.angle));  // the shape knows no speed or density
  const double half = 0.5 * jet.width / std::sin(flow.angle());
  return {.low = flow.axis_position() - half,
          .high = flow.axis_position() + half,
          .thin = flow.plate_position_of_cp(0.01, AnalyticJet::Side::h2),
          .thick = flow.plate_position_of_cp(0.01, AnalyticJet::Side::h1)};
}

/// The first numbers, one per dimension.
std::span<const double> components(const Numbers& x, int dimension) {
  return {x.data(), static_cast<std::size_t>(dimension)};
}

double product(std::span<const double> x) { return std::accumulate(x.begin(), x.end(), 1.0, std::multiplies{}); }

/// `setting` is one length or several.
template <class T>
void check_multiples(Keys& keys, const SceneInputs& in, const T& setting, std::span<const double> lengths) {
  if (!keys.usable(setting, in.spacing)) return;
  for (const double length : lengths) {
    const double count = length / in.spacing;
    if (std::abs(count - std::round(count)) <= 1e-6 && count > 0.5) continue;
    const double above = std::max(1.0, std::ceil(count)) * in.spacing;
    const double below = std::floor(count) * in.spacing;
    // Digits enough for the named lengths to be multiples, too.
    const std::string nearest = below > 0.0 ? fmt::format("nearest are {:.12g} and {:.12g}", below, above)
                                            : fmt::format("least is {:.12g}", above);
    keys.mistake(setting,
                 fmt::format("{} m is {:.9g} particle spacings; allowed: integer multiples of particles.spacing = {} "
                             "(m), the {}",
                             number_text(length), count, number_text(in.spacing), nearest));
  }
}

void check_jet(Keys& keys, const JetSettings& jet, const PlateSettings& plate, const SceneInputs& in) {
  if (keys.usable(jet.width, jet.inlet_distance)) check_count(keys, in, jet.inlet_distance * jet.width * jet.width);
  if (keys.usable(in.dimension) && in.dimension != 2)
    keys.mistake(in.dimension, "the jet has two dimensions; allowed: 2");
  check_multiples(keys, in, jet.width, {&jet.width, 1});
  if (keys.usable(jet.width, in.spacing) && jet.width < (5.0 - 1e-6) * in.spacing)
    keys.mistake(jet.width, fmt::format("narrower than 5 particles; allowed: >= {:.6g} (m)", 5.0 * in.spacing));
  if (keys.usable(jet.angle, jet.inlet_distance)) {
    // The inlet's lower corner stands H above the plate: d sin a - cos a / 2 >= 1.
    const double angle = radians(jet.angle);
    const double least = (1.0 + 0.5 * std::cos(angle)) / std::sin(angle);
    if (jet.inlet_distance < least) {
      keys.mistake(
          jet.inlet_distance,
          fmt::format("the inlet's lower corner is less than H above the plate; allowed: >= {:.6g} (H)", least));
    }
  }
  if (keys.usable(jet.width, jet.angle)) {
    const auto [low, high, thin, thick] = reach_of(jet);
    const std::string misses = fmt::format(
        "the jet misses the plate, which must reach beyond the stagnation point x = 0 and from x = {:.6g} m "
        "to {:.6g} m; allowed: ",
        low, high);
    if (keys.given(plate.begin) && keys.usable(plate.begin) && (plate.begin >= 0.0 || plate.begin > low))
      keys.mistake(plate.begin, misses + (low < 0.0 ? fmt::format("<= {:.6g} (m)", low) : "< 0 (m)"));
    if (keys.given(plate.end) && keys.usable(plate.end) && plate.end < high)
      keys.mistake(plate.end, misses + fmt::format(">= {:.6g} (m)", high));
  }
}

void check_tank(Keys& keys, const TankSettings& tank, const std::vector<FluidRegion>& regions, const SceneInputs& in) {
  const bool mirrored = keys.usable(in.walls.model) && in.walls.model == WallModel::mirror;
  const auto size = components(tank.size, in.dimension);
  if (keys.usable(tank.size)) check_count(keys, in, product(size));
  check_multiples(keys, in, tank.size, size);
  if (tank.fluid_height > 0.0) check_multiples(keys, in, tank.fluid_height, {&tank.fluid_height, 1});
  if (keys.usable(tank.fluid_height, regions) && (tank.fluid_height > 0.0) == !regions.empty()) {
    keys.mistake(tank.fluid_height, regions.empty()
                                        ? "no fluid: neither a height nor a [[fluid.region]]; allowed: > 0 (m)"
                                        : "the fluid is given by [[fluid.region]], too; allowed: one of the two");
  }
  if (mirrored && keys.usable(tank.size, in.spacing, in.kernel.radius, in.kernel.laplacian_radius)) {
    const double least = std::max<double>(in.kernel.largest(), wall_layers) * in.spacing;
    if (std::ranges::min(size) < least) {
      keys.mistake(tank.size,
                   fmt::format("mirrors nearer to each other than the kernel reaches; allowed: >= {:.6g} (m)", least));
    }
  }
  if (keys.usable(tank.size, tank.fluid_height) && tank.fluid_height > size.back()) {
    keys.mistake(tank.fluid_height,
                 fmt::format("higher than the walls; allowed: (0, {}] (m)", number_text(size.back())));
  }
}

void check_box(Keys& keys, const PeriodicBoxSettings& box, const SceneInputs& in) {
  const auto size = components(box.size, in.dimension);
  if (keys.usable(box.size)) check_count(keys, in, product(size));
  check_multiples(keys, in, box.size, size);
  if (keys.usable(box.size, in.spacing, in.kernel.radius, in.kernel.laplacian_radius)) {
    const double least = 3.0 * in.kernel.cell_edge() * in.spacing;
    if (std::ranges::min(size) < least) {
      keys.mistake(box.size,
                   fmt::format("a period is shorter than three background cells; allowed: >= {:.6g} (m)", least));
    }
  }
}

/// The largest gravity at any time [m/s^2].
double largest_gravity(const Keys& keys, const FluidSettings& fluid) {
  const auto strength = [&](const Numbers& g) { return keys.usable(g) ? std::hypot(g[0], g[1], g[2]) : 0.0; };
  if (fluid.gravity_at.empty()) return strength(fluid.gravity);
  double largest = 0.0;
  for (const GravityEntry& entry : fluid.gravity_at) largest = std::max(largest, strength(entry.value));
  return largest;
}

/// Where the regions may have fluid [m].
Box<3> room_of(const Keys& keys, const SceneSettings& s) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (keys.usable(s.tank.size)) return {{}, {s.tank.size}};
  if (keys.usable(s.domain.low, s.domain.high)) return {{s.domain.low}, {s.domain.high}};
  return {{{-infinity, -infinity, -infinity}}, {{infinity, infinity, infinity}}};
}

}  // namespace

void declare_scenes(Keys& keys, SceneSettings& s) {
  keys.only_where(s.geometry, {SceneType::jet}, [&] {
    keys.add("jet.width", s.jet.width, "jet width H, a multiple of dp",
             {.unit = "m", .range = positive, .required = true, .fixed = true});
    keys.add("jet.speed", s.jet.speed, "jet speed U",
             {.unit = "m/s", .range = positive, .required = true, .fixed = true});
    keys.add("jet.angle", s.jet.angle, "angle between jet and plate",
             {.unit = "deg", .range = from_to(1, 90), .required = true, .fixed = true});
    keys.add("jet.inlet_distance", s.jet.inlet_distance, "distance of the inlet from the plate along the jet's axis",
             {.unit = "H", .range = positive, .fixed = true});
    keys.add("jet.start", s.jet.start, "impact: a column about to hit the plate; steady: the analytic jet",
             {.fixed = true});
    keys.add("plate.begin", s.plate.begin, "left end of the plate, from the stagnation point; negative",
             {.unit = "m", .fixed = true, .fallback = "beyond the thin sheet's Cp = 0.01"});
    keys.add("plate.end", s.plate.end, "right end of the plate, from the stagnation point; positive",
             {.unit = "m", .fixed = true, .fallback = "beyond the thick sheet's Cp = 0.01"});
  });
  keys.only_where(s.geometry, {SceneType::tank}, [&] {
    keys.add("tank.size", s.tank.size, "inner lengths, multiples of dp; the last is the height of the walls",
             {.unit = "m", .range = positive, .required = true, .fixed = true});
    keys.add("tank.fluid_height", s.tank.fluid_height,
             "height of the fluid at rest, a multiple of dp; 0: the fluid is that of [[fluid.region]]",
             {.unit = "m", .range = not_negative, .fixed = true});
  });
  keys.only_where(s.geometry, {SceneType::periodic_box}, [&] {
    keys.add("periodic_box.size", s.periodic_box.size, "periods, multiples of dp",
             {.unit = "m", .range = positive, .required = true, .fixed = true});
    keys.add("periodic_box.shear_speed", s.periodic_box.shear_speed,
             "amplitude U of the initial velocity u_x = U sin(2 pi y / L_y)",
             {.unit = "m/s", .range = not_negative, .fixed = true});
    keys.add("periodic_box.vortex_speed", s.periodic_box.vortex_speed,
             "amplitude V of Taylor-Green vortices at the start, added to it: u_x = -V cos(2 pi x / L_x) sin(2 pi y / "
             "L_y), u_y = V L_y / L_x sin(2 pi x / L_x) cos(2 pi y / L_y)",
             {.unit = "m/s", .range = not_negative, .fixed = true});
  });
  keys.only_where(s.geometry, {SceneType::scene}, [&] {
    keys.add("domain.low", s.domain.low, "corner of the bounds with the smallest coordinates",
             {.unit = "m", .fixed = true, .fallback = "the fluid's longest side below fluid, walls and inlets"});
    keys.add("domain.high", s.domain.high, "corner of the bounds with the largest coordinates",
             {.unit = "m", .fixed = true, .fallback = "the fluid's longest side above fluid, walls and inlets"});
  });
  keys.only_where(s.geometry, {SceneType::tank, SceneType::scene}, [&] { declare_fluid(keys, s.regions); });
  keys.only_where(s.geometry, {SceneType::scene}, [&] {
    declare_walls(keys, s.scene_walls);
    declare_motions(keys, s.motions);
    declare_openings(keys, s.inlets, s.outlets);
  });
}

double reference_speed(const Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  const double gravity = largest_gravity(keys, in.fluid);
  if (keys.usable(s.jet.speed, s.jet.width, s.jet.inlet_distance))
    return std::hypot(s.jet.speed, std::sqrt(2.0 * gravity * s.jet.inlet_distance * s.jet.width));
  if (keys.usable(s.tank.fluid_height) && s.regions.empty()) return std::sqrt(2.0 * gravity * s.tank.fluid_height);
  if (s.geometry == SceneType::scene || !s.regions.empty()) return open_scene_speed(keys, s, in, gravity);
  const PeriodicBoxSettings& box = s.periodic_box;
  if (!keys.usable(box.size, box.shear_speed, box.vortex_speed)) return 0.0;
  return box.shear_speed + box.vortex_speed * std::max(1.0, box.size[1] / box.size[0]);
}

void derive_scene(const Keys& keys, SceneSettings& s, const SceneInputs& in) {
  derive_fluid(keys, in.dimension, s.regions);
  if (s.geometry == SceneType::scene) derive_open_scene(keys, s, in);
  if (!keys.usable(s.jet.width, s.jet.angle, in.spacing)) return;
  const auto [low, high, thin, thick] = reach_of(s.jet);
  const double width = s.jet.width;
  const double begin = std::min({-2.25 * width, thin - 1.25 * width, low - 0.75 * width});
  const double end = std::max({4.25 * width, thick + 0.75 * width, high + 0.75 * width});
  if (!keys.given(s.plate.begin)) s.plate.begin = std::floor(begin / in.spacing + 1e-6) * in.spacing;
  if (!keys.given(s.plate.end)) s.plate.end = std::ceil(end / in.spacing - 1e-6) * in.spacing;
}

void check_scene(Keys& keys, const SceneSettings& s, const SceneInputs& in) {
  if (!keys.usable(s.geometry)) return;
  if (keys.usable(in.dimension, in.spacing)) check_fluid(keys, in.dimension, in.spacing, room_of(keys, s), s.regions);
  switch (s.geometry) {
    case SceneType::jet:
      return check_jet(keys, s.jet, s.plate, in);
    case SceneType::tank:
      return check_tank(keys, s.tank, s.regions, in);
    case SceneType::periodic_box:
      return check_box(keys, s.periodic_box, in);
    case SceneType::scene:
      return check_open_scene(keys, s, in);
  }
}

}  // namespace impinge
