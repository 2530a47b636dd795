// Jets in three dimensions: what they meet, and their measures on particles laid out on the exact flow. No measure
// knows how the scene is turned.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "impinge/core/errors.hpp"
#include "impinge/geometry/transform.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/validation/jet_comparison.hpp"
#include "impinge/validation/round_jet_comparison.hpp"
#include "impinge/validation/space_target.hpp"

namespace impinge {
namespace {

using std::numbers::pi;

constexpr double radius = 0.1, diameter = 0.2, speed = 1.5, density = 1000.0, dp = 0.02;
constexpr double dynamic_pressure = 0.5 * density * speed * speed;
constexpr double jet_area = pi * radius * radius;
constexpr double degree = pi / 180.0;
constexpr double window = 0.5;    // of the wall average [s]
constexpr double distance = 0.5;  // of the inlet from the plate along its axis [m]
constexpr double golden = 0.6180339887498949;

/// Turns a scene in space, and moves it.
struct Turn {
  Matrix<3> rotation = Matrix<3>::identity();
  Vector<3> shift{};

  Vector<3> operator()(const Vector<3>& r) const { return shift + rotation * r; }
  static std::string text(const Vector<3>& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); }
  std::string point(const Vector<3>& r) const { return text((*this)(r)); }
  std::string points(const std::vector<Vector<3>>& corners) const {
    std::vector<std::string> texts;
    for (const Vector<3>& corner : corners) texts.push_back(point(corner));
    return fmt::format("[{}]", fmt::join(texts, ", "));
  }
};

/// The identity, and random ones; the same at every call.
std::vector<Turn> turns() {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Turn> turns(1);
  for (int k = 0; k < 3; ++k) {
    const Vector<3> axis{{normal(random), normal(random), normal(random)}};
    turns.push_back({rotation(1.0 / norm(axis) * axis, 180.0 * normal(random)), {{0.3, -0.1, 0.2}}});
  }
  return turns;
}

Case case_of(const std::string& rest, const std::vector<NamedText>& files = {}) {
  std::vector<NamedText> texts{{"scene.toml", fmt::format(R"(geometry = "scene"
dimension = 3
particles.spacing = {}
time.end = 2.0
time.dt = 1e-3
domain.low = [-3, -3, -3]
domain.high = [3, 3, 3]
{})",
                                                          dp, rest)}};
  texts.insert(texts.end(), files.begin(), files.end());
  return parse_case(texts);
}

/// The jet's direction in the frame of the plate.
Vector<3> way_at(double angle) { return {{std::cos(angle * degree), 0.0, -std::sin(angle * degree)}}; }

std::string inlet(const Turn& turn, const Vector<3>& foot, double angle, const std::string& section,
                  const std::string& speeds = fmt::format("speed = {}", speed)) {
  return fmt::format("[[inlet]]\ncenter = {}\ndirection = {}\n{}\n{}\n", turn.point(foot - distance * way_at(angle)),
                     Turn::text(turn.rotation * way_at(angle)), section, speeds);
}

const std::string circle = fmt::format("section = \"circle\"\nradius = {}", radius);

/// A round jet whose film leaves the origin.
std::string round_inlet(const Turn& turn, double angle) {
  return inlet(turn, {{radius / std::tan(angle * degree), 0.0, 0.0}}, angle, circle);
}

std::string polygon(const Turn& turn, const std::vector<Vector<3>>& corners, const std::string& more = "") {
  return fmt::format("[[wall]]\nshape = \"polygon\"\npoints = {}\nwet = \"front\"\n{}", turn.points(corners), more);
}

/// The part of the plane z = 0 between two corners.
std::string plate(const Turn& turn, const Vector<2>& low, const Vector<2>& high, const std::string& more = "") {
  return polygon(
      turn, {{{low[0], low[1], 0.0}}, {{high[0], low[1], 0.0}}, {{high[0], high[1], 0.0}}, {{low[0], high[1], 0.0}}},
      more);
}

std::string square(const Turn& turn, double half, const std::string& more = "") {
  return plate(turn, {{-half, -half}}, {{half, half}}, more);
}

std::string refusal(const std::string& rest) {
  const Case config = case_of(rest);
  try {
    jet_target(config);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

double area_of(const SpacePlate& space) {
  double sum = 0.0;
  for (const auto& [id, point] : space.points) sum += point.area;
  return sum;
}

TEST(RoundJetTarget, IsFoundHoweverItIsTurned) {
  for (const Turn& turn : turns()) {
    for (const double angle : {90.0, 60.0, 45.0}) {
      SCOPED_TRACE(fmt::format("{} {}", turn.point({}), angle));
      const JetTarget target = jet_target(case_of(round_inlet(turn, angle) + square(turn, 0.7)));
      EXPECT_EQ(target.type, TargetType::flat_wall);
      EXPECT_NEAR(target.angle, angle * degree, 1e-9);
      EXPECT_EQ(target.width, diameter);
      EXPECT_NEAR(target.distance, distance, 1e-9);
      ASSERT_TRUE(target.space);
      const SpacePlate& space = *target.space;
      EXPECT_EQ(space.depth, 0.0);
      EXPECT_LT(norm(space.origin - turn({})), 1e-9);
      EXPECT_LT(norm(space.z - turn.rotation * Vector<3>{{0.0, 0.0, 1.0}}), 1e-9);
      EXPECT_LT(norm(space.y - cross(space.z, space.x)), 1e-12);
      if (angle < 90.0) {
        EXPECT_LT(norm(space.x - turn.rotation * Vector<3>{{1.0, 0.0, 0.0}}), 1e-9);
        EXPECT_NEAR(target.begin, -0.7, 0.01 * dp);
        EXPECT_NEAR(target.end, 0.7, 0.01 * dp);
      }
      EXPECT_NEAR(space.reach, 0.7, 1e-3);
      EXPECT_NEAR(area_of(space), 1.4 * 1.4, 0.01);
    }
  }
}

TEST(RoundJetTarget, MayBeManyFacesThatOfABoxOrAMesh) {
  const Turn turn;
  const std::string jet = round_inlet(turn, 90.0);
  const std::string box = "[[wall]]\nshape = \"box\"\nlow = [-0.7, -0.7, -0.3]\nhigh = [0.7, 0.7, 0]\n";
  const std::string pieces = plate(turn, {{-0.7, -0.7}}, {{0.02, 0.7}}) + plate(turn, {{0.02, -0.7}}, {{0.7, 0.7}});
  const std::string mesh = "[[wall]]\nshape = \"mesh\"\nfile = \"plate.obj\"\nwet = \"front\"\n";
  const NamedText file{"plate.obj", "v -0.7 -0.7 0\nv 0.7 -0.7 0\nv 0.7 0.7 0\nv -0.7 0.7 0\nf 1 2 3\nf 1 3 4\n"};
  for (const std::string& wall : {box, pieces, mesh}) {
    const JetTarget target = jet_target(case_of(jet + wall, {file}));
    EXPECT_NEAR(target.space->reach, 0.7, 1e-3);
    EXPECT_NEAR(area_of(*target.space), 1.4 * 1.4, 0.01);
  }
}

TEST(RoundJetTarget, EndsAtOutletsAndOtherWalls) {
  const Turn turn;
  const std::string base = round_inlet(turn, 60.0) + square(turn, 0.7);
  const auto box = [](const std::string& kind) {
    return fmt::format("[[{}]]\nshape = \"box\"\nlow = [-0.9, -0.9, -0.1]\nhigh = [-0.5, 0.9, 0.2]\n", kind);
  };
  for (const std::string kind : {"outlet", "wall"}) {
    const JetTarget target = jet_target(case_of(base + box(kind)));
    EXPECT_NEAR(target.begin, -0.5, 1e-3) << kind;
    EXPECT_NEAR(target.end, 0.7, 1e-3) << kind;
    EXPECT_NEAR(target.space->reach, 0.5, 1e-3) << kind;
    EXPECT_NEAR(area_of(*target.space), 1.2 * 1.4, 0.03) << kind;
  }
}

TEST(SpaceJetTarget, WhatIsNotMeasuredIsToldApart) {
  const Turn turn;
  const std::string jet = inlet(turn, {}, 90.0, circle), wall = square(turn, 0.7);
  const std::string rectangle = "section = \"rectangle\"\nwidth = 0.1\nheight = 0.2\nacross = [0, 1, 0]";
  const auto side = [&](double y, double low, double slope = 0.0) {
    const double x = y > 0.0 ? 1.0 : -1.0;
    return polygon(turn,
                   {{{-x, y - slope, low}}, {{x, y + slope, low}}, {{x, y + slope, 1.0}}, {{-x, y - slope, 1.0}}});
  };
  const std::string ramp =
      polygon(turn, {{{-1.0, -1.0, -0.5}}, {{1.0, -1.0, -0.5}}, {{1.0, 1.0, 0.5}}, {{-1.0, 1.0, 0.5}}});
  const std::string grazing =
      "[[inlet]]\ncenter = [-2.2, 0, 0.035]\ndirection = [2.2, 0, -0.035]\nsection = \"circle\"\nradius = 0.03\nspeed "
      "= 1\n";
  const std::string moving =
      "motion = \"stroke\"\n[[motion]]\nname = \"stroke\"\ntype = \"harmonic\"\namplitude = [0, 0, 0.1]\nfrequency = "
      "0.5\n";
  const std::pair<std::string, std::string> cases[] = {
      {"[[fluid.region]]\nshape = \"sphere\"\nradius = 0.2\ncenter = [0, 0, 0]\n", "it has 0 inlets"},
      {jet + inlet(turn, {{1.0, 0.0, 0.0}}, 90.0, circle) + wall, "it has 2 inlets"},
      {inlet(turn, {}, 90.0, circle, "times = [0.0, 1.0]\nspeeds = [1.0, 2.0]") + wall,
       "the speed of the inlet inlet_1 changes in time"},
      {inlet(turn, {}, 90.0, "section = \"annulus\"\nradius = 0.2\ninner_radius = 0.1") + wall, "is an annulus"},
      {jet, "its inlet's axis meets no wall"},
      {jet + "[[wall]]\nshape = \"sphere\"\nradius = 0.3\ncenter = [0, 0, -0.3]\n", "is not flat"},
      {jet + square(turn, 0.7, moving), "the wall wall_1 that its jet meets moves"},
      {jet + polygon(turn, {{{-1.0, -1.0, 0.0}}, {{-1.0, 1.0, 0.0}}, {{1.0, 1.0, 0.0}}, {{1.0, -1.0, 0.0}}}),
       "its jet meets the dry side of the wall wall_1"},
      {grazing + wall, "its jet grazes a wall"},
      {jet + square(turn, 0.25), "reaches 1.25 jet diameters from the stagnation point, at 0 degrees"},
      {inlet(turn, {}, 90.0, rectangle) + wall, "is not the gap between two walls"},
      {inlet(turn, {}, 90.0, rectangle) + wall + side(0.05, 0.0) + side(-0.06, 0.0),
       "is not the gap between two walls"},
      {inlet(turn, {}, 90.0, rectangle) + wall + side(0.05, 0.0, 0.02) + side(-0.05, 0.0), "are not parallel"},
      {inlet(turn, {}, 90.0, rectangle) + wall + side(0.05, 0.2) + side(-0.05, 0.0), "do not reach from the inlet"},
      {inlet(turn, {}, 90.0, rectangle) + ramp + side(0.05, -1.0) + side(-0.05, -1.0), "is not perpendicular"},
      {inlet(turn, {}, 90.0, rectangle) + square(turn, 0.25) + side(0.05, 0.0) + side(-0.05, 0.0),
       "reaches from -1.25 to 1.25 jet widths"},
  };
  for (const auto& [rest, part] : cases) {
    const std::string message = refusal(rest);
    EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
    EXPECT_NE(message.find("Measured are: "), std::string::npos);
  }
}

/// The wall particles of a scene with a pressure [Pa] at a place in the frame of the plate.
Particles<3> wall_particles(const Case& config, const SpacePlate& space,
                            const std::function<double(const Vector<3>&)>& pressure) {
  Particles<3> particles;
  for (const WallPoint<3>& point : make_scene<3>(config, config).wall_points) {
    const double value = pressure(space.of_position(point.position));
    particles.append({point.position, {}, value, value * window, particles.owned, ParticleType::wall});
  }
  return particles;
}

/// Adds a film of radial flow from the stagnation point, by its thickness times the distance at an azimuth and a
/// distance [m^2]; between two distances [m]. Its particles fill it evenly, at other places for another `phase`.
void append_flow(const SpacePlate& space, double begin, double end, double fluid_speed,
                 const std::function<double(double, double)>& depth_times_r, int phase, Particles<3>& particles) {
  constexpr int rays = 720;
  constexpr double step = 0.1 * dp;
  for (int k = 0; k < rays; ++k) {
    const double azimuth = 2.0 * pi * (k + 0.5) / rays;
    const Vector<3> out = std::cos(azimuth) * space.x + std::sin(azimuth) * space.y;
    double rest = std::fmod((k + phase * rays) * golden, 1.0);  // of a particle
    for (double r = begin + 0.5 * step; r < end; r += step) {
      rest += depth_times_r(azimuth, r) * step * 2.0 * pi / rays / (dp * dp * dp);
      for (; rest >= 1.0; rest -= 1.0)
        particles.append({space.origin + r * out + 0.5 * depth_times_r(azimuth, r) / r * space.z, fluid_speed * out,
                          0.0, 0.0, particles.owned, ParticleType::fluid});
    }
  }
}

JetMetrics compare(const JetTarget& target, const std::vector<Particles<3>>& snapshots) {
  RoundJetComparison comparison(target);
  comparison.set_wall_average(snapshots.back(), window);
  for (const auto& snapshot : snapshots) comparison.add_snapshot(snapshot);
  return comparison.metrics();
}

/// An exact round jet at 90 degrees, or its film by film_law at other angles. There the pressure on the plate is that
/// at 90 degrees, about the foot of the axis.
struct ExactRoundJet {
  Case config;
  JetTarget target;
  Particles<3> particles;

  ExactRoundJet(const Turn& turn, double angle)
      : config(case_of(round_inlet(turn, angle) + square(turn, 1.1))), target(jet_target(config)) {
    const RoundJet jet(radius, speed, density);
    const double foot = radius / std::tan(target.angle);
    particles = wall_particles(config, *target.space, [&](const Vector<3>& place) {
      return jet.wall_pressure(std::hypot(place[0] - (angle < 90.0 ? foot : 0.0), place[1]));
    });
    append_film(0, particles);
  }

  void append_film(int phase, Particles<3>& to) const {
    const RoundJet jet(radius, speed, density);
    const bool is_oblique = !is_perpendicular(target);
    append_flow(
        *target.space, (is_oblique ? 0.2 : RoundJet::film_begin) * radius, 10.9 * radius, speed,
        [&](double azimuth, double r) {
          return is_oblique ? radius * radius * film_law(target.angle, azimuth) : r * jet.film(r);
        },
        phase, to);
  }
};

TEST(RoundJetComparison, ExactJetHasNoErrorHoweverItIsTurned) {
  for (const Turn& turn : turns()) {
    const ExactRoundJet exact(turn, 90.0);
    const JetMetrics metrics = compare(exact.target, {exact.particles, exact.particles});
    EXPECT_NEAR(metrics.wall_l2.value(), 0.0, 1e-9);
    EXPECT_NEAR(metrics.wall_l2_near.value(), 0.0, 1e-9);
    EXPECT_NEAR(metrics.force_ratio.value(), 1.0, 1e-3);
    EXPECT_NEAR(metrics.force_scatter.value(), 0.0, 1e-12);
    EXPECT_NEAR(std::hypot(metrics.centre_x.value(), metrics.centre_y.value()), 0.0, 2e-3);
    EXPECT_NEAR(metrics.stagnation_ratio.value(), 1.0, 1e-2);  // the mean of a disc of radius dp
    EXPECT_EQ(metrics.stagnation_ratio.value(), metrics.stagnation_mean.value() / dynamic_pressure);
    EXPECT_NEAR(metrics.stagnation_scatter.value(), 0.0, 1e-9);
    EXPECT_NEAR(metrics.peak_pressure.value(), metrics.stagnation_mean.value(), 5e-3 * dynamic_pressure);
    EXPECT_NEAR(metrics.film_at_d.value(), 1.0, 5e-3);
    EXPECT_NEAR(metrics.film_at_1_5_d.value(), 1.0, 5e-3);
    EXPECT_NEAR(metrics.film_flux.value(), 1.01, 1.5e-2);  // all of the cloud has the speed U
    EXPECT_FALSE(metrics.film_momentum);
    EXPECT_FALSE(metrics.film_law_rms);
    EXPECT_FALSE(metrics.field_l2);
  }
}

TEST(RoundJetComparison, ProfilesOfTheExactJetAreExact) {
  const ExactRoundJet exact({}, 90.0);
  RoundJetComparison comparison(exact.target);
  comparison.set_wall_average(exact.particles, window);
  comparison.add_snapshot(exact.particles);
  const auto wall = comparison.wall_profile();
  ASSERT_NEAR(static_cast<double>(wall.size()), 1.1 / dp, 1.0);
  for (const PlatePoint& point : wall) EXPECT_NEAR(point.pressure, point.analytic, 1e-9) << point.x;
  EXPECT_EQ(comparison.wall_map().size(), exact.target.space->points.size());
  const auto film = comparison.film_profile();
  ASSERT_GT(film.size(), 15u);
  for (const FilmColumn& column : film) {
    if (column.x > 10.5 * radius) continue;
    EXPECT_NEAR(column.thickness, column.analytic, 0.02 * column.analytic) << column.x;
  }
}

TEST(RoundJetComparison, LeavesOutWhatTheFilmPressesWithBeyondThePlate) {
  constexpr double small = 0.8, large = 1.1;  // half the side of a square around the origin [m]
  for (const double angle : {90.0, 60.0}) {
    const auto plate = [&](double half) {
      return *jet_target(case_of(round_inlet({}, angle) + square({}, half))).space;
    };
    const SpacePlate one = plate(small), other = plate(large);
    constexpr double step = 0.01;
    double force = 0.0, moment = 0.0;  // of the pressure rho U^2 (h/r)^2 between the squares, over rho U^2 A
    for (double x = -large + 0.5 * step; x < large; x += step) {
      for (double y = -large + 0.5 * step; y < large; y += step) {
        if (std::max(std::abs(x), std::abs(y)) < small) continue;
        const double from_origin = std::hypot(x, y);
        const double slope = radius * radius * film_law(angle * degree, std::atan2(y, x)) / std::pow(from_origin, 2);
        force += slope * slope * step * step / (pi * radius * radius);
        moment += x * slope * slope * step * step / (pi * radius * radius);
      }
    }
    EXPECT_NEAR(one.force_beyond - other.force_beyond, force, 0.02 * force) << angle;
    EXPECT_NEAR(one.moment_beyond - other.moment_beyond, moment, 0.02 * force) << angle;
  }
}

TEST(RoundJetComparison, FilmLawHasTheExactFluxAndMomentum) {
  for (const double angle : {75.0, 60.0, 45.0}) {
    const ExactRoundJet exact(turns().back(), angle);
    RoundJetComparison films(exact.target);
    for (int phase = 0; phase < 64; ++phase) {  // the ring has but 196 particles
      Particles<3> film;
      exact.append_film(phase, film);
      films.add_snapshot(film);
    }
    EXPECT_NEAR(films.metrics().film_flux.value(), 1.0, 2e-3) << angle;        // measured 1e-3
    EXPECT_NEAR(films.metrics().film_momentum.value(), 1.0, 1.2e-2) << angle;  // measured 7e-3
    EXPECT_NEAR(films.metrics().film_law_rms.value(), 0.0, 0.08) << angle;

    const JetMetrics metrics = compare(exact.target, {exact.particles});
    // The whole pressure is about the foot of the axis, but what is expected ends with the plate.
    const SpacePlate& plate = *exact.target.space;
    const double sine = std::sin(angle * degree), foot = radius / std::tan(angle * degree);
    const double expected = (foot * sine - plate.moment_beyond) / (sine - plate.force_beyond);
    EXPECT_NEAR(metrics.force_ratio.value(), 1.0 / (sine - plate.force_beyond), 1e-2) << angle;
    EXPECT_NEAR(metrics.centre_x.value(), (foot - expected) / (2.0 * radius), 1e-2) << angle;
    EXPECT_NEAR(metrics.centre_y.value(), 0.0, 2e-3) << angle;
    EXPECT_NEAR(metrics.peak_x.value(), radius / std::tan(angle * degree), dp) << angle;
    EXPECT_NEAR(metrics.stagnation_ratio.value(), 1.0, 1e-2) << angle;
    EXPECT_FALSE(metrics.wall_l2);
    EXPECT_FALSE(metrics.film_at_d);
  }
}

TEST(RoundJetComparison, TurningTheWholeFlowChangesNothing) {
  for (const double angle : {90.0, 60.0}) {
    ExactRoundJet exact({}, angle);
    for (double& impulse : exact.particles.pressure_impulse) impulse *= 1.1;
    const JetMetrics before = compare(exact.target, {exact.particles});
    const Turn turn = turns().back();
    SpacePlate& space = *exact.target.space;
    space.origin = turn(space.origin);
    for (Vector<3>* axis : {&space.x, &space.y, &space.z}) *axis = turn.rotation * *axis;
    for (Vector<3>& position : exact.particles.position) position = turn(position);
    for (Vector<3>& velocity : exact.particles.velocity) velocity = turn.rotation * velocity;
    const JetMetrics after = compare(exact.target, {exact.particles});
    for (const auto value :
         {&JetMetrics::wall_l2, &JetMetrics::wall_l2_near, &JetMetrics::force_ratio, &JetMetrics::centre_x,
          &JetMetrics::centre_y, &JetMetrics::stagnation_mean, &JetMetrics::peak_pressure, &JetMetrics::peak_x,
          &JetMetrics::film_at_d, &JetMetrics::film_at_1_5_d, &JetMetrics::film_flux, &JetMetrics::film_momentum,
          &JetMetrics::film_law_rms}) {
      ASSERT_EQ((after.*value).has_value(), (before.*value).has_value());
      if (after.*value) {
        EXPECT_NEAR(*(after.*value), *(before.*value), 1e-9 * std::max(1.0, std::abs(*(before.*value))));
      }
    }
  }
}

TEST(RoundJetComparison, ErrorsComeOutAsMade) {
  const ExactRoundJet exact({}, 90.0);
  auto wrong = exact.particles;
  for (double& impulse : wrong.pressure_impulse) impulse *= 1.1;
  for (std::size_t i = 0; i < wrong.pressure.size(); ++i) {
    wrong.pressure[i] *= 0.8;
    wrong.velocity[i] *= 0.9;
  }
  const JetMetrics right = compare(exact.target, {exact.particles}), metrics = compare(exact.target, {wrong});
  EXPECT_NEAR(metrics.wall_l2.value(), 0.1, 1e-9);
  EXPECT_NEAR(metrics.wall_l2_near.value(), 0.1, 1e-9);
  EXPECT_NEAR(metrics.force_ratio.value(), 1.1 * right.force_ratio.value(), 1e-9);
  EXPECT_NEAR(metrics.stagnation_ratio.value(), 0.8 * right.stagnation_ratio.value(), 1e-9);
  EXPECT_NEAR(metrics.film_flux.value(), 0.9 * right.film_flux.value(), 1e-9);
  EXPECT_EQ(metrics.film_at_d.value(), right.film_at_d.value());

  auto torn = exact.particles;
  torn.velocity.back()[1] = std::nan("");
  const JetMetrics without = compare(exact.target, {exact.particles, torn});
  EXPECT_FALSE(without.film_flux);
  EXPECT_FALSE(without.film_at_d);
  EXPECT_TRUE(without.force_ratio);
}

TEST(RoundJetComparison, JetThatPassesOverTheThinSheetIsLeftOut) {
  ExactRoundJet exact({}, 30.0);
  const JetMetrics before = compare(exact.target, {exact.particles});
  const Vector<3> foot{{radius / std::tan(30.0 * degree), 0.0, 0.0}}, way = way_at(30.0);
  const Vector<3> across{{0.0, 1.0, 0.0}}, up = cross(way, across);
  for (double along = 2.0 * radius; along < distance; along += dp)
    for (double a = -radius; a <= radius; a += dp)
      for (double b = -radius; b <= radius; b += dp)
        if (std::hypot(a, b) <= radius)
          exact.particles.append({foot - along * way + a * across + b * up, speed * way, 0.0, 0.0,
                                  exact.particles.owned, ParticleType::fluid});
  const JetMetrics after = compare(exact.target, {exact.particles});
  EXPECT_NEAR(after.film_flux.value(), before.film_flux.value(), 1e-12);
  EXPECT_NEAR(after.film_momentum.value(), before.film_momentum.value(), 1e-12);
}

TEST(RoundJetComparison, WithoutAnAverageAnObliqueJetHasNoStagnationPoint) {
  const ExactRoundJet exact({}, 60.0);
  RoundJetComparison comparison(exact.target);
  comparison.add_snapshot(exact.particles);
  const JetMetrics metrics = comparison.metrics();
  EXPECT_FALSE(metrics.stagnation_mean);
  EXPECT_FALSE(metrics.force_ratio);
  EXPECT_FALSE(metrics.centre_x);
  EXPECT_TRUE(metrics.film_flux);
  EXPECT_TRUE(comparison.wall_profile().empty());
}

constexpr double slot_width = 0.4, depth = 0.1;

std::string slot_inlet(const Turn& turn, double angle) {
  const AnalyticJet jet(slot_width, speed, density, angle * degree);
  const std::string section = fmt::format("section = \"rectangle\"\nwidth = {}\nheight = {}\nacross = {}", depth,
                                          slot_width, Turn::text(turn.rotation * Vector<3>{{0.0, 1.0, 0.0}}));
  return inlet(turn, {{jet.axis_position(), 0.0, 0.0}}, angle, section);
}

std::string slot(const Turn& turn, double angle) {
  const auto side = [&](double y) {
    const double x = y > 0.0 ? 2.0 : -2.0;
    return polygon(turn, {{{-x, y, 0.0}}, {{x, y, 0.0}}, {{x, y, 2.0}}, {{-x, y, 2.0}}});
  };
  return slot_inlet(turn, angle) + plate(turn, {{-1.6, -0.5 * depth}}, {{2.0, 0.5 * depth}}) + side(0.5 * depth) +
         side(-0.5 * depth);
}

/// The exact jet in the plane, disturbed; without wall particles.
Particles<2> plane_cloud(double angle) {
  const AnalyticJet jet(slot_width, speed, density, angle * degree);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Particles<2> particles;
  for (double x = -1.59; x < 2.0; x += dp) {
    for (double y = 0.5 * dp; y < 1.0; y += dp) {
      const auto state = jet.state({{x, y}});
      if (!state) continue;
      const Vector<2> wrong{{0.05 * normal(random), 0.05 * normal(random)}};
      particles.append({{{x, y}},
                        state->velocity + wrong,
                        state->pressure * (1.0 + 0.1 * normal(random)),
                        0.0,
                        particles.owned,
                        ParticleType::fluid});
      particles.free_surface.back() = jet.nearest_surface({{x, y}}).depth < dp ? 1 : 0;
    }
  }
  return particles;
}

TEST(SlotJet, HasTheMetricsOfThePlaneJetHoweverItIsTurned) {
  constexpr double angle = 60.0;
  const AnalyticJet jet(slot_width, speed, density, angle * degree);
  const Particles<2> plane = plane_cloud(angle);
  for (const Turn& turn : turns()) {
    const Case config = case_of(slot(turn, angle));
    const JetTarget target = jet_target(config);
    EXPECT_EQ(target.type, TargetType::plate);
    EXPECT_NEAR(target.angle, angle * degree, 1e-9);
    EXPECT_EQ(target.width, slot_width);
    EXPECT_NEAR(target.begin, -1.6, 1e-3);
    EXPECT_NEAR(target.end, 2.0, 1e-3);
    ASSERT_TRUE(target.space);
    const SpacePlate& space = *target.space;
    EXPECT_EQ(space.depth, depth);
    EXPECT_LT(norm(space.origin - turn({})), 1e-9);

    Particles<3> cloud =
        wall_particles(config, space, [&](const Vector<3>& place) { return 1.02 * jet.wall_pressure(place[0]); });
    for (double y = -0.5 * (depth - dp); y < 0.5 * depth; y += dp) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(plane.owned); ++i) {
        const Vector<2>&position = plane.position[i], &velocity = plane.velocity[i];
        cloud.append({turn({{position[0], y, position[1]}}), turn.rotation * Vector<3>{{velocity[0], 0.1, velocity[1]}},
                      plane.pressure[i], 0.0, cloud.owned, ParticleType::fluid});
        cloud.free_surface.back() = plane.free_surface[i];
      }
    }
    JetComparison comparison(target);
    comparison.set_wall_average(in_frame(target, cloud), window);
    comparison.add_snapshot(in_frame(target, cloud));
    const JetMetrics metrics = comparison.metrics();
    EXPECT_NEAR(metrics.wall_l2.value(), 0.02, 2e-3);  // a column is not its middle
    EXPECT_NEAR(metrics.force_ratio.value(), 1.02, 5e-3);
    EXPECT_NEAR(metrics.stagnation_ratio.value(), 1.02, 5e-3);

    JetTarget of_plane = target;
    of_plane.space.reset();
    JetComparison in_plane(of_plane);
    in_plane.add_snapshot(plane);
    const JetMetrics expected = in_plane.metrics();
    for (const auto value : {&JetMetrics::field_l2, &JetMetrics::velocity_rms, &JetMetrics::surface_rms_dp,
                             &JetMetrics::film_h1, &JetMetrics::film_h2})
      EXPECT_NEAR((metrics.*value).value(), (expected.*value).value(), 1e-6);
    EXPECT_NEAR(metrics.mean_field_l2.value(), expected.mean_field_l2.value(), 1e-2);  // bins end at the particles
  }
}

TEST(SlotJet, GapMayBeTheInsideOfABox) {
  const std::string box =
      fmt::format("[[wall]]\nshape = \"box\"\nlow = [-1.6, {0}, 0]\nhigh = [2, {1}, 2]\nwet = \"inside\"\n",
                  -0.5 * depth, 0.5 * depth);
  const JetTarget target = jet_target(case_of(slot_inlet({}, 90.0) + box));
  EXPECT_EQ(target.type, TargetType::plate);
  EXPECT_NEAR(target.end - target.begin, 3.6, 1e-3);
  double length = 0.0;
  for (const auto& [column, point] : target.points.value()) length += point.length;
  EXPECT_NEAR(length, 3.6, 2.0 * dp);
}

TEST(SlotJet, AtNinetyDegreesRunsAlongTheGap) {
  for (const Turn& turn : turns()) {
    const JetTarget target = jet_target(case_of(slot(turn, 90.0)));
    EXPECT_NEAR(target.angle, 90.0 * degree, 1e-9);
    const Vector<3> x = turn.rotation * Vector<3>{{1.0, 0.0, 0.0}};
    EXPECT_NEAR(std::abs(dot(target.space->x, x)), 1.0, 1e-9);
    EXPECT_NEAR(target.end - target.begin, 3.6, 1e-3);
  }
}

}  // namespace
}  // namespace impinge
