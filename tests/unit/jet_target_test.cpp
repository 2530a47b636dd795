// What a jet of a scene meets, and that its measures do not know how the scene is turned.

#include "impinge/validation/jet_target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "impinge/core/errors.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/scenes/scenes.hpp"
#include "impinge/validation/analytic_wedge.hpp"
#include "impinge/validation/jet_comparison.hpp"

namespace impinge {
namespace {

using Side = AnalyticJet::Side;

constexpr double width = 0.4, speed = 1.5, dp = 0.02;
constexpr double degree = std::numbers::pi / 180.0;

/// Turns a scene about a point off the origin, after it is mirrored at y = 0.
struct Turn {
  double degrees = 0.0;
  bool mirrored = false;

  Vector<2> direction(Vector<2> v) const {
    if (mirrored) v[1] = -v[1];
    const double c = std::cos(degrees * degree), s = std::sin(degrees * degree);
    return {{c * v[0] - s * v[1], s * v[0] + c * v[1]}};
  }
  Vector<2> operator()(const Vector<2>& r) const { return Vector<2>{{0.3, -0.1}} + direction(r); }
  std::string text(const Vector<2>& r) const { return fmt::format("[{}, {}]", (*this)(r)[0], (*this)(r)[1]); }
  std::string points(const std::vector<Vector<2>>& corners) const {
    std::vector<std::string> texts;
    for (const Vector<2>& corner : corners) texts.push_back(text(corner));
    return fmt::format("[{}]", fmt::join(texts, ", "));
  }
};

constexpr Turn turns[] = {{0.0, false}, {10.0, false},  {17.0, true},  {45.0, false},
                          {90.0, true}, {133.0, false}, {-160.0, true}};

Case case_of(const std::string& rest) {
  return parse_case({{"scene.toml", fmt::format(R"(geometry = "scene"
particles.spacing = {}
time.end = 2.0
time.dt = 1e-4
domain.low = [-5, -5]
domain.high = [5, 5]
)",
                                                dp) +
                                        rest}});
}

std::string inlet(const Turn& turn, const Vector<2>& center, const Vector<2>& direction, const std::string& more = "") {
  const Vector<2> way = turn.direction(direction);
  return fmt::format("[[inlet]]\ncenter = {}\ndirection = [{}, {}]\nwidth = {}\n{}\n", turn.text(center), way[0],
                     way[1], width, more.empty() ? fmt::format("speed = {}", speed) : more);
}

std::string line(const Turn& turn, const std::vector<Vector<2>>& points, const std::string& wet = "left") {
  const bool flips = turn.mirrored && wet != "both";
  return fmt::format("[[wall]]\nshape = \"polyline\"\npoints = {}\nwet = \"{}\"\n", turn.points(points),
                     flips ? (wet == "left" ? "right" : "left") : wet);
}

std::string polygon(const Turn& turn, const std::string& kind, const std::vector<Vector<2>>& points) {
  return fmt::format("[[{}]]\nshape = \"polygon\"\npoints = {}\n", kind, turn.points(points));
}

AnalyticJet jet_at(double angle) { return {width, speed, 1000.0, angle * degree}; }

/// The inlet of a jet at an angle on the line y = 0, in the frame of the analytic jet; its axis comes from the left.
std::string inlet_above(const Turn& turn, double angle) {
  const double c = std::cos(angle * degree), s = std::sin(angle * degree);
  return inlet(turn, {{jet_at(angle).axis_position() - 1.6 * c, 1.6 * s}}, {{c, -s}});
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

void expect_plate(const JetTarget& target, const Turn& turn, double angle, double begin, double end) {
  EXPECT_EQ(target.type, TargetType::plate);
  EXPECT_NEAR(target.angle, angle * degree, 1e-12);
  EXPECT_NEAR(target.distance, 1.6, 1e-12);
  EXPECT_NEAR(target.begin, begin, 1e-9);
  EXPECT_NEAR(target.end, end, 1e-9);
  for (const Vector<2>& place : {Vector<2>{}, Vector<2>{{1.0, 0.0}}, Vector<2>{{0.3, 0.7}}})
    EXPECT_LT(norm(target.frame.of_position(turn(place)) - place), 1e-12);
  double length = 0.0;
  for (const auto& [id, point] : target.points.value()) {
    EXPECT_GT(point.x, begin);
    EXPECT_LT(point.x, end);
    EXPECT_EQ(point.share, 1.0);
    length += point.length;
  }
  EXPECT_NEAR(length, end - begin, 1.01 * dp);
}

TEST(JetTarget, PlateIsFoundHoweverItIsTurned) {
  for (const Turn& turn : turns) {
    for (const double angle : {30.0, 60.0}) {
      SCOPED_TRACE(fmt::format("{} {} {}", turn.degrees, turn.mirrored, angle));
      expect_plate(jet_target(case_of(inlet_above(turn, angle) + line(turn, {{{-1.6, 0.0}}, {{2.0, 0.0}}}))), turn,
                   angle, -1.6, 2.0);
    }
  }
  // At 90 degrees either way along the plate may be x.
  const JetTarget across = jet_target(case_of(inlet_above({}, 90.0) + line({}, {{{-1.5, 0.0}}, {{1.5, 0.0}}})));
  EXPECT_EQ(across.type, TargetType::plate);
  EXPECT_NEAR(across.angle, 90.0 * degree, 1e-12);
  EXPECT_NEAR(across.end - across.begin, 3.0, 1e-12);
}

TEST(JetTarget, PlateMayBeManyPiecesOrAFace) {
  for (const Turn& turn : {Turn{}, Turn{17.0, false}, Turn{-40.0, true}}) {
    const std::string jet = inlet_above(turn, 60.0);
    std::string pieces;
    for (int k = 0; k < 36; ++k)  // end to end in either direction
      pieces += k % 2 ? line(turn, {{{-1.6 + 0.1 * k, 0.0}}, {{-1.5 + 0.1 * k, 0.0}}})
                      : line(turn, {{{-1.5 + 0.1 * k, 0.0}}, {{-1.6 + 0.1 * k, 0.0}}}, "right");
    expect_plate(jet_target(case_of(jet + pieces)), turn, 60.0, -1.6, 2.0);
    std::vector<Vector<2>> points;
    for (int k = 0; k <= 100; ++k) points.push_back({{-1.6 + 0.036 * k, 0.0}});
    expect_plate(jet_target(case_of(jet + line(turn, points, "both"))), turn, 60.0, -1.6, 2.0);
    expect_plate(
        jet_target(case_of(jet + polygon(turn, "wall", {{{-1.6, -1.0}}, {{2.0, -1.0}}, {{2.0, 0.0}}, {{-1.6, 0.0}}}))),
        turn, 60.0, -1.6, 2.0);
    // Another wall elsewhere is none of it, and outlets end it.
    expect_plate(jet_target(case_of(
                     jet + line(turn, {{{-1.6, 0.0}}, {{2.0, 0.0}}}) + line(turn, {{{-1.6, -0.4}}, {{2.0, -0.4}}}) +
                     polygon(turn, "outlet", {{{1.7, -0.1}}, {{2.5, -0.1}}, {{2.5, 1.0}}, {{1.7, 1.0}}}))),
                 turn, 60.0, -1.6, 1.7);
  }
}

TEST(JetTarget, ShortPlateAcrossIsAWedgeOfNinetyDegrees) {
  for (const Turn& turn : turns) {
    const JetTarget target =
        jet_target(case_of(inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}}) + line(turn, {{{0.0, -0.3}}, {{0.0, 0.3}}})));
    EXPECT_EQ(target.type, TargetType::wedge);
    EXPECT_NEAR(target.angle, 90.0 * degree, 1e-9);
    EXPECT_NEAR(target.end, 0.3, 1e-9);
    EXPECT_NEAR(target.begin, -0.3, 1e-9);
    EXPECT_TRUE(target.sheets.empty());  // they leave it at an angle
  }
}

TEST(JetTarget, WedgeIsFoundHoweverItIsTurned) {
  for (const Turn& turn : turns) {
    for (const double angle : {30.0, 60.0, 120.0}) {
      SCOPED_TRACE(fmt::format("{} {} {}", turn.degrees, turn.mirrored, angle));
      const double c = 2.0 * std::cos(angle * degree), s = 2.0 * std::sin(angle * degree);
      const JetTarget target = jet_target(
          case_of(inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}}) + line(turn, {{{c, -s}}, {{0.0, 0.0}}, {{c, s}}})));
      EXPECT_EQ(target.type, TargetType::wedge);
      EXPECT_NEAR(target.angle, angle * degree, 1e-9);
      EXPECT_NEAR(target.end, 2.0, 1e-5);
      EXPECT_NEAR(target.begin, -2.0, 1e-5);
      EXPECT_EQ(target.points->size(), 200u);
      for (const auto& [id, point] : *target.points) EXPECT_NEAR(point.share, std::sin(angle * degree), 1e-12);
      ASSERT_EQ(target.sheets.size(), 2u);
      for (const JetTarget::Sheet& sheet : target.sheets) {
        EXPECT_NEAR(sheet.length, 1.5 * width, 1e-12);
        EXPECT_NEAR(norm(sheet.frame.origin - turn({{0.0, 0.0}})), 2.0 - 2.0 * width, 1e-9);
        EXPECT_GT(dot(sheet.frame.y, turn.direction({{-1.0, 0.0}})), 0.0);
      }
    }
  }
}

TEST(JetTarget, CupIsFoundFromArcAndLips) {
  for (const auto& [degrees, wet] : {std::pair{0.0, "left"}, std::pair{25.0, "left"}}) {
    const Turn turn{degrees, false};
    const std::string arc =
        fmt::format("[[wall]]\nshape = \"arc\"\ncenter = {}\nradius = 0.8\nfrom = {}\nto = {}\nwet = \"{}\"\n",
                    turn.text({{0.0, 0.0}}), degrees - 90.0, degrees + 90.0, wet);
    const std::string jet = inlet(turn, {{-0.8, 0.0}}, {{1.0, 0.0}});
    const JetTarget target = jet_target(
        case_of(jet + arc + line(turn, {{{-1.6, -0.8}}, {{0.0, -0.8}}}) + line(turn, {{{0.0, 0.8}}, {{-1.6, 0.8}}})));
    EXPECT_EQ(target.type, TargetType::cup);
    EXPECT_NEAR(target.angle, 180.0 * degree, 1e-6);
    EXPECT_NEAR(target.end, 0.4 * std::numbers::pi + 1.6, 1e-5);
    EXPECT_EQ(target.sheets.size(), 2u);
    double force = 0.0;  // of the pressure 1: the width of the cup
    for (const auto& [id, point] : *target.points) force += point.length * point.share;
    EXPECT_NEAR(force, 1.6, 1e-3);
    // Without lips the sheets leave along the arc's ends.
    const JetTarget bowl = jet_target(case_of(jet + arc));
    EXPECT_EQ(bowl.type, TargetType::cup);
    EXPECT_TRUE(bowl.sheets.empty());
  }
}

TEST(JetTarget, TwoEqualJetsMeetInTheMiddle) {
  for (const Turn& turn : turns) {
    const JetTarget target =
        jet_target(case_of(inlet(turn, {{-1.4, 0.2}}, {{1.0, 0.0}}) + inlet(turn, {{1.6, 0.2}}, {{-1.0, 0.0}}) +
                           polygon(turn, "outlet", {{{-1.0, 1.8}}, {{1.0, 1.8}}, {{1.0, 2.0}}, {{-1.0, 2.0}}}) +
                           polygon(turn, "outlet", {{{-1.0, -1.8}}, {{1.0, -1.8}}, {{1.0, -2.0}}, {{-1.0, -2.0}}})));
    EXPECT_EQ(target.type, TargetType::jet);
    EXPECT_LT(norm(target.frame.origin - turn({{0.1, 0.2}})), 1e-9);
    EXPECT_LT(norm(target.frame.y - turn.direction({{-1.0, 0.0}})), 1e-9);
    EXPECT_NEAR(std::min(-target.begin, target.end), 1.6, 1e-9);
    EXPECT_NEAR(std::max(-target.begin, target.end), 2.0, 1e-9);
  }
}

TEST(JetTarget, WhatIsNotMeasuredIsToldApart) {
  const Turn turn;
  const std::string jet = inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}});
  const std::string plate = line(turn, {{{0.0, -2.0}}, {{0.0, 2.0}}});
  const std::string drop = "[[fluid.region]]\nshape = \"circle\"\nradius = 0.2\ncenter = [3.0, 3.0]\n";
  const std::pair<std::string, std::string> cases[] = {
      {drop, "it has 0 inlets"},
      {jet, "its inlet's axis meets no wall"},
      {jet + line(turn, {{{0.0, 0.0}}, {{0.0, 2.0}}}), "its inlet's axis meets the end of a wall"},
      {jet + line(turn, {{{0.0, -0.4}}, {{0.0, 0.3}}, {{-0.3, 0.6}}}), "is not symmetric"},
      {jet + line(turn, {{{-0.2, -0.3}}, {{0.2, 0.3}}}), "from -"},
      {jet + "[[wall]]\nshape = \"circle\"\nradius = 0.3\ncenter = [0.3, 0.0]\n", "curves away"},
      {jet + plate + polygon(turn, "outlet", {{{-0.2, -0.2}}, {{0.2, -0.2}}, {{0.2, 0.2}}, {{-0.2, 0.2}}}),
       "an outlet is where its jet meets a wall"},
      {inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}}, "times = [0.0, 1.0]\nspeeds = [1.0, 2.0]") + plate,
       "the speed of the inlet inlet_1 changes in time"},
      {jet + plate +
           "motion = \"stroke\"\n[[motion]]\nname = \"stroke\"\ntype = \"harmonic\"\namplitude = [0.1, "
           "0.0]\nfrequency = 0.5\n",
       "the wall wall_1 that its jet meets moves"},
      {jet + inlet(turn, {{1.4, 0.5}}, {{-1.0, 0.0}}), "do not blow at each other"},
      {jet + inlet(turn, {{1.4, 0.0}}, {{-1.0, 0.0}}, "speed = 1.0"), "its two jets are not equal"},
      {jet + inlet(turn, {{1.4, 0.0}}, {{-1.0, 0.0}}) + line(turn, {{{0.0, -2.0}}, {{0.0, 2.0}}}, "both"),
       "a wall is between"},
  };
  for (const auto& [rest, part] : cases) {
    const std::string message = refusal(rest);
    EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
    EXPECT_NE(message.find("Measured are: "), std::string::npos);
  }
}

/// The exact jet on the plate of a scene, wall particles as the scene makes them.
Particles<2> exact_state(const Case& config, const Turn& turn, double angle) {
  const AnalyticJet jet = jet_at(angle);
  Particles<2> particles;
  make_scene<2>(config, config).fill(0, 1, particles);
  particles.resize(particles.owned);
  const JetTarget target = jet_target(config);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    particles.pressure[i] = 1.01 * jet.wall_pressure(target.frame.of_position(particles.position[i])[0]);
    particles.pressure_impulse[i] = 0.5 * particles.pressure[i];
  }
  for (int column = -60; column < 90; ++column) {
    const double x = (column + 0.503) * dp, shift = std::fmod(0.618034 * (column + 100), 1.0);
    for (double y = (0.001 + 0.998 * shift) * dp; y < 3.0 * width; y += dp)
      if (const auto state = jet.state({{x, y}})) {
        particles.append({turn({{x, y}}), turn.direction(1.02 * state->velocity), 0.97 * state->pressure, 0.0,
                          100000 + particles.owned, ParticleType::fluid});
        particles.free_surface.back() = state->pressure < 0.01 * jet.stagnation_pressure() ? 1 : 0;
      }
  }
  return particles;
}

TEST(JetTarget, MetricsDoNotKnowHowThePlateIsTurned) {
  for (const double angle : {30.0, 60.0}) {
    std::optional<JetMetrics> first;
    for (const Turn& turn : turns) {
      const Case config = case_of(inlet_above(turn, angle) + line(turn, {{{-1.6, 0.0}}, {{2.0, 0.0}}}));
      const JetTarget target = jet_target(config);
      const Particles<2> particles = in_frame(target, exact_state(config, turn, angle));
      JetComparison comparison(target);
      comparison.set_wall_average(particles, 0.5);
      comparison.add_snapshot(particles);
      comparison.add_snapshot(particles);
      const JetMetrics metrics = comparison.metrics();
      if (!first) {
        first = metrics;
        EXPECT_NEAR(metrics.wall_l2.value(), 0.01, 1e-9);
        EXPECT_NEAR(metrics.force_ratio.value(), 1.01, 3e-3);
        EXPECT_NEAR(metrics.field_l2.value(), 0.03, 1e-9);
        EXPECT_NEAR(metrics.film_h1.value(), comparison.analytic_film(Side::h1).value(), 0.01);
        continue;
      }
      SCOPED_TRACE(fmt::format("{} {} {}", turn.degrees, turn.mirrored, angle));
      for (const auto metric : {&JetMetrics::wall_l2, &JetMetrics::force_ratio, &JetMetrics::peak_x,
                                &JetMetrics::field_l2, &JetMetrics::mean_field_l2, &JetMetrics::velocity_rms,
                                &JetMetrics::surface_rms_dp, &JetMetrics::film_h1, &JetMetrics::film_h2}) {
        ASSERT_TRUE(metrics.*metric);
        EXPECT_NEAR((metrics.*metric).value(), ((*first).*metric).value(), 1e-12);
      }
      EXPECT_NEAR(metrics.stagnation_mean.value(), first->stagnation_mean.value(), 1e-9);
    }
  }
}

TEST(JetTarget, WedgeIsMeasuredByItsExactPressureAndSheets) {
  const Turn turn{25.0, false};
  const double c = 2.0 * std::cos(60.0 * degree), s = 2.0 * std::sin(60.0 * degree);
  const Case config =
      case_of(inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}}) + line(turn, {{{c, -s}}, {{0.0, 0.0}}, {{c, s}}}));
  const JetTarget target = jet_target(config);
  const AnalyticWedge exact(width, speed, 1000.0, 60.0 * degree, 2.0);
  Particles<2> particles;
  make_scene<2>(config, config).fill(0, 1, particles);
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const auto point = target.point_of(particles, i);
    if (!point) continue;
    particles.pressure[i] = 1.1 * exact.pressure(std::abs(point->x));
    particles.pressure_impulse[i] = 0.5 * particles.pressure[i];
  }
  for (const JetTarget::Sheet& sheet : target.sheets)
    for (double x = 0.5 * dp; x < sheet.length; x += dp)
      for (double y = 0.5 * dp; y < 0.5 * width; y += dp)
        particles.append({sheet.frame.origin + x * sheet.frame.x + y * sheet.frame.y, 0.9 * speed * sheet.frame.x, 0.0,
                          0.0, 100000 + particles.owned, ParticleType::fluid});
  SplitJetComparison comparison(target);
  comparison.set_wall_average(particles, 0.5);
  comparison.add_snapshot(particles);
  auto less = particles;
  for (double& pressure : less.pressure) pressure *= 0.9 / 1.1;
  comparison.add_snapshot(less);
  const JetMetrics metrics = comparison.metrics();
  EXPECT_NEAR(metrics.wall_l2.value(), 0.1, 1e-12);
  EXPECT_NEAR(metrics.force_ratio.value(), 1.1, 2e-3);
  EXPECT_NEAR(metrics.force_scatter.value(), std::sqrt(0.02), 1e-3);
  EXPECT_NEAR(metrics.film_h1.value(), 1.0, 1e-9);
  EXPECT_NEAR(metrics.film_h2.value(), 1.0, 1e-9);
  EXPECT_NEAR(metrics.sheet_speed.value(), 0.9, 1e-12);
  EXPECT_FALSE(metrics.field_l2 || metrics.velocity_rms || metrics.plane_x);
}

TEST(JetTarget, PlaneBetweenTwoJetsIsFoundAndMeasured) {
  const AnalyticJet jet = jet_at(90.0);
  for (const Turn& turn : {Turn{}, Turn{30.0, true}}) {
    const Case config =
        case_of(inlet(turn, {{-1.4, 0.0}}, {{1.0, 0.0}}) + inlet(turn, {{1.4, 0.0}}, {{-1.0, 0.0}}) +
                polygon(turn, "outlet", {{{-1.0, 1.6}}, {{1.0, 1.6}}, {{1.0, 2.0}}, {{-1.0, 2.0}}}) +
                polygon(turn, "outlet", {{{-1.0, -1.6}}, {{1.0, -1.6}}, {{1.0, -2.0}}, {{-1.0, -2.0}}}));
    JetTarget target = jet_target(config);
    const Vector<2> shift{{0.37 * dp, 0.0}};  // of the plane
    Particles<2> particles;
    for (double y = -1.3; y < 1.3; y += dp)
      for (double x = -1.2 + 0.01 * dp; x < 1.2; x += dp)
        if (const auto state = jet.state({{y, std::abs(x)}}))
          particles.append({turn(Vector<2>{{x, y}} + shift),
                            turn.direction({{x < 0.0 ? -state->velocity[1] : state->velocity[1], state->velocity[0]}}),
                            state->pressure, 0.0, particles.owned, ParticleType::fluid});
    const auto found = stagnation_point(particles, target.frame.origin, width);
    ASSERT_TRUE(found);
    EXPECT_LT(norm(*found - turn(shift)), 0.02 * dp);
    target.frame.origin = turn(shift);
    const Particles<2> folded = in_frame(target, particles);
    JetComparison comparison(target);
    comparison.add_snapshot(folded);
    const JetMetrics metrics = comparison.metrics();
    EXPECT_LT(metrics.field_l2.value(), 1e-9);
    EXPECT_LT(metrics.velocity_rms.value(), 1e-9);
    EXPECT_NEAR(metrics.film_h1.value(), comparison.analytic_film(Side::h1).value(), 0.05);
    EXPECT_NEAR(metrics.stagnation_mean.value(), jet.stagnation_pressure(), 0.01 * jet.stagnation_pressure());
    // Far from any stagnation point there is none.
    EXPECT_FALSE(stagnation_point(particles, turn({{1.0, 0.0}}), 0.2));
  }
}

}  // namespace
}  // namespace impinge
