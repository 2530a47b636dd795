#include "impinge/method/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace impinge {
namespace {

/// The defaults that the scheme sets: use(setting, value of the consistent scheme, value of the paper's).
template <class Use>
void for_scheme_defaults(MethodSettings& s, Use&& use) {
  use(s.kernel.radius, 2.6, 2.1);
  use(s.kernel.laplacian_radius, s.dimension == 3 ? 2.1 : 2.6, 4.01);
  use(s.fluid.corrected_viscosity, true, false);
  use(s.pressure.density_rate, s.dimension == 3 ? 1.0 : 0.1, 0.0);
  use(s.pressure.packing, true, false);
  use(s.pressure.corrected_divergence, true, false);
  use(s.pressure.corrected_gradient, true, false);
  use(s.pressure.clamp_negative, false, true);
  use(s.walls.model, WallModel::mirror, WallModel::particles);
  use(s.free_surface.zero_outside, true, false);
  use(s.shifting.coefficient, s.dimension == 3 ? 3.0 : 1.0, 0.0);
  use(s.shifting.least_distance, 0.9, 0.0);
  use(s.shifting.correct_velocity, true, false);
  use(s.smoothing.rate, 0.2, 0.0);
  use(s.collision.distance, 0.5, 0.8);
  use(s.time.mean_velocity, true, false);
}

/// "singular: r_e/r - 1; ...".
std::string kernel_formulas() {
  const auto join = [](auto... kernel) {
    return fmt::format("{}", fmt::join(std::array{fmt::format("{}: {}", kernel.word, kernel.formula)...}, "; "));
  };
  return std::apply(join, Kernels{});
}

}  // namespace

void declare_method(Keys& keys, MethodSettings& s) {
  static const std::string formulas = kernel_formulas();  // keys refer to it
  keys.add("dimension", s.dimension, "dimension of space; the jet has 2", {.range = from_to(2, 3), .fixed = true});
  keys.add("scheme", s.scheme, "paper: the operators of Tang & Wan; consistent: more accurate ones", {.fixed = true});

  keys.add("fluid.density", s.fluid.density, "density rho", {.unit = "kg/m^3", .range = positive, .fixed = true});
  keys.add("fluid.viscosity", s.fluid.viscosity, "kinematic viscosity nu", {.unit = "m^2/s", .range = not_negative});
  keys.add("fluid.corrected_viscosity", s.fluid.corrected_viscosity,
           "viscosity without a stress at the free surface and in a rotation; false: it acts as the Laplacian of the "
           "velocity, by the paper");
  keys.add("fluid.smagorinsky", s.fluid.smagorinsky,
           "C_s of Smagorinsky's viscosity of eddies smaller than a spacing, nu_t = (C_s dp)^2 sqrt(2 D:D), D the rate "
           "of strain; 0: none; usual: 0.1 to 0.2; needs fluid.corrected_viscosity",
           {.unit = "dp", .range = from_to(0, 0.5)});
  keys.add("fluid.gravity", s.fluid.gravity, "gravity; the last component is the vertical one", {.unit = "m/s^2"});
  keys.add("fluid.central_force", s.fluid.central_force, "B of a force per mass -B^2 (r - fluid.force_center)",
           {.unit = "1/s", .range = not_negative});
  keys.add("fluid.force_center", s.fluid.force_center, "centre of that force", {.unit = "m"});
  keys.list("fluid.gravity_at", s.fluid.gravity_at,
            "gravity at a time, instead of fluid.gravity; linear between the times, constant before and after", {},
            [](Keys& inner, GravityEntry& entry) {
              inner.add("time", entry.time, "time", {.unit = "s", .required = true});
              inner.add("value", entry.value, "gravity at this time", {.unit = "m/s^2", .required = true});
            });

  keys.add("particles.spacing", s.particles.spacing, "particle spacing dp",
           {.unit = "m", .range = positive, .required = true, .fixed = true});

  keys.add("kernel.type", s.kernel.type, formulas, {.fixed = true});
  keys.add("kernel.radius", s.kernel.radius, "effective radius of number density, gradient and divergence",
           {.unit = "dp", .range = above_to(1, 6), .fixed = true});
  keys.add("kernel.laplacian_radius", s.kernel.laplacian_radius, "effective radius of the Laplacian",
           {.unit = "dp", .range = above_to(1, 6), .fixed = true, .fallback = "in 3D 2.1"});

  keys.add("pressure.gamma", s.pressure.gamma,
           "weight of the density term in the source of the pressure equation, unless pressure.density_rate "
           "is set; 1 - gamma weighs the divergence",
           {.range = from_to(0, 1)});
  keys.add("pressure.density_rate", s.pressure.density_rate,
           "rate at which density errors are corrected: gamma is this times u dt/dp, at most 1 (u: the largest fluid "
           "speed, at least 3 sqrt(|g| dp)); 0: pressure.gamma",
           {.unit = "u/dp", .range = from_to(0, 5), .fallback = "in 3D 1.0; 0.0 where gamma is given"});
  keys.add("pressure.packing", s.pressure.packing,
           "measure density errors by the sum of (1 - r/r_e)^4 (1 + 4 r/r_e), which disorder leaves alone, "
           "and its mean around a particle, instead of the number density");
  keys.add("pressure.corrected_divergence", s.pressure.corrected_divergence,
           "correct the divergence by the local moment matrix, so that it is exact on linear velocities");
  keys.add("pressure.corrected_gradient", s.pressure.corrected_gradient,
           "a gradient of pressure differences corrected likewise, with p = 0 beyond the surface particles; the "
           "rougher the surface, the more of the paper's at it, and of the smallest pressure around beside it");
  keys.add("pressure.tolerance", s.pressure.tolerance,
           "relative residual at which the pressure equation counts as solved", {.range = above_to(0, 1e-6)});
  keys.add(
      "pressure.clamp_negative", s.pressure.clamp_negative,
      "set negative pressures to zero after the solve; false: only where fluid tears, beside a free surface that is "
      "rough or in disordered motion, or by a wall");

  keys.add("walls.model", s.walls.model,
           "mirror: the fluid's mirror images; particles: wall particles, and ghosts without a pressure",
           {.fixed = true});

  keys.add(
      "domain.outside", s.outside,
      "remove: fluid that leaves the bounds other than by an outlet is removed and counted; error: it ends the run");

  keys.add("free_surface.surface_density", s.free_surface.surface_density,
           "a particle of smaller number density is on the free surface", {.unit = "n0", .range = from_to(0, 1)});
  keys.add("free_surface.interior_density", s.free_surface.interior_density,
           "a particle of larger number density is inside the fluid", {.unit = "n0", .range = from_to(0, 2)});
  keys.add("free_surface.asymmetry", s.free_surface.asymmetry,
           "between the two densities: on the free surface if the asymmetry |F| is larger than this",
           {.unit = "|F|0", .range = from_to(0, 2)});
  keys.add("free_surface.zero_outside", s.free_surface.zero_outside,
           "p = 0 half a spacing outside the surface particles instead of at them");

  keys.add("shifting.coefficient", s.shifting.coefficient,
           "particles drift by this times the asymmetry F and u_ref dt/dp each step (u_ref: the largest fluid "
           "speed, at least sqrt(|g| dp)), at most by 0.1 dp, not through the free surface, spray not at all; "
           "0: none do",
           {.unit = "dp", .range = from_to(0, 10), .fallback = "in 3D 3.0"});
  keys.add("shifting.least_distance", s.shifting.least_distance,
           "beside the free surface, fluid particles nearer than this drift apart, by the difference times "
           "shifting.coefficient and u_ref dt/dp; 0: none do",
           {.unit = "dp", .range = from_to(0, 1)});
  keys.add("shifting.correct_velocity", s.shifting.correct_velocity,
           "a particle that drifts takes the velocity of its new place, by the local gradient");

  keys.add("smoothing.rate", s.smoothing.rate,
           "rate at which velocities off the linear field of their neighbours decay; u: the largest fluid speed, at "
           "least 3 sqrt(|g| dp); 0: they do not",
           {.unit = "u/dp", .range = from_to(0, 2)});

  keys.add("collision.distance", s.collision.distance, "approaching particles nearer than this collide; 0: none do",
           {.unit = "dp", .range = from_to(0, 1)});
  keys.add("collision.restitution", s.collision.restitution, "coefficient of restitution of a collision",
           {.range = from_to(0, 1)});

  keys.add("time.end", s.time.end, "time at which the run ends", {.unit = "s", .range = positive, .required = true});
  keys.add("time.dt", s.time.dt,
           "largest time step; the first has at most cfl = 0.05, and a step at most 1.1 times the last",
           {.unit = "s", .range = positive, .required = true});
  keys.add("time.cfl", s.time.cfl, "the time step is at most cfl dp / |u|max", {.range = above_to(0, 1)});
  keys.add("time.mean_velocity", s.time.mean_velocity,
           "particles move for half a step with their old velocity and for half with their new one, and the "
           "pressure is that in between; false: with the new one");
  keys.add("time.max_speed", s.time.max_speed, "a faster particle counts as divergence and ends the run",
           {.unit = "m/s",
            .range = positive,
            .fallback = "20 x the jet's speed after its fall to the plate, sqrt(2 |gravity| tank.fluid_height), "
                        "that of the periodic box or that of the regions"});

  declare_damping(keys, s.damping);

  for_scheme_defaults(s, [&](auto& setting, auto consistent, auto paper) {
    std::string& text = keys.of(setting).about.fallback;
    text = fmt::format("{}; paper: {}{}{}", value_text(consistent), value_text(paper), text.empty() ? "" : "; ", text);
  });
}

void derive_method(const Keys& keys, MethodSettings& s, double reference_speed) {
  for_scheme_defaults(s, [&](auto& setting, auto consistent, auto paper) {
    if (!keys.given(setting)) setting = s.scheme == Scheme::consistent ? consistent : paper;
  });
  derive_damping(keys, s.damping);
  if (keys.given(s.pressure.gamma) && !keys.given(s.pressure.density_rate)) s.pressure.density_rate = 0.0;
  if (!keys.given(s.time.max_speed)) {
    if (reference_speed == 0.0 && keys.usable(s.particles.spacing, s.time.dt))
      reference_speed = s.particles.spacing / s.time.dt;  // fluid at rest: one spacing a step
    s.time.max_speed = 20.0 * reference_speed;
  }
}

void check_method(Keys& keys, const MethodSettings& s) {
  if (keys.usable(s.dimension)) check_damping(keys, s.dimension, s.damping);
  for (std::size_t k = 1; k < s.fluid.gravity_at.size(); ++k) {
    const GravityEntry &before = s.fluid.gravity_at[k - 1], &here = s.fluid.gravity_at[k];
    if (keys.usable(before.time, here.time) && here.time <= before.time)
      keys.mistake(here.time, fmt::format("the times do not rise; allowed: > {} (s)", number_text(before.time)));
  }
  if (keys.usable(s.fluid.smagorinsky, s.fluid.corrected_viscosity) && s.fluid.smagorinsky > 0.0 &&
      !s.fluid.corrected_viscosity)
    keys.mistake(s.fluid.smagorinsky, "needs fluid.corrected_viscosity = true; allowed: 0 (dp)");
  const FreeSurfaceSettings& surface = s.free_surface;
  if (keys.usable(surface.surface_density, surface.interior_density) &&
      surface.surface_density > surface.interior_density) {
    keys.mistake(surface.surface_density, fmt::format("larger than the interior's density; allowed: [0, {}] (n0)",
                                                      number_text(surface.interior_density)));
  }
  if (keys.usable(s.fluid.viscosity, s.particles.spacing, s.time.dt) && s.fluid.viscosity > 0.0) {
    const double limit = 0.2 * s.particles.spacing * s.particles.spacing / s.fluid.viscosity;
    if (s.time.dt > limit)
      keys.mistake(s.time.dt, fmt::format("above the viscous limit 0.2 dp^2/nu; allowed: (0, {:.6g}] (s)", limit));
  }
}

std::vector<std::string> scheme_warnings(const MethodSettings& s) {
  std::vector<std::string> warnings;
  if (s.scheme == Scheme::paper) return warnings;
  const auto warn_if = [&](bool off, const char* text) {
    if (off) warnings.emplace_back(text);
  };
  warn_if(s.walls.model == WallModel::particles,
          "walls.model = \"particles\": with scheme = \"consistent\", water at rest explodes between such walls");
  warn_if(!s.free_surface.zero_outside,
          "free_surface.zero_outside = false: with scheme = \"consistent\", water at rest boils from its surface");
  warn_if(
      s.shifting.coefficient == 0.0,
      "shifting.coefficient = 0: with scheme = \"consistent\", particles line up and the pressure of a jet is noise");
  warn_if(s.collision.distance == 0.0,
          "collision.distance = 0: with scheme = \"consistent\", an impact can diverge where particles come close");
  return warnings;
}

}  // namespace impinge
