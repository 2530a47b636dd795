// The analytic jet against the integral balances, the table of independently computed figures and itself.

#include "impinge/scenes/analytic_jet.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <random>
#include <stdexcept>

namespace impinge {
namespace {

using Side = AnalyticJet::Side;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double width = 0.4, speed = 1.5, density = 1000.0;

AnalyticJet jet_at(double degrees) { return {width, speed, density, degrees * degree}; }

/// Points of the fluid, spread over the hodograph and over the far parts of jet and sheets.
std::vector<Vector<2>> fluid_points(const AnalyticJet& jet, int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<Vector<2>> points;
  while (static_cast<int>(points.size()) < count) {
    const Vector<2> p{{(12.0 * uniform(random) - 6.0) * width, 4.0 * uniform(random) * width}};
    if (jet.contains(p)) points.push_back(p);
    const Vector<2> film{{p[0], jet.sheet_thickness(p[0] > 0.0 ? Side::h1 : Side::h2) * uniform(random)}};
    if (jet.contains(film)) points.push_back(film);
    points.push_back(jet.position(std::polar(std::sqrt(uniform(random)), std::numbers::pi * uniform(random))));
  }
  return points;
}

class AnalyticJetAngles : public testing::TestWithParam<double> {
 protected:
  AnalyticJet jet = jet_at(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Angles, AnalyticJetAngles, testing::Values(15.0, 25.0, 30.0, 37.0, 45.0, 60.0, 90.0));

TEST_P(AnalyticJetAngles, SheetsKeepMassAndTangentialMomentum) {
  const double thick = jet.sheet_thickness(Side::h1), thin = jet.sheet_thickness(Side::h2);
  EXPECT_NEAR(thick + thin, width, 1e-15);
  EXPECT_NEAR(thick - thin, width * std::cos(GetParam() * degree), 1e-15);
}

TEST_P(AnalyticJetAngles, WallPressureHasTheForceAndMomentOfTheMomentumBalance) {
  const double low = jet.plate_position_of_cp(1e-12, Side::h2), high = jet.plate_position_of_cp(1e-12, Side::h1);
  const int intervals = 20000;  // Simpson's rule on each side of the stagnation point
  double force = 0.0, moment = 0.0;
  for (const double end : {low, high}) {
    const double dx = std::abs(end) / intervals;
    for (int i = 0; i <= intervals; ++i) {
      const double x = end * i / intervals;
      const double weight = (i == 0 || i == intervals ? 1.0 : i % 2 ? 4.0 : 2.0) * dx / 3.0;
      force += weight * jet.wall_pressure(x);
      moment += weight * jet.wall_pressure(x) * x;
    }
  }
  EXPECT_NEAR(force / (density * speed * speed * width * std::sin(GetParam() * degree)), 1.0, 1e-8);
  EXPECT_NEAR(jet.normal_force() / force, 1.0, 1e-8);
  EXPECT_NEAR(moment / force, jet.centre_of_pressure(), 1e-8 * width);
}

TEST_P(AnalyticJetAngles, PlateSpeedInvertsPlatePosition) {
  for (double q = -0.995; q < 1.0; q += 0.01) {
    EXPECT_NEAR(jet.plate_speed(jet.plate_position(q)), q, 1e-13);
    EXPECT_NEAR(jet.wall_pressure(jet.plate_position(q)), jet.stagnation_pressure() * (1.0 - q * q), 1e-9);
  }
  for (const double cp : {1.0, 0.9, 0.5, 0.1, 1e-2, 1e-6, 1e-12})
    for (const Side side : {Side::h1, Side::h2})
      EXPECT_NEAR(jet.wall_pressure(jet.plate_position_of_cp(cp, side)) / (cp * jet.stagnation_pressure()), 1.0, 1e-11);
}

TEST_P(AnalyticJetAngles, PlatePositionIsTheRealFormula) {
  const double a = GetParam() * degree;
  for (double q = -0.99; q < 1.0; q += 0.03) {
    const double x = width / std::numbers::pi *
                     (std::cos(a) * std::log(1.0 - 2.0 * q * std::cos(a) + q * q) +
                      2.0 * std::sin(a) * std::atan2(q * std::sin(a), 1.0 - q * std::cos(a)) -
                      (1.0 + std::cos(a)) * std::log(1.0 - q) + (1.0 - std::cos(a)) * std::log(1.0 + q));
    EXPECT_NEAR(jet.plate_position(q), x, 1e-14);
  }
}

TEST_P(AnalyticJetAngles, NewtonFindsEveryPointOfTheFluid) {
  for (const Vector<2>& p : fluid_points(jet, 20000)) {
    const auto zeta = jet.hodograph(p);
    ASSERT_TRUE(zeta.has_value()) << p[0] << " " << p[1];
    EXPECT_LE(std::abs(*zeta), 1.0 + 1e-12);
    EXPECT_GE(zeta->imag(), -1e-12);
    const auto state = jet.state(p);
    EXPECT_NEAR(norm(state->velocity), speed * std::abs(*zeta), 1e-12);
    if (std::abs(*zeta) < 1.0 - 1e-4) {  // farther out zeta itself has too few digits
      EXPECT_LT(norm(jet.position(*zeta) - p), 1e-10 * width) << p[0] << " " << p[1];
    }
  }
}

TEST_P(AnalyticJetAngles, InteriorObeysBernoulliContinuityAndIrrotationality) {
  const double step = 1e-4 * jet.sheet_thickness(Side::h2);
  const Vector<2> right{{step, 0.0}}, up{{0.0, step}};
  int checked = 0;
  for (const Vector<2>& p : fluid_points(jet, 2000)) {
    const auto centre = jet.state(p), east = jet.state(p + right), west = jet.state(p - right),
               north = jet.state(p + up), south = jet.state(p - up);
    if (!(centre && east && west && north && south)) continue;
    ++checked;
    EXPECT_NEAR(centre->pressure + 0.5 * density * dot(centre->velocity, centre->velocity),
                0.5 * density * speed * speed, 1e-8);
    const double ux = (east->velocity[0] - west->velocity[0]), vx = (east->velocity[1] - west->velocity[1]);
    const double uy = (north->velocity[0] - south->velocity[0]), vy = (north->velocity[1] - south->velocity[1]);
    EXPECT_NEAR((ux + vy) / speed, 0.0, 1e-9);
    EXPECT_NEAR((vx - uy) / speed, 0.0, 1e-9);
  }
  EXPECT_GT(checked, 1500);
}

TEST_P(AnalyticJetAngles, FreeSurfaceIsAStreamlineOfSpeedUAtZeroPressure) {
  for (double theta = 0.01; theta < 3.14; theta += 0.01) {
    if (std::abs(theta - GetParam() * degree) < 1e-3) continue;
    const Vector<2> p = jet.surface_point(theta);
    const Vector<2> direct = jet.position(std::polar(1.0, theta));
    EXPECT_LT(norm(p - direct), 1e-12);
    const auto nearest = jet.nearest_surface(p);
    EXPECT_NEAR(nearest.depth, 0.0, 1e-9);
    EXPECT_NEAR(norm(nearest.velocity), speed, 1e-12);
    EXPECT_NEAR(nearest.velocity[0], speed * std::cos(theta), 1e-6);
    const Vector<2> normal{{std::sin(theta), std::cos(theta)}};  // out of the fluid
    const double side = theta < GetParam() * degree ? 1.0 : -1.0;
    const double small = 1e-3 * jet.sheet_thickness(Side::h2);
    const Vector<2> inside = p - (side * small) * normal, outside = p + (side * small) * normal;
    ASSERT_TRUE(jet.contains(inside));
    EXPECT_FALSE(jet.contains(outside));
    EXPECT_FALSE(jet.state(outside).has_value());
    EXPECT_NEAR(jet.nearest_surface(inside).depth, small, 1e-9);
    EXPECT_NEAR(jet.nearest_surface(outside).depth, -small, 1e-9);
    EXPECT_NEAR(norm(jet.state(inside)->velocity), speed, 0.02 * speed);
  }
}

TEST_P(AnalyticJetAngles, SurfaceLinesReachTheirEndsAndTheFarThickness) {
  const double length = 6.0 * width, spacing = 0.01 * width;
  for (const Side side : {Side::h1, Side::h2}) {
    const auto line = jet.surface(side, length, length, spacing);
    EXPECT_NEAR(line.front()[0], side == Side::h1 ? length : -length, 1e-9);
    EXPECT_NEAR(line.front()[1], jet.sheet_thickness(side), 1e-3 * jet.sheet_thickness(side));
    const double a = GetParam() * degree;
    const Vector<2> along{{-std::cos(a), std::sin(a)}}, across{{std::sin(a), std::cos(a)}};
    const Vector<2> end = line.back() - Vector<2>{{jet.axis_position(), 0.0}};
    EXPECT_NEAR(dot(end, along), length, 1e-9);
    EXPECT_NEAR(dot(end, across), (side == Side::h1 ? 0.5 : -0.5) * width, 1e-6 * width);
    for (std::size_t i = 1; i < line.size(); ++i) ASSERT_LT(norm(line[i] - line[i - 1]), 1.01 * spacing);
  }
  EXPECT_NEAR(jet.nearest_surface({{40.0 * width, 0.0}}).depth, jet.sheet_thickness(Side::h1), 1e-9);
  EXPECT_NEAR(jet.nearest_surface({{-40.0 * width, 0.0}}).depth, jet.sheet_thickness(Side::h2), 1e-9);
}

TEST_P(AnalyticJetAngles, FilmLiesBetweenPlateAndGap) {
  const double small = 1e-7 * width;
  int found = 0, under_jet = 0;
  for (double x = -6.0 * width; x < 6.0 * width; x += 0.05 * width) {
    const auto film = jet.film(x);
    if (!film) continue;
    ++found;
    EXPECT_TRUE(jet.contains({{x, film->top - small}}));
    EXPECT_FALSE(jet.contains({{x, film->top + small}}));
    if (std::isinf(film->ceiling)) continue;
    ++under_jet;
    EXPECT_FALSE(jet.contains({{x, film->ceiling - small}}));
    EXPECT_TRUE(jet.contains({{x, film->ceiling + small}}));
  }
  EXPECT_GT(found, 150);
  EXPECT_EQ(under_jet > 50, GetParam() < 90.0);
  EXPECT_FALSE(jet.film(0.0));
  EXPECT_NEAR(jet.film(8.0 * width)->top, jet.sheet_thickness(Side::h1), 1e-6 * width);
  EXPECT_NEAR(jet.film(-8.0 * width)->top, jet.sheet_thickness(Side::h2), 1e-6 * width);
}

TEST_P(AnalyticJetAngles, PointsOutsideHaveNoState) {
  const double thick = jet.sheet_thickness(Side::h1), thin = jet.sheet_thickness(Side::h2);
  EXPECT_FALSE(jet.state({{0.3 * width, -1e-9}}));
  EXPECT_FALSE(jet.state({{8.0 * width, 1.01 * thick}}));
  EXPECT_FALSE(jet.state({{-3.0 * width, 1.01 * thin}}));
  EXPECT_FALSE(jet.state({{30.0 * width, 30.0 * width}}));
  EXPECT_TRUE(jet.state({{8.0 * width, 0.99 * thick}}));
  EXPECT_TRUE(jet.state({{-8.0 * width, 0.99 * thin}}));
  EXPECT_TRUE(jet.state({{0.0, 0.0}}));
  EXPECT_NEAR(jet.state({{0.0, 0.0}})->pressure, jet.stagnation_pressure(), 1e-9);
}

struct TableRow {
  double degrees, h1, h2, axis, centre, force;
  std::array<double, 8> cp;  // x/H of Cp = .9, .5, .1, .01: h2 side, h1 side
};

TEST(AnalyticJet, MatchesTheTable) {
  const std::vector<TableRow> table{
      {30, .93301, .06699, 1.45189, .58587, 200, {-.0811, .1421, -.1624, .6319, -.2553, 1.8032, -.3575, 3.2243}},
      {45, .85355, .14645, 1.03533, .53533, 282.8, {-.1679, .2624, -.3437, .9147, -.5466, 2.0465, -.7701, 3.3482}},
      {60, .75, .25, .69529, .40661, 346.4, {-.2643, .3598, -.5590, 1.0526, -.9049, 2.0684, -1.2864, 3.2126}},
      {90, .5, .5, 0, 0, 400, {-.4034, .4034, -.9529, .9529, -1.6409, 1.6409, -2.4039, 2.4039}}};
  for (const TableRow& row : table) {
    const AnalyticJet jet(0.4, 1.0, 1000.0, row.degrees * degree);
    EXPECT_NEAR(jet.sheet_thickness(Side::h1) / 0.4, row.h1, 6e-6);
    EXPECT_NEAR(jet.sheet_thickness(Side::h2) / 0.4, row.h2, 6e-6);
    EXPECT_NEAR(jet.axis_position() / 0.4, row.axis, 6e-6);
    EXPECT_NEAR(jet.centre_of_pressure() / 0.4, row.centre, 6e-6);
    EXPECT_NEAR(jet.normal_force(), row.force, 0.06);
    std::size_t i = 0;
    for (const double cp : {0.9, 0.5, 0.1, 0.01}) {
      EXPECT_NEAR(jet.plate_position_of_cp(cp, Side::h2) / 0.4, row.cp[i++], 6e-5);
      EXPECT_NEAR(jet.plate_position_of_cp(cp, Side::h1) / 0.4, row.cp[i++], 6e-5);
    }
  }
}

TEST(AnalyticJet, PressureDecaysUpstreamOnTheAxis) {
  const AnalyticJet jet = jet_at(90.0);
  const auto cp = [&](double s) { return jet.state({{0.0, s * width}})->pressure / jet.stagnation_pressure(); };
  for (const double s : {2.5, 3.5, 5.0, 8.0}) EXPECT_NEAR(std::log(cp(s) / cp(s + 1.0)), std::numbers::pi, 0.01);
  EXPECT_LT(cp(3.5), 1e-3);
}

TEST(AnalyticJet, FillsALatticeQuickly) {
  const AnalyticJet jet = jet_at(30.0);
  const auto begin = std::chrono::steady_clock::now();
  int inside = 0;
  double sum = 0.0;
  for (int i = -400; i < 800; ++i) {
    for (int j = 0; j < 160; ++j) {
      if (const auto state = jet.state({{i * width / 160.0, (j + 0.5) * width / 160.0}})) {
        ++inside;
        sum += state->pressure;
      }
    }
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_GT(sum, 0.0);
  EXPECT_GT(inside, 100000);
  EXPECT_LT(seconds / inside, 5e-5);  // measured: 3e-6
}

TEST(AnalyticJet, RejectsWrongInput) {
  EXPECT_THROW(AnalyticJet(0.0, 1.0, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(AnalyticJet(1.0, -1.0, 1.0, 1.0), std::invalid_argument);
  EXPECT_THROW(AnalyticJet(1.0, 1.0, 1.0, 0.0), std::invalid_argument);
  EXPECT_THROW(AnalyticJet(1.0, 1.0, 1.0, 2.0), std::invalid_argument);
  const AnalyticJet jet = jet_at(45.0);
  EXPECT_THROW(jet.plate_position(1.0), std::domain_error);
  EXPECT_THROW(jet.plate_position_of_cp(0.0, Side::h1), std::domain_error);
  EXPECT_THROW(jet.surface_point(4.0), std::domain_error);
}

}  // namespace
}  // namespace impinge
