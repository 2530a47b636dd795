// Walls in three dimensions: surfaces of facets, and the images that particles see at them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "impinge/boundaries/mirror_walls.hpp"
#include "impinge/method/operators.hpp"

namespace impinge {
namespace {

constexpr double reach = 2.6;

std::shared_ptr<const Mesh> mesh_of(const Facets& facets) {
  std::vector<std::string> mistakes, warnings;
  auto mesh = make_mesh(facets, mistakes, warnings);
  EXPECT_TRUE(mesh) << (mistakes.empty() ? "" : mistakes[0]);
  return std::make_shared<const Mesh>(std::move(*mesh));
}
Facets polygon(const std::vector<Vector<3>>& points) {
  std::vector<std::string> mistakes;
  return *polygon_facets(points, mistakes);
}
Wall<3> wet_inside(const Facets& facets) {
  return {.name = "wall", .surface = mesh_of(facets), .wet_front = false, .wet_back = true};
}
Wall<3> wet_outside(const Facets& facets) { return {.name = "wall", .surface = mesh_of(facets)}; }
Wall<3> plate(const Facets& facets) {
  return {.name = "plate", .surface = mesh_of(facets), .wet_front = true, .wet_back = true};
}

/// Every facet cut into four, in another order, with points of its own.
Facets refined(const Facets& facets, unsigned seed) {
  Facets result;
  const auto add = [&](const Vector<3>& a, const Vector<3>& b, const Vector<3>& c) {
    const auto first = static_cast<int>(result.points.size());
    result.points.insert(result.points.end(), {a, b, c});
    result.facets.push_back({first, first + 1, first + 2});
  };
  for (const Facet& facet : facets.facets) {
    const auto at = [&](std::size_t k) { return facets.points[static_cast<std::size_t>(facet[k])]; };
    const auto middle = [&](std::size_t k, std::size_t l) { return 0.5 * (at(k) + at(l)); };
    add(at(0), middle(0, 1), middle(2, 0));
    add(at(1), middle(1, 2), middle(0, 1));
    add(at(2), middle(2, 0), middle(1, 2));
    add(middle(0, 1), middle(1, 2), middle(2, 0));
  }
  std::mt19937 random(seed);
  std::shuffle(result.facets.begin(), result.facets.end(), random);
  return result;
}

/// Jittered lattice points of spacing 1 between walls that no wall is nearer to than `margin`.
template <class IsIn>
std::vector<Vector<3>> points_where(IsIn is_in, double size, double jitter = 0.15) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shake(-jitter, jitter);
  std::vector<Vector<3>> points;
  for (double x = -size + 0.5; x < size; ++x)
    for (double y = -size + 0.5; y < size; ++y)
      for (double z = -size + 0.5; z < size; ++z) {
        const Vector<3> point{{x + shake(random), y + shake(random), z + shake(random)}};
        if (is_in(point)) points.push_back(point);
      }
  return points;
}

/// A cloud of particles and the pairs that walls leave of it.
struct Cloud {
  Particles<3> particles;
  MirrorWalls<3> walls;
  CellGrid<3> cells{{{{-16.0, -16.0, -16.0}}, {{16.0, 16.0, 16.0}}}, {}, 1.5};
  NeighbourSearch<3> search{cells, 2, KernelType::non_singular, reach, reach, true};

  Cloud(std::vector<Vector<3>> places, MirrorWalls<3> mirrors) : walls(std::move(mirrors)) {
    std::ranges::stable_sort(places, {}, [&](const Vector<3>& x) { return cells.cell(x); });
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

MirrorWalls<3> walls_of(std::vector<Wall<3>> walls) { return {{}, walls, reach, 1.0}; }

/// Between what two particles see of each other.
double largest_asymmetry(const Cloud& cloud) {
  std::vector<std::map<int, double>> all;
  for (int i = 0; i < cloud.particles.owned; ++i) all.push_back(cloud.weights(i));
  double largest = 0.0;
  for (int i = 0; i < cloud.particles.owned; ++i)
    for (const auto& [j, weight] : all[static_cast<std::size_t>(i)]) {
      const auto& back = all[static_cast<std::size_t>(j)];
      const auto found = back.find(i);
      largest = std::max(largest, found == back.end() ? weight : std::abs(weight - found->second));
    }
  return largest;
}

/// Mean density of the particles for which `counts` says so, over that of a lattice.
template <class Counts>
double mean_density(const Cloud& cloud, Counts counts) {
  const std::vector<double> density = cloud.density();
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < density.size(); ++i) {
    if (!counts(cloud.particles.position[i])) continue;
    sum += density[i];
    count += 1.0;
  }
  return sum / count / lattice_sums<3>(KernelType::non_singular, reach).number_density;
}

TEST(Mesh, OfShapesAreClosedAndFaceOutwards) {
  const auto box = mesh_of(box_facets({{0, 0, 0}}, {{1, 2, 3}}));
  EXPECT_TRUE(box->closed());
  EXPECT_NEAR(box->volume(), 6.0, 1e-12);
  EXPECT_NEAR(box->area(), 22.0, 1e-12);
  EXPECT_EQ(box->patches().size(), 6u);
  EXPECT_EQ(box->edges().size(), 24u);
  for (const Mesh::Edge& edge : box->edges()) EXPECT_NEAR(edge.angle, 1.5 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(box->distance({{0.5, 1.0, 0.2}}), -0.2, 1e-12);
  EXPECT_NEAR(box->distance({{2.0, 3.0, 4.0}}), std::sqrt(3.0), 1e-12);
  const auto ball = mesh_of(sphere_facets({{1, 2, 3}}, 2.0));
  EXPECT_EQ(ball->patches().size(), 1u);
  EXPECT_TRUE(ball->edges().empty());
  EXPECT_NEAR(ball->volume(), 32.0 / 3.0 * std::numbers::pi, 0.1);
  const auto drum = mesh_of(cone_facets({{0, 0, 0}}, {{0, 0, 2}}, 1.0, 1.0));
  EXPECT_EQ(drum->patches().size(), 3u);
  EXPECT_NEAR(drum->volume(), 2.0 * std::numbers::pi, 0.01);
  const auto cone = mesh_of(cone_facets({{0, 0, 2}}, {{0, 0, 0}}, 1.0, 0.0));
  EXPECT_EQ(cone->patches().size(), 2u);
  EXPECT_NEAR(cone->volume(), 2.0 / 3.0 * std::numbers::pi, 0.01);
  Facets inside_out = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  for (Facet& facet : inside_out.facets) std::swap(facet[0], facet[1]);
  EXPECT_NEAR(mesh_of(inside_out)->volume(), 1.0, 1e-12);
}

TEST(Mesh, OfAConcavePolygonHasItsArea) {
  const auto mesh = mesh_of(polygon({{{0, 0, 1}}, {{3, 0, 1}}, {{3, 3, 1}}, {{2, 3, 1}}, {{2, 1, 1}}, {{0, 1, 1}}}));
  EXPECT_FALSE(mesh->closed());
  EXPECT_NEAR(mesh->area(), 5.0, 1e-12);
  EXPECT_EQ(mesh->patches().size(), 1u);
  EXPECT_EQ(mesh->edges().size(), 6u);
  EXPECT_GT(mesh->patches()[0]->normal()[2], 0.99);
}

TEST(Mesh, ThatIsWrongIsToldByItsFacets) {
  const auto mistakes_of = [](const Facets& facets) {
    std::vector<std::string> mistakes, warnings;
    EXPECT_FALSE(make_mesh(facets, mistakes, warnings));
    return mistakes.empty() ? "" : mistakes[0];
  };
  Facets twice = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  twice.facets.push_back(twice.facets[3]);
  EXPECT_EQ(mistakes_of(twice), "facets 4 and 13 have the same corners");
  Facets turned = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  std::swap(turned.facets[4][0], turned.facets[4][1]);
  EXPECT_NE(mistakes_of(turned).find("face opposite sides"), std::string::npos);
  Facets fan = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  fan.points.push_back({{2, 2, 2}});
  fan.facets.push_back({0, 3, 8});
  EXPECT_NE(mistakes_of(fan).find("3 facets meet at one edge"), std::string::npos);
  Facets crossing = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  const Facets other = box_facets({{0.5, 0.5, 0.5}}, {{2, 2, 2}});
  for (const Facet& facet : other.facets) crossing.facets.push_back({facet[0] + 8, facet[1] + 8, facet[2] + 8});
  crossing.points.insert(crossing.points.end(), other.points.begin(), other.points.end());
  EXPECT_NE(mistakes_of(crossing).find("cross each other"), std::string::npos);
  Facets flat = box_facets({{0, 0, 0}}, {{1, 1, 1}});
  flat.facets.push_back({0, 1, 1});
  std::vector<std::string> mistakes, warnings;
  EXPECT_TRUE(make_mesh(flat, mistakes, warnings));
  EXPECT_EQ(warnings, std::vector<std::string>{"1 facet(s) without an area left out, the first is facet 13"});
}

TEST(Patch, OfASphereIsItsSurface) {
  const auto ball = mesh_of(sphere_facets({{0.1, 0.2, 0.3}}, 2.0));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 200; ++k) {
    Vector<3> way{{normal(random), normal(random), normal(random)}};
    way *= 1.0 / norm(way);
    const Vector<3> centre{{0.1, 0.2, 0.3}};
    const PatchPoint at = ball->patches()[0]->nearest(centre + (1.6 + 0.004 * k) * way);
    EXPECT_LT(norm(at.point - centre - 2.0 * way), 3e-4);
    EXPECT_LT(norm(at.normal - way), 1e-3);
    EXPECT_NEAR(at.height, 0.004 * k - 0.4, 3e-4);
    EXPECT_EQ(at.beyond, 0.0);
    EXPECT_NEAR(trace(at.bending), 1.0, 0.02);
  }
}

TEST(WallPoints, OfAClosedSurfaceFaceAwayFromEachOther) {
  for (const Facets& facets : {box_facets({{0, 0, 0}}, {{3, 4.2, 5}}), sphere_facets({{0, 0, 0}}, 4.0)}) {
    const auto points = wall_points<3>({wet_outside(facets)}, 1.0);
    Vector<3> sum;
    double area = 0.0;
    for (const WallPoint<3>& point : points) {
      sum += point.area * point.normal;
      area += point.area;
    }
    EXPECT_LT(norm(sum), 1e-12 * area);
    EXPECT_NEAR(area, mesh_of(facets)->area(), 0.02 * area);
  }
}

TEST(SpecularPairsInSpace, OfABoxAreTheImagesAtItsPlanes) {
  const Vector<3> low{{-4, -3, -4}}, high{{4, 5, 3}};
  const auto points = points_where(
      [&](const Vector<3>& x) {
        for (int k = 0; k < 3; ++k)
          if (x[k] < low[k] + 0.2 || x[k] > high[k] - 0.2) return false;
        return true;
      },
      5.0);
  std::vector<Face<3>> planes;
  for (int k = 0; k < 3; ++k) {
    Vector<3> normal;
    normal[k] = 1.0;
    planes.push_back({low, normal});
    planes.push_back({high, -1.0 * normal});
  }
  const Facets box = box_facets(low, high);
  const Cloud by_planes(points, {planes, {}, reach, 1.0});
  const auto expected = by_planes.density();
  for (const Facets& facets : {box, refined(box, 1), refined(refined(box, 2), 3)}) {
    const auto found = Cloud(points, walls_of({wet_inside(facets)})).density();
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-12 * expected[i]);
  }
}

TEST(SpecularPairsInSpace, AtABlockOnAFloorAreSymmetricAndFillIt) {
  const Facets room = box_facets({{-7, -7, -5}}, {{7, 7, 7}}), block = box_facets({{-2, -3, -5}}, {{2, 3, 0}});
  const auto inner = mesh_of(room), solid = mesh_of(block);
  const auto is_in = [&](const Vector<3>& x) { return inner->distance(x) < -0.3 && solid->distance(x) > 0.3; };
  const Cloud cloud(points_where(is_in, 7.0), walls_of({wet_inside(room), wet_outside(block)}));
  EXPECT_LT(largest_asymmetry(cloud), 1e-12);
  EXPECT_NEAR(mean_density(cloud, [&](const Vector<3>& x) { return solid->distance(x) < 1.0; }), 1.0, 0.02);
}

// Beside a face nothing keeps a particle from the face's plane. There it would meet its own image.
TEST(SpecularPairsInSpace, OfAParticleWithItselfEndWithTheFace) {
  const auto nearest_image = [&](const Vector<3>& place) {
    const Cloud cloud({place}, walls_of({wet_outside(box_facets({{-2, -2, -2}}, {{2, 2, 2}}))}));
    double nearest = 10.0;
    for (const int j : cloud.search.near().row(0))
      nearest = std::min(nearest, norm(cloud.particles.position[static_cast<std::size_t>(j)] - place));
    return nearest;
  };
  EXPECT_NEAR(nearest_image({{2.1, 1.9, 0.0}}), 0.2, 1e-12);
  for (const double beside : {0.0, 0.01, 0.1, 0.2})
    EXPECT_GE(nearest_image({{2.001, 2.0 + beside, 0.0}}), 1.9 * beside) << beside;
}

// Of points anywhere, a particle sees as many at a wall as far from it, but for its own images.
TEST(SpecularPairsInSpace, AtACurvedWallSeeAUniformCloud) {
  const Facets ball = sphere_facets({{0, 0, 0}}, 6.0);
  for (const bool inside : {true, false}) {
    double sums[2] = {}, counts[2] = {};
    for (unsigned seed = 1; seed < 5; ++seed) {
      std::mt19937 random(seed);
      std::uniform_real_distribution<double> somewhere(-10.0, 10.0);
      std::vector<Vector<3>> points;
      for (int k = 0; k < 8000; ++k) {
        const Vector<3> x{{somewhere(random), somewhere(random), somewhere(random)}};
        if ((norm(x) < 6.0) == inside) points.push_back(x);
      }
      const Cloud cloud(points, walls_of({inside ? wet_inside(ball) : wet_outside(ball)}));
      EXPECT_LT(largest_asymmetry(cloud), 1e-9);
      for (int i = 0; i < cloud.particles.owned; ++i) {
        const Vector<3>& x = cloud.particles.position[static_cast<std::size_t>(i)];
        const double height = std::abs(norm(x) - 6.0);
        const double farthest = std::max({std::abs(x[0]), std::abs(x[1]), std::abs(x[2])});
        const bool is_far = inside ? norm(x) < 3.4 : norm(x) > 8.6 && farthest < 7.4;
        if (height > 1.0 && !is_far) continue;
        auto weights = cloud.weights(i);
        weights.erase(i);
        for (const auto& [j, weight] : weights) sums[is_far] += weight;
        counts[is_far] += 1.0;
      }
    }
    EXPECT_NEAR(sums[0] / counts[0] / (sums[1] / counts[1]), 1.0, 0.04) << inside;
  }
}

TEST(SpecularPairsInSpace, OfADrumSeeItsCorners) {
  const Facets drum = cone_facets({{0, 0, -5}}, {{0, 0, 5}}, 6.0, 6.0);
  const auto surface = mesh_of(drum);
  const Cloud cloud(points_where([&](const Vector<3>& x) { return surface->distance(x) < -0.3; }, 7.0, 0.1),
                    walls_of({wet_inside(drum)}));
  EXPECT_LT(largest_asymmetry(cloud), 1e-9);
  const auto near_floor = [](const Vector<3>& x) { return x[2] < -4.0; };
  const auto near_side = [](const Vector<3>& x) { return std::hypot(x[0], x[1]) > 5.0; };
  const double side = mean_density(cloud, [&](const Vector<3>& x) { return near_side(x) && std::abs(x[2]) < 2.0; });
  const double corner = mean_density(cloud, [&](const Vector<3>& x) { return near_side(x) && near_floor(x); });
  EXPECT_NEAR(corner / side, 1.0, 0.03);
}

TEST(SpecularPairsInSpace, NothingIsSeenThroughAPlate) {
  const auto sheet = polygon({{{-6, -6, 0}}, {{6, -6, 0}}, {{6, 6, 0}}, {{-6, 6, 0}}});
  const Cloud cloud(points_where([](const Vector<3>& x) { return std::abs(x[2]) > 0.2; }, 5.0),
                    walls_of({plate(sheet)}));
  EXPECT_LT(largest_asymmetry(cloud), 1e-12);
  for (int i = 0; i < cloud.particles.owned; ++i) {
    const Vector<3>& here = cloud.particles.position[static_cast<std::size_t>(i)];
    if (std::max(std::abs(here[0]), std::abs(here[1])) > 3.0) continue;
    for (const auto& [j, weight] : cloud.weights(i))
      EXPECT_GT(here[2] * cloud.particles.position[static_cast<std::size_t>(j)][2], 0.0);
  }
}

TEST(WallSurfaces, KeepWhatMovesOnItsSide) {
  const Facets room = box_facets({{-6, -6, -6}}, {{6, 6, 6}}), block = box_facets({{-2, -3, -6}}, {{2, 3, 0}});
  const Facets ball = sphere_facets({{3.5, 3.5, 2.5}}, 2.0);
  const MirrorWalls<3> walls = walls_of({wet_inside(room), wet_outside(block), wet_outside(ball)});
  const auto in_fluid = [&, inner = mesh_of(room), solid = mesh_of(block), sphere = mesh_of(ball)](const Vector<3>& x) {
    return inner->distance(x) < 0.0 && solid->distance(x) > 0.0 && sphere->distance(x) > -5e-3;
  };
  std::mt19937 random(2);
  std::uniform_real_distribution<double> somewhere(-5.9, 5.9);
  std::normal_distribution<double> way(0.0, 0.4);
  for (int walk = 0; walk < 100; ++walk) {
    Vector<3> x;
    do x = {{somewhere(random), somewhere(random), somewhere(random)}};
    while (!in_fluid(x));
    for (int step = 0; step < 200; ++step) {
      Vector<3> to = x + Vector<3>{{way(random), way(random), way(random)}}, velocity = to - x;
      walls.faces().confine(x, to, velocity);
      ASSERT_TRUE(in_fluid(to)) << to[0] << " " << to[1] << " " << to[2];
      x = to;
    }
  }
}

}  // namespace
}  // namespace impinge
