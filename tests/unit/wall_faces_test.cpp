// Specular pairs: which images a particle sees at walls of any shape, and that nothing passes them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "impinge/boundaries/mirror_walls.hpp"
#include "impinge/method/operators.hpp"

namespace impinge {
namespace {

constexpr double reach = 2.6;
constexpr double pi = std::numbers::pi;

Outline polygon(std::vector<Vector<2>> points) {
  std::vector<std::string> mistakes;
  return *make_polygon(std::move(points), mistakes);
}
Outline polyline(std::vector<Vector<2>> points) {
  std::vector<std::string> mistakes;
  return *make_polyline(std::move(points), mistakes);
}
Outline circle(const Vector<2>& center, double radius) {
  std::vector<std::string> mistakes;
  return *make_circle(center, radius, mistakes);
}
Outline turned(const Outline& outline, double degrees) { return transformed(outline, {.rotation = rotation(degrees)}); }
Wall<2> wet_inside(Outline outline) {
  return {.name = "wall",
          .surface = std::make_shared<const Outline>(std::move(outline)),
          .wet_front = false,
          .wet_back = true};
}
Wall<2> wet_outside(Outline outline) {
  return {.name = "wall", .surface = std::make_shared<const Outline>(std::move(outline))};
}
Wall<2> plate(Outline outline) {
  return {.name = "wall",
          .surface = std::make_shared<const Outline>(std::move(outline)),
          .wet_front = true,
          .wet_back = true};
}

/// A cloud of particles and the pairs that walls leave of it.
struct Cloud {
  Particles<2> particles;
  MirrorWalls<2> walls;
  CellGrid<2> cells{{{{-40.0, -40.0}}, {{40.0, 40.0}}}, {}, 1.5};
  NeighbourSearch<2> search{cells, 2, KernelType::non_singular, reach, reach, true};

  Cloud(std::vector<Vector<2>> places, MirrorWalls<2> mirrors) : walls(std::move(mirrors)) {
    std::ranges::stable_sort(places, {}, [&](const Vector<2>& x) { return cells.cell(x); });
    for (std::size_t k = 0; k < places.size(); ++k)
      particles.append({places[k], {}, 0.0, 0.0, static_cast<std::int64_t>(k), ParticleType::fluid});
    walls.append_images(particles);
    search.arrange(particles);
    walls.append_own_images([&](int i) { return search.around(i, particles.position[static_cast<std::size_t>(i)]); },
                            particles);
    search.find(particles, &walls);
  }

  std::vector<double> density() const {
    std::vector<double> result(static_cast<std::size_t>(particles.owned));
    number_density(search.near(), result);
    return result;
  }

  /// Of particle i with what stands at and behind each original.
  std::map<int, double> weights(int i) const {
    std::map<int, double> sums;
    const PairList& near = search.near();
    for (int k = near.begin(i); k < near.end(i); ++k) {
      int j = near.index[static_cast<std::size_t>(k)];
      if (j >= walls.first_image()) j = walls.originals()[static_cast<std::size_t>(j - walls.first_image())];
      sums[j] += near.weight[static_cast<std::size_t>(k)];
    }
    return sums;
  }
};

/// Jittered lattice points of spacing 1 where `keep` says so.
template <class Keep>
std::vector<Vector<2>> points_where(Keep keep, double size, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  std::vector<Vector<2>> points;
  for (double x = -size + 0.5; x < size; ++x) {
    for (double y = -size + 0.5; y < size; ++y) {
      const Vector<2> point{{x + jitter(random), y + jitter(random)}};
      if (keep(point)) points.push_back(point);
    }
  }
  return points;
}

std::vector<Vector<2>> points_in(const Outline& outline, double size, unsigned seed = 1) {
  return points_where([&](const Vector<2>& x) { return outline.distance(x) < -0.2; }, size, seed);
}

MirrorWalls<2> walls_of(std::vector<Wall<2>> walls) { return {{}, walls, reach, 1.0}; }

/// Between what two particles see of each other.
double largest_asymmetry(const Cloud& cloud) {
  double largest = 0.0;
  for (int i = 0; i < cloud.particles.owned; ++i)
    for (const auto& [j, weight] : cloud.weights(i)) {
      const auto back = cloud.weights(j);
      const auto found = back.find(i);
      largest = std::max(largest, found == back.end() ? weight : std::abs(weight - found->second));
    }
  return largest;
}

TEST(SpecularPairs, OfABoxAreTheImagesAtItsPlanes) {
  const Outline box = polygon({{{0.0, 0.0}}, {{11.0, 0.0}}, {{11.0, 9.0}}, {{0.0, 9.0}}});
  const auto points = points_in(box, 12.0);
  const std::vector<Face<2>> planes{{{{0.0, 0.0}}, {{1.0, 0.0}}},
                                    {{{11.0, 0.0}}, {{-1.0, 0.0}}},
                                    {{{0.0, 0.0}}, {{0.0, 1.0}}},
                                    {{{0.0, 9.0}}, {{0.0, -1.0}}}};
  const Cloud by_planes(points, {planes, {}, reach, 1.0});
  const Cloud by_faces(points, walls_of({wet_inside(box)}));
  const auto expected = by_planes.density(), density = by_faces.density();
  ASSERT_EQ(density.size(), expected.size());
  for (std::size_t i = 0; i < density.size(); ++i) EXPECT_NEAR(density[i], expected[i], 1e-12);
  EXPECT_EQ(by_faces.search.near().pairs(), by_planes.search.near().pairs());
}

TEST(SpecularPairs, KnowNoAxes) {
  const Outline step =
      polygon({{{-9.0, 0.0}}, {{0.0, 0.0}}, {{0.0, 4.0}}, {{9.0, 4.0}}, {{7.0, 12.0}}, {{-9.0, 12.0}}});
  const auto points = points_in(step, 13.0);
  const Cloud straight(points, walls_of({wet_inside(step)}));
  for (const double angle : {17.0, 45.0, 90.0, 200.0}) {
    // In the order of the first cloud, so that ids are the same.
    std::vector<Vector<2>> moved;
    for (int i = 0; i < straight.particles.owned; ++i)
      moved.push_back(rotation(angle) * straight.particles.position[static_cast<std::size_t>(i)]);
    const Cloud cloud(moved, walls_of({wet_inside(turned(step, angle))}));
    double difference = 0.0;
    std::map<std::pair<long, long>, double> by_place;
    const auto key = [](const Vector<2>& x) { return std::pair(std::lround(1e6 * x[0]), std::lround(1e6 * x[1])); };
    const auto density = cloud.density(), expected = straight.density();
    for (std::size_t i = 0; i < density.size(); ++i) by_place[key(cloud.particles.position[i])] = density[i];
    for (std::size_t i = 0; i < expected.size(); ++i)
      difference = std::max(difference, std::abs(by_place[key(moved[i])] - expected[i]));
    EXPECT_LT(difference, 1e-9) << angle;
  }
}

TEST(SpecularPairs, AreSymmetric) {
  const Outline step =
      polygon({{{-9.0, 0.0}}, {{0.0, 0.0}}, {{0.0, 4.0}}, {{9.0, 4.0}}, {{7.0, 12.0}}, {{-9.0, 12.0}}});
  EXPECT_LT(largest_asymmetry({points_in(step, 13.0), walls_of({wet_inside(step)})}), 1e-12);
  const Outline ball = circle({{0.3, 0.1}}, 6.0);
  EXPECT_LT(largest_asymmetry({points_in(ball, 8.0), walls_of({wet_inside(ball)})}), 1e-12);
  const auto outside = points_where([&](const Vector<2>& x) { return ball.distance(x) > 0.2; }, 12.0);
  EXPECT_LT(largest_asymmetry({outside, walls_of({wet_outside(ball)})}), 1e-12);
  const Outline sheet = polyline({{{-3.0, -2.0}}, {{1.0, 0.5}}, {{2.0, 6.0}}});
  const auto both = points_where([&](const Vector<2>& x) { return sheet.distance(x) > 0.2; }, 12.0);
  EXPECT_LT(largest_asymmetry({both, walls_of({plate(sheet)})}), 1e-12);
}

// Two particles one above the other, right beyond the end of an upright face: the line between one and the other's
// image runs along the face's plane and is reflected far beyond the face.
TEST(SpecularPairs, EndWithTheirFace) {
  const Outline step =
      polygon({{{-9.0, 0.0}}, {{0.0, 0.0}}, {{0.0, -4.0}}, {{9.0, -4.0}}, {{9.0, 9.0}}, {{-9.0, 9.0}}});
  const Cloud cloud({{{0.01, 2.0}}, {{0.02, 3.2}}}, walls_of({wet_inside(step)}));
  const double direct = NonSingularKernel::weight(norm(Vector<2>{{0.01, 1.2}}), reach);
  EXPECT_NEAR(cloud.weights(0).at(1), direct, 1e-12);
  EXPECT_NEAR(cloud.weights(1).at(0), direct, 1e-12);
}

/// A wedge of fluid of some angle at the origin, its first face along x.
Outline wedge(double degrees, double size) {
  std::vector<Vector<2>> points{{{0.0, 0.0}}, {{size, 0.0}}};
  for (double at = 45.0; at < degrees - 1.0; at += 45.0)
    points.push_back(1.4 * size * (rotation(at) * Vector<2>{{1.0, 0.0}}));
  points.push_back(size * (rotation(degrees) * Vector<2>{{1.0, 0.0}}));
  return polygon(points);
}

/// Mean density of uniform random points, one per unit area: the integral of W.
double density_of_uniform_points() {
  double integral = 0.0;
  for (double r = 0.0005; r < reach; r += 0.001) integral += 2.0 * pi * r * 0.001 * NonSingularKernel::weight(r, reach);
  return integral;
}

/// Mean density near the tip of a wedge of uniform random points, over that of open space; without particles' own
/// images, which are where they are.
double density_at_tip(double degrees) {
  constexpr double size = 8.0;
  const Outline fluid = wedge(degrees, size);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1.5 * size, 1.5 * size);
  double sum = 0.0;
  std::int64_t count = 0;
  const double area = 9.0 * size * size;
  for (int trial = 0; trial < 120; ++trial) {
    std::vector<Vector<2>> points;
    for (int k = 0; k < static_cast<int>(area); ++k)
      if (const Vector<2> point{{place(random), place(random)}}; fluid.contains(point)) points.push_back(point);
    const Cloud cloud(points, walls_of({wet_inside(fluid)}));
    for (int i = 0; i < cloud.particles.owned; ++i) {
      if (norm(cloud.particles.position[static_cast<std::size_t>(i)]) > 2.6) continue;
      for (const auto& [j, weight] : cloud.weights(i)) sum += j == i ? 0.0 : weight;
      ++count;
    }
  }
  return sum / static_cast<double>(count) / density_of_uniform_points();
}

TEST(SpecularPairs, LeaveNoGapAndNoOverlapAtAnyAngle) {
  for (const double angle : {60.0, 90.0, 100.0, 135.0, 180.0, 225.0, 270.0, 315.0})
    EXPECT_NEAR(density_at_tip(angle), 1.0, 0.08) << angle;
}

/// A star of corners at random distances from the origin, some of them above 180 degrees.
Outline star(std::mt19937& random) {
  std::uniform_real_distribution<double> distance(7.0, 14.0);
  std::vector<Vector<2>> points;
  for (double at = 0.0; at < 360.0; at += 45.0)
    points.push_back(distance(random) * (rotation(at) * Vector<2>{{1.0, 0.0}}));
  return polygon(points);
}

TEST(SpecularPairs, LeaveNoGapAndNoOverlapInRandomPolygons) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-14.0, 14.0);
  double sum = 0.0, count = 0.0;
  for (int trial = 0; trial < 60; ++trial) {
    const Outline fluid = star(random);
    std::vector<Vector<2>> points;
    for (int k = 0; k < 28 * 28; ++k)
      if (const Vector<2> point{{place(random), place(random)}}; fluid.contains(point)) points.push_back(point);
    const Cloud cloud(points, walls_of({wet_inside(fluid)}));
    if (trial < 3) {
      EXPECT_LT(largest_asymmetry(cloud), 1e-12);
    }
    for (int i = 0; i < cloud.particles.owned; ++i)
      for (const auto& [j, weight] : cloud.weights(i)) sum += j == i ? 0.0 : weight;
    count += cloud.particles.owned;
  }
  EXPECT_NEAR(sum / count / density_of_uniform_points(), 1.0, 0.02);
}

/// Moves the particles apart where they crowd, as a flow does, but for those beyond `radius` from the origin.
std::vector<Vector<2>> relaxed(std::vector<Vector<2>> points, const Outline& fluid, double radius) {
  const double n0 = lattice_sums<2>(KernelType::non_singular, reach).number_density;
  for (int round = 0; round < 40; ++round) {
    const Cloud cloud(points, walls_of({wet_inside(fluid)}));
    points.clear();
    for (int i = 0; i < cloud.particles.owned; ++i) {
      Vector<2> x = cloud.particles.position[static_cast<std::size_t>(i)];
      const Vector<2> to = x + 0.25 * asymmetry<2>(cloud.search.near(), cloud.particles.position, n0, i);
      if (norm(x) < radius && fluid.distance(to) < -0.2) x = to;
      points.push_back(x);
    }
  }
  return points;
}

/// Root mean square of what the Poisson problem's solution has beside Re z^power along the faces of a wedge, over the
/// largest value. Where power is a multiple of pi/a, a: the wedge's angle, that flow has no velocity through the faces.
/// Its values are given beyond 8 dp from the tip.
double error_of_corner_flow(double degrees, double power) {
  constexpr double size = 12.0, given = 8.0, tilt = 17.0;  // no face is in line with the lattice
  const Outline fluid = turned(wedge(degrees, size), tilt);
  const auto exact = [&](const Vector<2>& place) {
    const Vector<2> x = rotation(-tilt) * place;
    double angle = std::atan2(x[1], x[0]);
    if (angle < 0.0) angle += 2.0 * pi;
    return std::pow(norm(x) / given, power) * std::cos(power * angle);
  };
  double squares = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Cloud cloud(relaxed(points_in(fluid, 1.5 * size, seed), fluid, size - 1.0), walls_of({wet_inside(fluid)}));
    const auto& position = cloud.particles.position;
    std::vector<double> p;
    std::vector<std::map<int, double>> rows;
    for (int i = 0; i < cloud.particles.owned; ++i) {
      p.push_back(exact(position[static_cast<std::size_t>(i)]));
      rows.push_back(cloud.weights(i));
    }
    double change = 1.0;
    while (change > 1e-9) {  // Gauss and Seidel
      change = 0.0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        if (norm(position[i]) > given) continue;
        double sum = 0.0, weights = 0.0;
        for (const auto& [j, weight] : rows[i]) {
          if (j == static_cast<int>(i)) continue;
          sum += weight * p[static_cast<std::size_t>(j)];
          weights += weight;
        }
        change = std::max(change, std::abs(sum / weights - p[i]));
        p[i] = sum / weights;
      }
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (norm(position[i]) > given || fluid.distance(position[i]) < -1.2) continue;
      squares += (p[i] - exact(position[i])) * (p[i] - exact(position[i]));
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

TEST(SpecularPairs, SolveCornerFlowsAsWellAsThoseAlongAPlane) {
  const double plane = error_of_corner_flow(180.0, 2.0);
  for (const double angle : {60.0, 90.0, 100.0, 135.0, 225.0, 270.0, 315.0}) {
    const double error = error_of_corner_flow(angle, 180.0 / angle);
    fmt::print("  {:.0f} degrees: {:.2f} %, a plane {:.2f} %\n", angle, 100.0 * error, 100.0 * plane);
    EXPECT_LT(error, (angle <= 270.0 ? 1.2 : 2.0) * plane) << angle;
  }
}

TEST(SpecularPairs, OfAPlateAreOnItsOwnSide) {
  const Outline sheet = polyline({{{-30.0, 0.0}}, {{30.0, 0.0}}});
  const auto points = points_where([](const Vector<2>& x) { return std::abs(x[1]) > 0.2; }, 10.0);
  const Cloud cloud(points, walls_of({plate(sheet)}));
  for (int i = 0; i < cloud.particles.owned; ++i)
    for (const auto& [j, weight] : cloud.weights(i))
      EXPECT_GT(cloud.particles.position[static_cast<std::size_t>(i)][1] *
                    cloud.particles.position[static_cast<std::size_t>(j)][1],
                0.0);
}

TEST(SpecularPairs, OfALineHideWhatIsBehindIt) {
  const Outline line = polyline({{{-30.0, 0.0}}, {{30.0, 0.0}}});
  const Wall<2> wall{
      .name = "wall", .surface = std::make_shared<const Outline>(line), .wet_front = false, .wet_back = true};
  const auto points = points_where([](const Vector<2>& x) { return std::abs(x[1]) > 0.2; }, 10.0);
  const Cloud cloud(points, walls_of({wall}));
  for (int i = 0; i < cloud.particles.owned; ++i) {
    const double here = cloud.particles.position[static_cast<std::size_t>(i)][1];
    for (const auto& [j, weight] : cloud.weights(i))
      EXPECT_GT(here * cloud.particles.position[static_cast<std::size_t>(j)][1], 0.0);
  }
  // Nothing passes it from behind either.
  const MirrorWalls<2> walls = walls_of({wall});
  Vector<2> to{{0.2, 0.3}}, velocity{{0.2, 0.8}};
  walls.faces().confine({{0.0, -0.5}}, to, velocity);
  EXPECT_NEAR(to[1], -0.3, 1e-12);
  EXPECT_EQ(velocity[1], -0.8);
}

TEST(SpecularPairs, AtACircleMakeItsSurfaceWhole) {
  constexpr double radius = 10.0;
  const Outline ball = circle({}, radius);
  for (const bool inside : {true, false}) {
    // Rings of points, so that the cloud follows the wall.
    std::vector<Vector<2>> points;
    for (double r = inside ? 4.5 : 10.5; r < (inside ? radius : 18.0); ++r) {
      const int count = static_cast<int>(std::lround(2.0 * pi * r));
      for (int k = 0; k < count; ++k)
        points.push_back(r * (rotation(360.0 * k / count + 31.0 * r) * Vector<2>{{1.0, 0.0}}));
    }
    const Cloud cloud(points, walls_of({inside ? wet_inside(ball) : wet_outside(ball)}));
    const auto density = cloud.density();
    const double n0 = lattice_sums<2>(KernelType::non_singular, reach).number_density;
    double at_wall = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < density.size(); ++i) {
      if (std::abs(ball.distance(cloud.particles.position[i])) > 1.0) continue;
      at_wall += density[i];
      ++count;
    }
    EXPECT_NEAR(at_wall / count / n0, 1.0, 0.03) << inside;
  }
}

TEST(Walls, LetNothingPass) {
  const Outline bowl =
      polygon({{{-9.0, 0.0}}, {{0.0, 0.0}}, {{0.0, 4.0}}, {{9.0, 4.0}}, {{7.0, 12.0}}, {{-9.0, 12.0}}});
  const Outline island = circle({{-4.0, 6.0}}, 3.5);
  const Outline sheet = polyline({{{2.0, 6.0}}, {{5.0, 9.0}}, {{2.0, 11.0}}});
  const MirrorWalls<2> walls({}, {wet_inside(bowl), wet_outside(island), plate(sheet)}, reach, 1.0);
  const auto is_fluid = [&](const Vector<2>& x) { return bowl.contains(x) && !island.contains(x); };
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-9.0, 12.0), way(-1.5, 1.5);
  int bounces = 0;
  for (int walker = 0; walker < 200; ++walker) {
    Vector<2> x{{place(random), place(random)}};
    if (!is_fluid(x)) continue;
    for (int step = 0; step < 300; ++step) {
      const Vector<2> step_way{{way(random), way(random)}};
      Vector<2> to = x + step_way, velocity = step_way;
      walls.faces().confine(x, to, velocity);
      ASSERT_TRUE(is_fluid(to)) << walker << " " << step << ": " << x[0] << " " << x[1] << " -> " << to[0] << " "
                                << to[1] << " by " << step_way[0] << " " << step_way[1];
      EXPECT_NEAR(norm(velocity), norm(step_way), 1e-12);
      bounces += velocity != step_way;
      const auto hit = sheet.first_hit(x, to);
      if (velocity == step_way) {
        EXPECT_FALSE(hit);
      }
      x = to;
    }
  }
  EXPECT_GT(bounces, 1000);
}

TEST(Walls, ThatMoveTakeTheirImagesAndParticlesAlong) {
  const Outline box = polygon({{{-4.0, -4.0}}, {{4.0, -4.0}}, {{4.0, 4.0}}, {{-4.0, 4.0}}});
  Wall<2> wall = wet_inside(box);
  constexpr double omega = 0.7;
  const Vector<2> drift{{2.0, -1.0}};
  const Motion<2> motion = [&](double t) {
    Pose<2> pose;
    pose.rotation = rotation(omega * t * 180.0 / pi);
    pose.shift = t * drift;
    pose.spin.row[0][1] = -omega;
    pose.spin.row[1][0] = omega;
    pose.velocity = drift - t * (pose.spin * drift);
    pose.bend = -omega * omega * Matrix<2>::identity();
    pose.acceleration = -1.0 * (pose.bend * pose.shift);
    return pose;
  };
  wall.motion = std::make_shared<const Motion<2>>(motion);
  MirrorWalls<2> walls({}, {wall}, reach, 1.0);
  constexpr double t = 0.3;
  walls.move_to(t, t);
  const Pose<2> pose = motion(t);
  std::vector<Vector<2>> points;
  for (const Vector<2>& point : points_in(box, 5.0)) points.push_back(pose.of_position(point));
  Cloud cloud(points, walls);
  // Fluid that rotates with the box: so do its images.
  for (int i = 0; i < cloud.particles.size(); ++i)
    cloud.particles.velocity[static_cast<std::size_t>(i)] =
        pose.velocity_at(cloud.particles.position[static_cast<std::size_t>(i)]);
  std::vector<Vector<2>> velocity = cloud.particles.velocity;
  cloud.walls.copy_velocities(cloud.particles.position, velocity);
  for (std::size_t i = 0; i < velocity.size(); ++i) EXPECT_LT(norm(velocity[i] - cloud.particles.velocity[i]), 1e-12);
  // A particle at rest in the box stays where it is.
  Vector<2> to = motion(t + 0.1).of_position({{3.9, 0.5}}), speed{};
  const Vector<2> expected = to;
  walls.move_to(t + 0.1, t + 0.1);
  walls.faces().confine(pose.of_position({{3.9, 0.5}}), to, speed);
  EXPECT_EQ(to, expected);
  // One at rest in space is carried along by the wall that runs into it.
  const Vector<2> here = pose.of_position({{3.99, 0.5}});
  walls.move_to(t, t);
  walls.move_to(t + 0.1, t + 0.1);
  to = here;
  walls.faces().confine(here, to, speed);
  EXPECT_LT(box.distance(rotation(-omega * (t + 0.1) * 180.0 / pi) * (to - motion(t + 0.1).shift)), 0.0);
}

}  // namespace
}  // namespace impinge
