// Where particles are at the start, where they enter and where they leave.

#include "impinge/scenes/scenes.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "impinge/core/mpi.hpp"
#include "impinge/particles/cell_grid.hpp"
#include "impinge/scenes/analytic_jet.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

constexpr double dp = 0.04;
constexpr double width = 0.4;
constexpr double speed = 1.5;
constexpr int row_length = 10;  // width / dp

Case jet_case(double angle, const char* start = "impact", const char* walls = "particles") {
  return parse_case({{"jet.toml", fmt::format(R"(geometry = "jet"
particles.spacing = {}
time = {{end = 1.0, dt = 1e-3}}
jet = {{width = {}, speed = {}, angle = {}, start = "{}"}}
walls.model = "{}"
)",
                                              dp, width, speed, angle, start, walls)}});
}

Case tank_case(int dimension, const char* walls = "particles") {
  const bool flat = dimension == 2;
  return parse_case({{"tank.toml", fmt::format(R"(geometry = "tank"
dimension = {}
particles.spacing = 0.01
time = {{end = 1.0, dt = 1e-3}}
fluid.gravity = {}
tank = {{size = {}, fluid_height = 0.07}}
walls.model = "{}"
)",
                                               dimension, flat ? "[0.0, -9.81]" : "[0.0, 0.0, -9.81]",
                                               flat ? "[0.2, 0.1]" : "[0.2, 0.05, 0.1]", walls)}});
}

Case box_case(int dimension) {
  return parse_case({{"box.toml", fmt::format(R"(geometry = "periodic_box"
dimension = {}
particles.spacing = 0.01
time = {{end = 1.0, dt = 1e-3}}
fluid.viscosity = 1e-3
periodic_box = {{size = {}, shear_speed = 0.5}}
)",
                                              dimension, dimension == 2 ? "[0.2, 0.15]" : "[0.2, 0.15, 0.13]")}});
}

template <int Dim>
Scene<Dim> scene_of(const Case& config) {
  return make_scene<Dim>(config, config);
}

template <int Dim>
Particles<Dim> fill(const Case& config, int ranks = 1) {
  Particles<Dim> particles;
  for (int rank = 0; rank < ranks; ++rank) scene_of<Dim>(config).fill(rank, ranks, particles);
  return particles;
}

template <int Dim>
std::int64_t count(const Particles<Dim>& particles, ParticleType type) {
  return std::count(particles.type.begin(), particles.type.end(), type);
}

template <int Dim>
double smallest_distance(const Particles<Dim>& particles) {
  double smallest = 1e300;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      smallest = std::min(smallest, norm(particles.position[i] - particles.position[j]));
  return smallest;
}

/// The fluid is the same whatever the walls are.
void expect_the_same_fluid(const Case& config, const Case& other) {
  const auto fluid = [](const Particles<2>& particles) {
    std::set<std::array<double, 2>> positions;
    for (std::size_t i = 0; i < particles.position.size(); ++i)
      if (particles.type[i] == ParticleType::fluid) positions.insert(particles.position[i].component);
    return positions;
  };
  EXPECT_FALSE(fluid(fill<2>(config)).empty());
  EXPECT_EQ(fluid(fill<2>(config)), fluid(fill<2>(other)));
}

template <int Dim>
void expect_the_same_for_any_number_of_ranks(const Case& config) {
  const auto by_id = [&](int ranks) {
    const Particles<Dim> particles = fill<Dim>(config, ranks);
    std::map<std::int64_t, std::tuple<std::array<double, Dim>, std::array<double, Dim>, ParticleType>> all;
    for (int i = 0; i < particles.owned; ++i) {
      const auto record = particles.record(i);
      EXPECT_TRUE(all.try_emplace(record.id, record.position.component, record.velocity.component, record.type).second)
          << "id " << record.id << " twice";
    }
    return all;
  };
  const auto whole = by_id(1);
  EXPECT_FALSE(whole.empty());
  EXPECT_EQ(by_id(2), whole);
  EXPECT_EQ(by_id(3), whole);
  EXPECT_EQ(by_id(7), whole);
}

TEST(Lattice, SharesCoverEveryPointOnce) {
  for (const int points : {0, 1, 2, 10, 97}) {
    for (const int ranks : {1, 2, 3, 8}) {
      std::vector<std::int64_t> seen;
      for (int rank = 0; rank < ranks; ++rank)
        for_share(points, rank, ranks, [&](std::int64_t k) { seen.push_back(k); });
      std::vector<std::int64_t> expected;
      for (int k = 0; k < points; ++k) expected.push_back(k);
      EXPECT_EQ(seen, expected) << points << " points, " << ranks << " ranks";
    }
  }
}

TEST(Tank, HasFluidInsideOneRowOfWallAndGhostsBehindIt) {
  const Particles<2> tank = fill<2>(tank_case(2));
  EXPECT_EQ(count(tank, ParticleType::fluid), 20 * 7);
  EXPECT_EQ(count(tank, ParticleType::wall), 22 * 11 - 20 * 10);
  EXPECT_EQ(count(tank, ParticleType::ghost), 28 * 14 - 22 * 11);
  EXPECT_EQ(count(tank, ParticleType::inlet), 0);
  EXPECT_NEAR(smallest_distance(tank), 0.01, 1e-12);

  const Particles<3> deep = fill<3>(tank_case(3));
  EXPECT_EQ(count(deep, ParticleType::fluid), 20 * 5 * 7);
  EXPECT_EQ(count(deep, ParticleType::wall), 22 * 7 * 11 - 20 * 5 * 10);
  EXPECT_EQ(count(deep, ParticleType::ghost), 28 * 13 * 14 - 22 * 7 * 11);
}

TEST(Tank, FloorIsTheBottomWallRow) {
  for (const char* walls : {"particles", "mirror"}) {
    const auto scene = scene_of<2>(tank_case(2, walls));
    const Particles<2> tank = fill<2>(tank_case(2, walls));
    int floor = 0;
    for (int i = 0; i < tank.owned; ++i) {
      const auto self = static_cast<std::size_t>(i);
      if (tank.type[self] != ParticleType::wall || !scene.on_floor(tank.position[self])) continue;
      EXPECT_NEAR(tank.position[self][1], *walls == 'm' ? 0.0 : -0.005, 1e-12);
      ++floor;
    }
    EXPECT_EQ(floor, 20) << walls;
  }
}

template <int Dim>
void expect_mirrored_tank(const Vector<Dim>& size, int walls) {
  const Case config = tank_case(Dim, "mirror");
  const auto scene = scene_of<Dim>(config);
  const Box<Dim> bounds = scene.bounds;
  EXPECT_EQ(bounds.low, Vector<Dim>{});
  for (int k = 0; k < Dim; ++k) {
    const bool vertical = k == Dim - 1;
    EXPECT_EQ(bounds.high[k], (vertical ? 2.0 : 1.0) * size[k]);
    for (const double side : {1.0, -1.0}) {
      const auto is_there = [&](const Face<Dim>& face) {
        return face.normal[k] == side && face.point[k] == (side > 0.0 ? 0.0 : size[k]);
      };
      EXPECT_EQ(std::ranges::count_if(scene.mirrors, is_there), vertical && side < 0.0 ? 0 : 1);
    }
  }

  const Particles<Dim> tank = fill<Dim>(config);
  EXPECT_EQ(count(tank, ParticleType::fluid), count(fill<Dim>(tank_case(Dim)), ParticleType::fluid));
  EXPECT_EQ(count(tank, ParticleType::ghost), 0);
  EXPECT_EQ(count(tank, ParticleType::wall), walls);
  EXPECT_NEAR(smallest_distance(tank), 0.005, 1e-12);  // between a corner and its neighbours
  const CellGrid<Dim> cells(bounds, scene.periodic, 0.0401);
  for (std::size_t i = 0; i < tank.position.size(); ++i) {
    EXPECT_GE(cells.cell(cells.wrapped(tank.position[i])), 0);
    if (tank.type[i] != ParticleType::wall) continue;
    bool on_surface = tank.position[i][Dim - 1] == 0.0;
    for (int k = 0; k < Dim; ++k) {
      EXPECT_GE(tank.position[i][k], 0.0);
      EXPECT_LT(tank.position[i][k], size[k]);
      on_surface |= k < Dim - 1 && (tank.position[i][k] == 0.0 || tank.position[i][k] > size[k] - 1e-12);
    }
    EXPECT_TRUE(on_surface);
  }
}

TEST(Tank, OfMirrorsHasWallParticlesOnTheSurfaceOnly) {
  expect_mirrored_tank<2>({{0.2, 0.1}}, 22 * 11 - 20 * 10);
  expect_mirrored_tank<3>({{0.2, 0.05, 0.1}}, 22 * 7 * 11 - 20 * 5 * 10);
  expect_the_same_fluid(tank_case(2, "mirror"), tank_case(2));
}

TEST(Jet, OnAMirrorHasWallParticlesOnTheSurfaceOnly) {
  for (const char* start : {"impact", "steady"}) {
    const Case config = jet_case(60.0, start, "mirror");
    const auto scene = scene_of<2>(config);
    ASSERT_EQ(scene.mirrors.size(), 1U);
    EXPECT_EQ(scene.mirrors[0].normal, (Vector<2>{{0.0, 1.0}}));
    EXPECT_EQ(scene.mirrors[0].point[1], 0.0);
    EXPECT_EQ(scene.bounds.low[1], 0.0);

    const Particles<2> jet = fill<2>(config);
    EXPECT_EQ(count(jet, ParticleType::ghost), 0);
    EXPECT_EQ(count(jet, ParticleType::wall), std::lround((config.plate.end - config.plate.begin) / dp));
    for (std::size_t i = 0; i < jet.position.size(); ++i)
      EXPECT_EQ(jet.type[i] == ParticleType::wall, jet.position[i][1] == 0.0);
    expect_the_same_fluid(config, jet_case(60.0, start));
  }
}

TEST(PeriodicBox, IsFullOfFluidInAShearFlow) {
  const Particles<2> box = fill<2>(box_case(2));
  EXPECT_EQ(count(box, ParticleType::fluid), 20 * 15);
  EXPECT_EQ(box.owned, 20 * 15);
  for (std::size_t i = 0; i < box.position.size(); ++i) {
    EXPECT_NEAR(box.velocity[i][0], 0.5 * std::sin(2.0 * std::numbers::pi * box.position[i][1] / 0.15), 1e-14);
    EXPECT_EQ(box.velocity[i][1], 0.0);
  }
  EXPECT_EQ(fill<3>(box_case(3)).owned, 20 * 15 * 13);
  // Vortices on top: free of divergence, the largest u_x is their speed.
  const Case both = parse_case({{"box.toml", R"(geometry = "periodic_box"
particles.spacing = 0.01
time = {end = 1.0, dt = 1e-3}
periodic_box = {size = [0.2, 0.1], shear_speed = 0.5, vortex_speed = 2.0}
)"}});
  EXPECT_DOUBLE_EQ(both.time.max_speed, 20.0 * 2.5);
  const Particles<2> vortices = fill<2>(both);
  for (std::size_t i = 0; i < vortices.position.size(); ++i) {
    const double x = 10.0 * std::numbers::pi * vortices.position[i][0];
    const double y = 20.0 * std::numbers::pi * vortices.position[i][1];
    EXPECT_NEAR(vortices.velocity[i][0], (0.5 - 2.0 * std::cos(x)) * std::sin(y), 1e-13);
    EXPECT_NEAR(vortices.velocity[i][1], 2.0 * 0.5 * std::sin(x) * std::cos(y), 1e-13);
  }
  EXPECT_EQ(scene_of<3>(box_case(3)).periodic, (std::array{true, true, true}));
  EXPECT_EQ(scene_of<2>(tank_case(2)).periodic, (std::array{false, false}));
}

TEST(Geometry, SharesMakeTheWholeForAnyNumberOfRanks) {
  expect_the_same_for_any_number_of_ranks<2>(tank_case(2));
  expect_the_same_for_any_number_of_ranks<3>(tank_case(3));
  expect_the_same_for_any_number_of_ranks<2>(tank_case(2, "mirror"));
  expect_the_same_for_any_number_of_ranks<3>(tank_case(3, "mirror"));
  expect_the_same_for_any_number_of_ranks<2>(jet_case(47.0, "steady", "mirror"));
  expect_the_same_for_any_number_of_ranks<2>(box_case(2));
  expect_the_same_for_any_number_of_ranks<3>(box_case(3));
  expect_the_same_for_any_number_of_ranks<2>(jet_case(47.0));
  expect_the_same_for_any_number_of_ranks<2>(jet_case(60.0, "steady"));
}

TEST(Geometry, ParticlesStartInsideTheBounds) {
  for (const Case& config : {tank_case(2), box_case(2), jet_case(30.0), jet_case(90.0), jet_case(30.0, "steady"),
                             tank_case(2, "mirror"), jet_case(30.0, "steady", "mirror")}) {
    const Box<2> bounds = scene_of<2>(config).bounds;
    const Particles<2> particles = fill<2>(config);
    for (const auto& position : particles.position) {
      for (int k = 0; k < 2; ++k) {
        EXPECT_GE(position[k], bounds.low[k]);
        EXPECT_LT(position[k], bounds.high[k]);
      }
    }
  }
}

TEST(Geometry, JetIsTwoDimensional) { EXPECT_THROW(scene_of<3>(jet_case(60.0)), InputError); }

BoundaryFlow pass(
    Scene<2>& scene, double dt, Particles<2>& particles,
    const std::function<bool(const Vector<2>&)>& owns = [](const Vector<2>&) { return true; }) {
  for (Inlet<2>& inlet : scene.inlets) inlet.last_row += inlet.speed * dt;
  return pass_open_boundaries<2>(scene.inlets, scene.outlets, scene.next_id, particles, owns);
}

/// The inlet under test: fluid leaves the list after a step, so that only the buffer is left.
class JetInlet : public testing::TestWithParam<double> {
 protected:
  JetInlet() {
    scene_.fill(0, 1, particles_);
    const double angle = GetParam() * std::numbers::pi / 180.0;
    along_ = {{std::cos(angle), -std::sin(angle)}};
    ids_.insert(particles_.id.begin(), particles_.id.end());
    keep_buffer();
  }

  /// Moves the buffer and lets the scene act.
  BoundaryFlow step(double dt) {
    for (auto& position : particles_.position) position += dt * scene_.inlets[0].velocity();
    travelled_ += dt * speed;
    const int before = particles_.owned;
    const BoundaryFlow flow = pass(scene_, dt, particles_);
    EXPECT_EQ(flow.left, 0);
    for (int i = 0; i < particles_.owned; ++i) {
      const auto record = particles_.record(i);
      EXPECT_TRUE(i < before || ids_.insert(record.id).second) << "id " << record.id << " twice";
    }
    EXPECT_EQ(count(particles_, ParticleType::fluid), flow.entered);
    keep_buffer();
    return flow;
  }

  /// Rows are a spacing apart, each with H/dp particles a spacing apart.
  void expect_whole_rows() {
    std::vector<std::pair<double, double>> places;  // along, across
    for (const auto& position : particles_.position)
      places.emplace_back(dot(position, along_), position[0] * -along_[1] + position[1] * along_[0]);
    std::sort(places.begin(), places.end());
    ASSERT_EQ(places.size() % row_length, 0U);
    for (std::size_t row = 0; row < places.size(); row += row_length) {
      std::vector<double> across;
      for (std::size_t k = row; k < row + row_length; ++k) {
        EXPECT_NEAR(places[k].first, places[0].first + static_cast<double>(row / row_length) * dp, 1e-11);
        across.push_back(places[k].second);
      }
      std::sort(across.begin(), across.end());
      for (std::size_t k = 0; k < row_length; ++k)
        EXPECT_NEAR(across[k], across[0] + static_cast<double>(k) * dp, 1e-11);
    }
  }

  void keep_buffer() {
    Particles<2> buffer;
    for (int i = 0; i < particles_.owned; ++i)
      if (particles_.type[static_cast<std::size_t>(i)] == ParticleType::inlet) buffer.append(particles_.record(i));
    particles_ = buffer;
  }

  Scene<2> scene_ = scene_of<2>(jet_case(GetParam()));
  Particles<2> particles_;
  std::set<std::int64_t> ids_;
  Vector<2> along_;
  double travelled_ = 0.0;
};

TEST_P(JetInlet, FeedsWholeRowsAtIrregularSteps) {
  expect_whole_rows();
  const int initial_rows = particles_.owned / row_length;
  EXPECT_GE(initial_rows, 2.6);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::int64_t entered = 0;
  std::size_t ids = ids_.size();
  for (int k = 0; k < 3000; ++k) {
    // Mostly a fifth of a spacing or less, now and then several spacings at once.
    const double distance = k % 100 == 99 ? 3.0 * share(random) : 0.2 * share(random);
    entered += step(distance * dp / speed).entered;
    const int rows = particles_.owned / row_length;
    ASSERT_TRUE(rows == initial_rows || rows == initial_rows + 1) << rows << " rows at step " << k;
    const double crossed = travelled_ / dp + 0.5;
    if (std::abs(crossed - std::round(crossed)) > 1e-6) {
      ASSERT_EQ(entered, row_length * static_cast<std::int64_t>(crossed)) << "step " << k;
    }
    // What is new is what entered plus what the buffer has grown by.
    ASSERT_EQ(static_cast<std::int64_t>(ids_.size() - ids), entered + row_length * (rows - initial_rows));
    if (k % 50 == 0) expect_whole_rows();
  }
  EXPECT_GT(entered, 300 * row_length);
  expect_whole_rows();
}

TEST_P(JetInlet, FeedsTheSameParticlesWhenTheyAreSharedOut) {
  const auto left = [](const Vector<2>& position) { return position[0] < -0.5; };
  const double dt = 0.3 * dp / speed;
  std::map<std::int64_t, std::array<double, 2>> whole, shared;
  const auto feed = [&](const std::function<bool(const Vector<2>&)>& owns, auto& fed) {
    auto scene = scene_of<2>(jet_case(GetParam()));
    Particles<2> none;
    for (int k = 0; k < 50; ++k) pass(scene, dt, none, owns);
    for (int i = 0; i < none.owned; ++i) {
      const auto record = none.record(i);
      EXPECT_TRUE(fed.try_emplace(record.id, record.position.component).second);
    }
  };
  feed([](const Vector<2>&) { return true; }, whole);
  feed(left, shared);
  feed([&](const Vector<2>& position) { return !left(position); }, shared);
  EXPECT_EQ(whole.size(), 15U * row_length);
  EXPECT_EQ(whole, shared);
}

TEST_P(JetInlet, FluidPastTheOutletsLeaves) {
  Particles<2> fluid;
  const Case config = jet_case(GetParam());
  const Box<2> bounds = scene_.bounds;
  const double right = std::max(config.plate.end, bounds.high[0]);
  const double left = std::min(config.plate.begin, bounds.low[0]);
  const auto put = [&](double x, double y) {
    fluid.append({{{x, y}}, {}, 0.0, 0.0, 1000000 + fluid.owned, ParticleType::fluid});
  };
  put(right + dp, dp);
  put(left - dp, dp);
  put(0.0, bounds.high[1]);
  put(0.0, dp);
  const BoundaryFlow flow = pass(scene_, 1e-9, fluid);
  EXPECT_EQ(flow.left, 3);
  ASSERT_EQ(fluid.owned, 1);
  EXPECT_EQ(fluid.position[0], (Vector<2>{{0.0, dp}}));
}

TEST_P(JetInlet, ImpactingColumnIsWholeAndTouchesThePlate) {
  const Particles<2> jet = fill<2>(jet_case(GetParam()));
  EXPECT_GT(smallest_distance(jet), dp * (1.0 - 1e-9));
  double lowest = 1e300;
  for (int i = 0; i < jet.owned; ++i) {
    const auto record = jet.record(i);
    if (record.type == ParticleType::wall) {
      EXPECT_NEAR(record.position[1], -0.5 * dp, 1e-12);
      continue;
    }
    if (record.type != ParticleType::fluid) continue;
    lowest = std::min(lowest, record.position[1]);
    EXPECT_NEAR(record.velocity[0], speed * along_[0], 1e-14);
    EXPECT_NEAR(record.velocity[1], speed * along_[1], 1e-14);
  }
  EXPECT_GE(lowest, 0.5 * dp * (1.0 - 1e-8));
  EXPECT_LT(lowest, 1.5 * dp);
}

TEST_P(JetInlet, SteadyStartFillsTheAnalyticJet) {
  const double angle = GetParam() * std::numbers::pi / 180.0;
  const AnalyticJet analytic(width, speed, 1000.0, angle);
  const Case config = jet_case(GetParam(), "steady");
  const Particles<2> jet = fill<2>(config);
  EXPECT_GE(smallest_distance(jet), 0.5 * dp * (1.0 - 1e-9));
  double force = 0.0;
  for (int i = 0; i < jet.owned; ++i) {
    const auto record = jet.record(i);
    if (record.type != ParticleType::fluid) continue;
    ASSERT_TRUE(analytic.contains(record.position));
    const auto state = analytic.state(record.position);
    ASSERT_TRUE(state.has_value());
    EXPECT_NEAR(record.pressure, state->pressure, 1e-6 * analytic.stagnation_pressure());
    EXPECT_NEAR(norm(record.velocity - state->velocity), 0.0, 1e-6 * speed);
    if (record.position[1] < dp) force += dp * record.pressure;
  }
  // The lowest row's pressure, half a spacing above the plate, carries most of the jet's force.
  EXPECT_NEAR(force / analytic.normal_force(), 1.0, 0.1);
  // No voids: every point of the analytic jet inside the domain has a particle near it.
  const Box<2> bounds = scene_.bounds;
  std::mt19937 random(13);
  std::uniform_real_distribution<double> x(bounds.low[0], config.plate.end), y(0.0, bounds.high[1]);
  const Vector<2> inlet = {{analytic.axis_position() - config.jet.inlet_distance * width * along_[0],
                            -config.jet.inlet_distance * width * along_[1]}};
  int inside = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Vector<2> point{{x(random), y(random)}};
    const bool beyond_plate = point[0] < config.plate.begin && point[1] < width;
    if (beyond_plate || !analytic.contains(point) || dot(point - inlet, along_) < 0.0) continue;
    ++inside;
    double nearest = 1e300;
    for (const auto& position : jet.position) nearest = std::min(nearest, norm(position - point));
    EXPECT_LT(nearest, 1.3 * dp) << point[0] << ", " << point[1];
  }
  EXPECT_GT(inside, 1000);
}

INSTANTIATE_TEST_SUITE_P(Angles, JetInlet, testing::Values(30.0, 47.0, 60.0, 90.0));

TEST(Tank, WallNormalsPointIntoTheFluid) {
  for (const char* walls : {"particles", "mirror"}) {
    const auto scene = scene_of<3>(tank_case(3, walls));
    const Particles<3> particles = fill<3>(tank_case(3, walls));
    const Vector<3> size{{0.2, 0.05, 0.1}};
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      if (particles.type[i] != ParticleType::wall) continue;
      const Vector<3> normal = scene.wall_normal(particles.position[i]);
      EXPECT_NEAR(norm(normal), 1.0, 1e-14);
      const Vector<3> inside = particles.position[i] + 0.01 * normal;
      for (int k = 0; k < 3; ++k) {
        EXPECT_GT(inside[k], 0.0);
        EXPECT_LT(inside[k], size[k]);
      }
    }
  }
  const auto tank = scene_of<2>(shipped_case("hydrostatic.toml"));  // 0.2 m wide
  EXPECT_EQ(tank.wall_normal({{0.1, -0.005}}), (Vector<2>{{0.0, 1.0}}));
  EXPECT_EQ(tank.wall_normal({{-0.005, 0.1}}), (Vector<2>{{1.0, 0.0}}));
  EXPECT_EQ(tank.wall_normal({{0.205, 0.1}}), (Vector<2>{{-1.0, 0.0}}));
  const Vector<2> corner = tank.wall_normal({{0.205, -0.005}});
  EXPECT_DOUBLE_EQ(corner[0], -std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(corner[1], std::sqrt(0.5));
  EXPECT_EQ(scene_of<2>(shipped_case("jet60-quick.toml")).wall_normal({{0.5, -0.01}}), (Vector<2>{{0.0, 1.0}}));
}

}  // namespace
}  // namespace impinge
