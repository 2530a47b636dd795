// Shapes: distances, normals, areas, gaps and hits against formulas and brute force; wrong numbers are refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "impinge/geometry/outline.hpp"
#include "impinge/geometry/solids.hpp"

namespace impinge {
namespace {

using Texts = std::vector<std::string>;
using Points = std::vector<Vector<2>>;

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array odd_angles{0.0, 17.0, 45.0, 90.0, 123.4, 180.0, 271.0, -33.3};

const Points triangle{{{{0.0, 0.0}}, {{4.0, 0.0}}, {{0.0, 3.0}}}};
/// A box of 4 x 3 with a notch from above that ends in a point at (2, 1).
const Points notched{{{{0.0, 0.0}}, {{4.0, 0.0}}, {{4.0, 3.0}}, {{2.0, 1.0}}, {{0.0, 3.0}}}};
/// A thick U.
const Points cup{
    {{{0.0, 0.0}}, {{3.0, 0.0}}, {{3.0, 2.0}}, {{2.0, 2.0}}, {{2.0, 1.0}}, {{1.0, 1.0}}, {{1.0, 2.0}}, {{0.0, 2.0}}}};

template <class Make>
Outline sound(Make make) {
  Texts mistakes;
  auto outline = make(mistakes);
  EXPECT_EQ(mistakes, Texts{});
  return outline.value();
}
Outline box(const Vector<2>& low, const Vector<2>& high) {
  return sound([&](Texts& mistakes) { return make_box(low, high, mistakes); });
}
Outline circle(const Vector<2>& center, double radius) {
  return sound([&](Texts& mistakes) { return make_circle(center, radius, mistakes); });
}
Outline arc(const Vector<2>& center, double radius, double from, double to) {
  return sound([&](Texts& mistakes) { return make_arc(center, radius, from, to, mistakes); });
}
Outline polygon(const Points& points) {
  return sound([&](Texts& mistakes) { return make_polygon(points, mistakes); });
}
Outline polyline(const Points& points) {
  return sound([&](Texts& mistakes) { return make_polyline(points, mistakes); });
}

template <class Make>
Texts mistakes_of(Make make) {
  Texts mistakes;
  EXPECT_FALSE(make(mistakes).has_value());
  return mistakes;
}
Texts mistakes_of_polygon(const Points& points) {
  return mistakes_of([&](Texts& mistakes) { return make_polygon(points, mistakes); });
}
Texts mistakes_of_polyline(const Points& points) {
  return mistakes_of([&](Texts& mistakes) { return make_polyline(points, mistakes); });
}

Transform<2> turn(double degrees) {
  return {.scale = 1.7, .rotation = rotation(degrees), .about = {{0.3, -0.8}}, .translate = {{2.1, 0.4}}};
}

void expect_near(const Vector<2>& actual, const Vector<2>& expected, double margin) {
  EXPECT_NEAR(norm(actual - expected), 0.0, margin)
      << actual[0] << ", " << actual[1] << " instead of " << expected[0] << ", " << expected[1];
}

/// A point of every edge, often.
Points samples(const Outline& outline, int per_edge = 4000) {
  Points points;
  for (const OutlineEdge& edge : outline.edges())
    for (int k = 0; k <= per_edge; ++k) points.push_back(edge.at(static_cast<double>(k) / per_edge));
  return points;
}

/// The sum of the angles that the outline turns through as seen from a point, in full turns.
double winding(const Points& outline, const Vector<2>& point) {
  double sum = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector<2> one = outline[k] - point, two = outline[(k + 1) % outline.size()] - point;
    sum += std::atan2(one[0] * two[1] - one[1] * two[0], dot(one, two));
  }
  return sum / (2.0 * pi);
}

Points random_points(const Box<2>& box, int count) {
  std::mt19937 random(7);
  const Vector<2> size = box.high - box.low;
  std::uniform_real_distribution<double> x(box.low[0] - 0.5 * size[0], box.high[0] + 0.5 * size[0]);
  std::uniform_real_distribution<double> y(box.low[1] - 0.5 * size[1], box.high[1] + 0.5 * size[1]);
  Points points;
  for (int k = 0; k < count; ++k) points.push_back({{x(random), y(random)}});
  return points;
}

std::vector<Outline> all_shapes() {
  return {box({{-1.0, 0.5}}, {{2.0, 1.5}}),
          circle({{0.4, -0.3}}, 1.2),
          arc({{0.4, -0.3}}, 1.2, 20.0, 200.0),
          arc({{0.0, 0.0}}, 0.7, 60.0, -250.0),
          polygon(triangle),
          polygon(notched),
          polygon(cup),
          polyline({{{0.0, 0.0}}, {{1.0, 0.2}}, {{0.5, 1.5}}, {{-1.0, 1.0}}})};
}

TEST(Transform, TurnsExactlyByRightAngles) {
  for (const int quarters : {-5, -1, 0, 1, 2, 3, 4, 7}) {
    const int turn = ((quarters % 4) + 4) % 4;
    const auto [cosine, sine] = cosine_and_sine(90.0 * quarters);
    EXPECT_EQ(cosine, turn == 0 ? 1.0 : turn == 2 ? -1.0 : 0.0);
    EXPECT_EQ(sine, turn == 1 ? 1.0 : turn == 3 ? -1.0 : 0.0);
  }
  for (const double degrees : odd_angles) {
    EXPECT_NEAR(cosine_and_sine(degrees).first, std::cos(degrees * pi / 180.0), 1e-15);
    EXPECT_NEAR(cosine_and_sine(degrees).second, std::sin(degrees * pi / 180.0), 1e-15);
  }
}

TEST(Transform, ScalesAndTurnsAboutAPointThenMoves) {
  const Transform<2> transform{2.0, rotation(90.0), {{1.0, 1.0}}, {{10.0, 0.0}}};
  EXPECT_EQ(transform({{1.0, 1.0}}), (Vector<2>{{11.0, 1.0}}));
  EXPECT_EQ(transform({{2.0, 1.0}}), (Vector<2>{{11.0, 3.0}}));
  for (const double degrees : odd_angles)
    expect_near(turn(degrees).origin_of(turn(degrees)({{0.7, -0.2}})), {{0.7, -0.2}}, 1e-15);
}

TEST(Transform, TurnsAboutAnAxisInSpace) {
  const Vector<3> up{{0.0, 0.0, 1.0}};
  EXPECT_EQ((rotation(up, 90.0) * Vector<3>{{1.0, 0.0, 0.0}}), (Vector<3>{{0.0, 1.0, 0.0}}));
  const Vector<3> axis = 1.0 / 3.0 * Vector<3>{{1.0, 2.0, 2.0}};
  const Matrix<3> turn_about_axis = rotation(axis, 50.0);
  EXPECT_NEAR(determinant(turn_about_axis), 1.0, 1e-15);
  EXPECT_NEAR(norm(turn_about_axis * axis - axis), 0.0, 1e-15);
  const Transform<3> transform{0.5, turn_about_axis, {{1.0, 0.0, 2.0}}, {{0.0, -3.0, 0.0}}};
  const Vector<3> point{{0.1, 0.2, 0.3}};
  EXPECT_NEAR(norm(transform.origin_of(transform(point)) - point), 0.0, 1e-15);
}

TEST(Outline, AreasAndLengthsAreExact) {
  EXPECT_DOUBLE_EQ(box({{-1.0, 0.5}}, {{2.0, 1.5}}).volume(), 3.0);
  EXPECT_DOUBLE_EQ(box({{-1.0, 0.5}}, {{2.0, 1.5}}).length(), 8.0);
  EXPECT_DOUBLE_EQ(circle({{5.0, -3.0}}, 0.5).volume(), 0.25 * pi);
  EXPECT_DOUBLE_EQ(circle({{5.0, -3.0}}, 0.5).length(), pi);
  EXPECT_DOUBLE_EQ(polygon(triangle).volume(), 6.0);
  EXPECT_DOUBLE_EQ(polygon(triangle).length(), 12.0);
  EXPECT_DOUBLE_EQ(polygon(notched).volume(), 8.0);
  EXPECT_DOUBLE_EQ(polygon(cup).volume(), 5.0);
  EXPECT_DOUBLE_EQ(arc({{0.0, 0.0}}, 2.0, 30.0, -60.0).length(), pi);
  EXPECT_EQ(arc({{0.0, 0.0}}, 2.0, 30.0, -60.0).volume(), 0.0);
  EXPECT_DOUBLE_EQ(polyline({{{0.0, 0.0}}, {{3.0, 4.0}}, {{3.0, 5.0}}}).length(), 6.0);
  EXPECT_EQ(polyline(triangle).volume(), 0.0);
}

TEST(Outline, AreaKeepsItsDigitsFarFromTheOrigin) {
  Points far = triangle;
  for (Vector<2>& point : far) point += Vector<2>{{1e6, -1e6}};
  EXPECT_DOUBLE_EQ(polygon(far).volume(), 6.0);
}

TEST(Outline, TransformScalesLengthsAndAreas) {
  for (const Outline& shape : all_shapes()) {
    for (const double degrees : odd_angles) {
      const Outline turned = transformed(shape, turn(degrees));
      EXPECT_EQ(turned.closed(), shape.closed());
      EXPECT_NEAR(turned.length(), 1.7 * shape.length(), 1e-13 * turned.length());
      EXPECT_NEAR(turned.volume(), 1.7 * 1.7 * shape.volume(), 1e-13 * turned.volume());
    }
  }
}

TEST(Outline, DistanceAndNormalTurnWithTheShape) {
  for (const Outline& shape : all_shapes()) {
    for (const double degrees : odd_angles) {
      const Transform<2> transform = turn(degrees);
      const Outline turned = transformed(shape, transform);
      for (const Vector<2>& point : random_points(shape.bounds(), 200)) {
        EXPECT_NEAR(turned.distance(transform(point)), 1.7 * shape.distance(point), 1e-14 * 10.0);
        expect_near(turned.normal(transform(point)), transform.rotation * shape.normal(point), 1e-10);
      }
    }
  }
}

TEST(Outline, DistanceIsThatOfBruteForce) {
  for (const Outline& shape : all_shapes()) {
    for (const double degrees : {0.0, 33.0}) {
      const Outline turned = transformed(shape, turn(degrees));
      const Points on_outline = samples(turned);
      for (const Vector<2>& point : random_points(turned.bounds(), 100)) {
        double nearest = infinity;
        for (const Vector<2>& other : on_outline) nearest = std::min(nearest, norm(other - point));
        EXPECT_NEAR(std::abs(turned.distance(point)), nearest, 0.01);
        EXPECT_LE(std::abs(turned.distance(point)), nearest + 1e-12);
        const bool inside = turned.closed() && std::abs(winding(on_outline, point)) > 0.5;
        EXPECT_EQ(turned.contains(point), inside) << point[0] << ", " << point[1];
        EXPECT_EQ(turned.nearest(point).distance, std::abs(turned.distance(point)));
      }
    }
  }
}

TEST(Outline, NormalIsTheGradientOfTheDistance) {
  constexpr double h = 1e-6;
  for (const Outline& shape : all_shapes()) {
    int compared = 0;
    for (const Vector<2>& point : random_points(shape.bounds(), 200)) {
      const Vector<2> normal = shape.normal(point);
      EXPECT_NEAR(norm(normal), 1.0, 1e-14);
      Vector<2> gradient;
      for (int k = 0; k < 2; ++k) {
        Vector<2> step;
        step[k] = h;
        gradient[k] = (shape.distance(point + step) - shape.distance(point - step)) / (2.0 * h);
      }
      if (std::abs(norm(gradient) - 1.0) > 1e-5) continue;  // two parts of the outline are equally near
      expect_near(normal, gradient, 1e-4);
      ++compared;
    }
    EXPECT_GT(compared, 190);
  }
}

TEST(Outline, PointsOnEdgesAndCornersHaveNoDistance) {
  for (const Outline& shape : all_shapes()) {
    for (const double degrees : odd_angles) {
      const Outline turned = transformed(shape, turn(degrees));
      for (const OutlineEdge& edge : turned.edges()) {
        for (const double share : {0.0, 0.2, 0.5, 1.0}) {
          const Vector<2> point = edge.at(share);
          EXPECT_NEAR(turned.distance(point), 0.0, 1e-14);
          EXPECT_NEAR(norm(turned.normal(point)), 1.0, 1e-14);
          if (share == 0.2 || share == 0.5) expect_near(turned.normal(point), edge.normal(share), 1e-12);
        }
      }
    }
  }
}

TEST(Outline, NormalAtACornerIsBetweenThoseOfItsEdges) {
  const double half = std::sqrt(0.5);
  const Outline square = box({{0.0, 0.0}}, {{2.0, 2.0}});
  expect_near(square.normal({{0.0, 0.0}}), {{-half, -half}}, 1e-15);
  expect_near(square.normal({{2.0, 0.0}}), {{half, -half}}, 1e-15);
  expect_near(square.normal({{1.0, 0.0}}), {{0.0, -1.0}}, 1e-15);
  expect_near(square.normal({{1.0, 0.1}}), {{0.0, -1.0}}, 1e-15);
  expect_near(square.normal({{-1.0, -1.0}}), {{-half, -half}}, 1e-15);
  expect_near(polygon(notched).normal({{2.0, 1.0}}), {{0.0, 1.0}}, 1e-15);
}

TEST(Outline, NormalsOfClosedOutlinesPointOut) {
  Points clockwise = cup;
  std::ranges::reverse(clockwise);
  for (const Outline& shape : {box({{-1.0, 0.5}}, {{2.0, 1.5}}), circle({{0.4, -0.3}}, 1.2), polygon(triangle),
                               polygon(notched), polygon(cup), polygon(clockwise)}) {
    EXPECT_GT(shape.volume(), 0.0);
    for (const OutlineEdge& edge : shape.edges()) {
      for (const double share : {0.1, 0.5, 0.9}) {
        EXPECT_TRUE(shape.contains(edge.at(share) - 1e-6 * edge.normal(share)));
        EXPECT_FALSE(shape.contains(edge.at(share) + 1e-6 * edge.normal(share)));
      }
    }
  }
}

TEST(Outline, PointsAtTheHeightOfCornersAreTold) {
  const Outline u = polygon(cup);
  for (const auto& [x, y, inside] :
       {std::tuple{0.5, 1.0, true}, std::tuple{1.5, 1.5, false}, std::tuple{2.5, 1.0, true},
        std::tuple{-0.5, 1.0, false}, std::tuple{-1.0, 2.0, false}, std::tuple{-1.0, 0.0, false},
        std::tuple{3.5, 1.0, false}})
    EXPECT_EQ(u.contains({{x, y}}), inside) << x << ", " << y;
  const Outline disc = circle({{0.0, 0.0}}, 1.0);
  EXPECT_TRUE(disc.contains({{0.0, 0.0}}));
  EXPECT_TRUE(disc.contains({{-0.999, 0.0}}));
  for (const Vector<2>& point : Points{{{-2.0, 0.0}}, {{-2.0, 1.0}}, {{-2.0, -1.0}}, {{1.001, 0.0}}})
    EXPECT_FALSE(disc.contains(point));
  EXPECT_NEAR(disc.distance({{0.0, 0.0}}), -1.0, 1e-15);
}

TEST(Outline, BoundsAreTheSmallest) {
  for (const Outline& shape : all_shapes()) {
    for (const double degrees : odd_angles) {
      const Outline turned = transformed(shape, turn(degrees));
      Vector<2> low{{infinity, infinity}}, high{{-infinity, -infinity}};
      for (const Vector<2>& point : samples(turned)) {
        for (int k = 0; k < 2; ++k) {
          low[k] = std::min(low[k], point[k]);
          high[k] = std::max(high[k], point[k]);
        }
      }
      expect_near(turned.bounds().low, low, 1e-5);
      expect_near(turned.bounds().high, high, 1e-5);
      for (int k = 0; k < 2; ++k) {
        EXPECT_LE(turned.bounds().low[k], low[k] + 1e-14);
        EXPECT_GE(turned.bounds().high[k], high[k] - 1e-14);
      }
    }
  }
}

TEST(Outline, ArcRunsFromItsFirstAngleToItsSecond) {
  const double half = std::sqrt(0.5);
  const Outline left = arc({{1.0, 0.0}}, 2.0, 0.0, 90.0);
  expect_near(left.edges()[0].at(0.5), {{1.0 + 2.0 * half, 2.0 * half}}, 1e-15);
  expect_near(left.edges()[0].normal(0.5), {{half, half}}, 1e-15);
  const Outline right = arc({{1.0, 0.0}}, 2.0, 90.0, 0.0);
  expect_near(right.edges()[0].begin, {{1.0, 2.0}}, 1e-15);
  expect_near(right.edges()[0].at(0.25), {{1.0 + 2.0 * std::sin(pi / 8.0), 2.0 * std::cos(pi / 8.0)}}, 1e-15);
  expect_near(right.edges()[0].normal(0.5), {{-half, -half}}, 1e-15);
  // Beyond its ends, the ends are nearest.
  EXPECT_NEAR(left.distance({{1.0, -1.0}}), std::sqrt(5.0), 1e-15);
  EXPECT_NEAR(left.distance({{0.0, 2.0}}), 1.0, 1e-15);
  EXPECT_NEAR(left.distance({{1.0, 0.0}}), 2.0, 1e-15);
  EXPECT_FALSE(left.contains({{1.5, 0.5}}));
}

TEST(Outline, EdgesInLineBecomeOne) {
  for (const double degrees : odd_angles) {
    const Transform<2> transform = turn(degrees);
    Points pieces;  // a square whose first point is in the middle of an edge
    for (int side = 0; side < 4; ++side) {
      const Vector<2> along = rotation(90.0 * side) * Vector<2>{{1.0, 0.0}};
      const Vector<2> middle = rotation(90.0 * side) * Vector<2>{{0.0, -1.0}};
      for (int k = 0; k < 100; ++k) pieces.push_back(transform(middle + ((k + 0.5) / 50.0 - 1.0) * along));
    }
    // The corners themselves are not among the points: each is cut off.
    const Outline cut = polygon(pieces);
    ASSERT_EQ(cut.edges().size(), 8U);
    for (const OutlineEdge& edge : cut.edges())
      EXPECT_TRUE(std::abs(edge.length() - 1.7 * 1.98) < 1e-12 || edge.length() < 0.1);
    Points line(pieces.begin(), pieces.begin() + 100);
    EXPECT_EQ(polyline(line).edges().size(), 1U);
    EXPECT_NEAR(polyline(line).length(), 1.7 * 1.98, 1e-12);
  }
  const Outline square = polygon({{{1.0, 0.0}}, {{2.0, 0.0}}, {{2.0, 2.0}}, {{0.0, 2.0}}, {{0.0, 0.0}}});
  EXPECT_EQ(square.edges().size(), 4U);
  EXPECT_EQ(square.volume(), 4.0);
  // A bend that is small but no error stays.
  EXPECT_EQ(polyline({{{0.0, 0.0}}, {{1.0, 1e-6}}, {{2.0, 0.0}}}).edges().size(), 2U);
}

TEST(Outline, PolygonsTurnCounterClockwise) {
  Points clockwise = triangle;
  std::ranges::reverse(clockwise);
  EXPECT_EQ(polygon(clockwise).volume(), 6.0);
  EXPECT_EQ(polygon(clockwise).edges()[0].begin, clockwise[0]);
}

TEST(Outline, FirstHitIsThatOfBruteForce) {
  for (const Outline& shape : all_shapes()) {
    const Points ends = random_points(shape.bounds(), 400);
    int hits = 0;
    for (std::size_t k = 0; k + 1 < ends.size(); k += 2) {
      const Vector<2>&from = ends[k], &to = ends[k + 1];
      const auto hit = shape.first_hit(from, to);
      // Along the segment the distance must not change sign, or pass through 0, before the hit.
      const double end = hit ? hit->share : 1.0;
      for (double share = 0.0; share < end - 1e-9; share += 0.01) {
        const Vector<2> point = from + share * (to - from);
        EXPECT_GT(shape.distance(point) * (shape.closed() && shape.contains(from) ? -1.0 : 1.0), 0.0);
      }
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(shape.distance(hit->point), 0.0, 1e-14);
      const OutlineEdge& edge = shape.edges()[hit->edge];
      expect_near(edge.nearest(hit->point), hit->point, 1e-14);
      expect_near(from + hit->share * (to - from), hit->point, 1e-14);
    }
    EXPECT_GT(hits, 30);
  }
}

TEST(Outline, NoSegmentPassesThroughACorner) {
  for (const double degrees : odd_angles) {
    const Outline shape = transformed(polygon(cup), turn(degrees));
    for (const OutlineEdge& edge : shape.edges()) {
      const Vector<2> out = shape.normal(edge.begin);
      for (const double angle : {-40.0, -7.0, 0.0, 3.0, 40.0}) {
        const Vector<2> way = rotation(angle) * out;
        const auto hit = shape.first_hit(edge.begin + 0.5 * way, edge.begin - 0.5 * way);
        ASSERT_TRUE(hit.has_value());
        EXPECT_LE(hit->share, 0.5 + 1e-12);
      }
    }
  }
}

TEST(Outline, TouchingAndRunningAlongAreHits) {
  const Outline square = box({{0.0, 0.0}}, {{1.0, 1.0}});
  expect_near(square.first_hit({{-1.0, 0.0}}, {{2.0, 0.0}})->point, {{0.0, 0.0}}, 1e-15);
  EXPECT_EQ(square.first_hit({{0.25, 0.0}}, {{0.75, 0.0}})->share, 0.0);
  EXPECT_EQ(square.first_hit({{0.5, 0.5}}, {{0.5, 0.0}})->share, 1.0);
  EXPECT_EQ(square.first_hit({{-1.0, 1.0}}, {{1.0, -1.0}})->point, (Vector<2>{{0.0, 0.0}}));  // the corner alone
  EXPECT_FALSE(square.first_hit({{-1.0, 0.0}}, {{-0.5, 0.0}}));
  EXPECT_FALSE(square.first_hit({{-1.0, 2.0}}, {{2.0, 2.0}}));
  EXPECT_FALSE(square.first_hit({{0.25, 0.25}}, {{0.75, 0.75}}));
  EXPECT_FALSE(square.first_hit({{0.5, 0.0}}, {{0.5, 0.0}}));  // no segment
  const Outline disc = circle({{0.0, 0.0}}, 1.0);
  EXPECT_DOUBLE_EQ(disc.first_hit({{-3.0, 0.0}}, {{3.0, 0.0}})->share, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(disc.first_hit({{0.0, 0.0}}, {{0.0, 2.0}})->share, 0.5);
  EXPECT_NEAR(disc.first_hit({{std::cos(0.3), std::sin(0.3)}}, {{0.0, 0.0}})->share, 0.0, 1e-15);
  EXPECT_FALSE(disc.first_hit({{-3.0, 0.0}}, {{-1.5, 0.0}}));
  EXPECT_FALSE(arc({{0.0, 0.0}}, 1.0, -80.0, 80.0).first_hit({{-3.0, 0.0}}, {{0.0, 0.0}}));
}

TEST(Outline, GapIsThatOfBruteForce) {
  const std::vector<Outline> shapes = all_shapes();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-5.0, 5.0), angle(0.0, 360.0), scale(0.2, 2.0);
  int apart = 0, meeting = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Outline& first = shapes[random() % shapes.size()];
    const Outline second = transformed(shapes[random() % shapes.size()],
                                       {scale(random), rotation(angle(random)), {}, {{shift(random), shift(random)}}});
    const Gap gap = narrowest_gap(first, second);
    EXPECT_NEAR(norm(gap.end - gap.begin), gap.width, 1e-15);
    EXPECT_NEAR(first.distance(gap.begin), 0.0, 1e-13);
    EXPECT_NEAR(second.distance(gap.end), 0.0, 1e-13);
    double nearest = infinity;
    for (const Vector<2>& point : samples(first, 500)) nearest = std::min(nearest, second.nearest(point).distance);
    EXPECT_LE(gap.width, nearest + 1e-13);
    EXPECT_NEAR(gap.width, nearest, 0.02);
    ++(gap.width > 0.0 ? apart : meeting);
    // The shortest connection of shapes that do not meet is a throat.
    const auto throat = narrowest_throat(first, second, 1e-9, [](const Gap&) { return true; });
    if (gap.width > 1e-9) {
      ASSERT_TRUE(throat);
      EXPECT_NEAR(throat->width, gap.width, 1e-13);
    }
  }
  EXPECT_GT(apart, 20);
  EXPECT_GT(meeting, 20);
}

TEST(Outline, GapsOfNestedAndTouchingShapes) {
  const Outline disc = circle({{0.0, 0.0}}, 1.0);
  EXPECT_DOUBLE_EQ(narrowest_gap(disc, circle({{0.0, 0.0}}, 1.5)).width, 0.5);
  EXPECT_DOUBLE_EQ(narrowest_gap(disc, circle({{0.25, 0.0}}, 1.5)).width, 0.25);
  EXPECT_DOUBLE_EQ(narrowest_gap(circle({{0.25, 0.0}}, 1.5), disc).width, 0.25);
  EXPECT_DOUBLE_EQ(narrowest_gap(disc, circle({{0.0, 4.0}}, 1.5)).width, 1.5);
  EXPECT_DOUBLE_EQ(narrowest_gap(box({{-2.0, -3.0}}, {{2.0, 3.0}}), disc).width, 1.0);
  EXPECT_DOUBLE_EQ(narrowest_gap(box({{0.0, 0.0}}, {{1.0, 1.0}}), box({{1.25, 0.5}}, {{2.0, 3.0}})).width, 0.25);
  EXPECT_EQ(narrowest_gap(box({{0.0, 0.0}}, {{1.0, 1.0}}), box({{1.0, 0.5}}, {{2.0, 3.0}})).width, 0.0);
  const Gap corners = narrowest_gap(box({{0.0, 0.0}}, {{1.0, 1.0}}), box({{4.0, 5.0}}, {{6.0, 6.0}}));
  EXPECT_EQ(corners.width, 5.0);
  EXPECT_EQ(corners.begin, (Vector<2>{{1.0, 1.0}}));
  EXPECT_EQ(corners.end, (Vector<2>{{4.0, 5.0}}));
}

TEST(Outline, ThroatsAreWhereOutlinesAreNearestAndNotInCorners) {
  const auto all = [](const Gap&) { return true; };
  const auto line = [](const std::vector<Vector<2>>& points) {
    std::vector<std::string> mistakes;
    return make_polyline(points, mistakes).value();
  };
  const Outline disc = circle({{0.0, 0.0}}, 1.0), floor = line({{{-9.0, -1.0}}, {{9.0, -1.0}}});
  EXPECT_FALSE(narrowest_throat(disc, floor, 1e-9, all));  // it lies on it
  EXPECT_NEAR(narrowest_throat(disc, line({{{-9.0, -1.5}}, {{9.0, -1.5}}}), 1e-9, all)->width, 0.5, 1e-15);
  EXPECT_FALSE(narrowest_throat(line({{{0.0, 0.0}}, {{0.0, 1.0}}}), line({{{0.0, 0.0}}, {{1.0, 1.0}}}), 1e-9, all));
  // Of several the narrowest that counts.
  const Outline comb = line({{{-9.0, -3.0}}, {{-5.0, -1.5}}, {{0.0, -3.0}}, {{5.0, -1.25}}, {{9.0, -3.0}}});
  EXPECT_DOUBLE_EQ(narrowest_throat(comb, floor, 1e-9, all)->width, 0.25);
  EXPECT_DOUBLE_EQ(narrowest_throat(comb, floor, 0.3, all)->width, 0.5);
  EXPECT_DOUBLE_EQ(narrowest_throat(floor, comb, 1e-9, [](const Gap& gap) { return gap.begin[0] < 0.0; })->width, 0.5);
  // Of an outline with itself.
  EXPECT_DOUBLE_EQ(narrowest_throat(disc, disc, 1e-9, all).value_or(Gap{}).width, infinity);
  const Outline block = box({{0.0, 0.0}}, {{1.0, 3.0}});
  EXPECT_DOUBLE_EQ(narrowest_throat(block, block, 1e-9, all)->width, 1.0);
  const Outline hook = arc({{0.0, 0.0}}, 1.0, 0.0, 330.0);
  EXPECT_NEAR(narrowest_throat(hook, hook, 1e-9, all)->width, 2.0 * std::sin(pi / 12.0), 1e-14);
}

TEST(Outline, RefusesPointsThatAreTheSame) {
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{1.0, 0.0}}, {{1.0, 0.0}}, {{0.0, 1.0}}, {{0.0, 1.0}}}),
            (Texts{"points 2 and 3 of the polygon are the same, (1, 0)",
                   "points 4 and 5 of the polygon are the same, "
                   "(0, 1)"}));
  EXPECT_EQ(mistakes_of_polygon({{{0.5, 0.0}}, {{1.0, 0.0}}, {{0.0, 1.0}}, {{0.5, 0.0}}}),
            Texts{"the last point of the polygon repeats the first, (0.5, 0); leave it out"});
  EXPECT_EQ(mistakes_of_polyline({{{0.5, 0.0}}, {{1.0, 0.0}}, {{0.0, 1.0}}, {{0.5, 0.0}}}),
            Texts{"the last point of the polyline is the first, (0.5, 0); a closed line is a polygon"});
  EXPECT_EQ(mistakes_of_polyline({{{2.0, 1.0}}, {{2.0, 1.0}}}),
            Texts{"points 1 and 2 of the polyline are the same, (2, 1)"});
}

TEST(Outline, RefusesTooFewPoints) {
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{1.0, 0.0}}}),
            Texts{"a polygon needs at least 3 points, but it has 2"});
  EXPECT_EQ(mistakes_of_polygon({}), Texts{"a polygon needs at least 3 points, but it has 0"});
  EXPECT_EQ(mistakes_of_polyline({{{0.0, 0.0}}}), Texts{"a polyline needs at least 2 points, but it has 1"});
}

TEST(Outline, RefusesAPolygonWithoutArea) {
  for (const double degrees : odd_angles) {
    Points line;
    for (const double x : {0.0, 1.0, 3.0, 2.0}) line.push_back(turn(degrees)({{x, 0.0}}));
    EXPECT_EQ(mistakes_of_polygon(line), Texts{"the points of the polygon lie on one line: it has no area"});
  }
}

TEST(Outline, NamesTheEdgesThatMeet) {
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{1.0, 1.0}}, {{1.0, 0.0}}, {{0.0, 1.0}}}),
            Texts{"the polygon meets itself: edge 1 from (0, 0) to (1, 1) and edge 3 from (1, 0) to (0, 1)"});
  // A corner on another edge.
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{2.0, 0.0}}, {{2.0, 2.0}}, {{1.0, 0.0}}, {{0.0, 2.0}}}).size(), 2U);
  // A spike that runs back over itself.
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{2.0, 0.0}}, {{2.0, 2.0}}, {{2.0, 1.0}}, {{0.0, 1.0}}}),
            (Texts{"the polygon meets itself: edge 2 from (2, 0) to (2, 2) and edge 3 from (2, 2) to (2, 1)",
                   "the polygon meets itself: edge 2 from (2, 0) to (2, 2) and edge 4 from (2, 1) to (0, 1)"}));
  EXPECT_EQ(mistakes_of_polyline({{{0.0, 0.0}}, {{2.0, 0.0}}, {{1.0, 0.0}}}),
            Texts{"the polyline meets itself: edge 1 from (0, 0) to (2, 0) and edge 2 from (2, 0) to (1, 0)"});
  EXPECT_EQ(mistakes_of_polyline({{{0.0, 0.0}}, {{2.0, 0.0}}, {{1.0, 1.0}}, {{1.0, -1.0}}}),
            Texts{"the polyline meets itself: edge 1 from (0, 0) to (2, 0) and edge 3 from (1, 1) to (1, -1)"});
  // The first edge and the last of a polygon are neighbours.
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{2.0, 0.0}}, {{2.0, 2.0}}, {{1.0, 2.0}}, {{1.0, 0.0}}}).size(), 2U);
  // Never a long list.
  Points star;
  for (int k = 0; k < 31; ++k) star.push_back(rotation(k * 13.0 * 360.0 / 31.0) * Vector<2>{{1.0, 0.0}});
  EXPECT_EQ(mistakes_of_polygon(star).size(), 5U);
}

TEST(Outline, RefusesBoxesCirclesAndArcsWithoutSize) {
  EXPECT_EQ(mistakes_of([](Texts& mistakes) {
              return make_box({{0.0, 1.0}}, {{0.0, 0.5}}, mistakes);
            }),
            (Texts{"the box has no width: it reaches from 0 to 0", "the box has no height: it reaches from 1 to 0.5"}));
  EXPECT_EQ(mistakes_of([](Texts& mistakes) { return make_circle({}, 0.0, mistakes); }),
            Texts{"the radius must be positive, but it is 0"});
  EXPECT_EQ(mistakes_of([](Texts& mistakes) { return make_arc({}, -1.0, 30.0, 390.0, mistakes); }),
            (Texts{"the radius must be positive, but it is -1",
                   "the arc from 30 to 390 degrees must be more than 0 and less than 360 degrees long"}));
  EXPECT_EQ(mistakes_of([](Texts& mistakes) { return make_arc({}, 1.0, 30.0, 30.0, mistakes); }).size(), 1U);
  EXPECT_EQ(mistakes_of([](Texts& mistakes) { return make_circle({}, std::nan(""), mistakes); }).size(), 1U);
  EXPECT_EQ(mistakes_of_polygon({{{0.0, 0.0}}, {{1.0, std::nan("")}}, {{1.0, 0.0}}}).size(), 1U);
}

TEST(Solids, DistancesOfASphere) {
  const Sphere sphere({{1.0, 2.0, 3.0}}, 0.5);
  EXPECT_DOUBLE_EQ(sphere.distance({{1.0, 2.0, 3.0}}), -0.5);
  EXPECT_DOUBLE_EQ(sphere.distance({{1.0, 2.0, 5.0}}), 1.5);
  EXPECT_EQ(sphere.normal({{1.0, 2.0, 5.0}}), (Vector<3>{{0.0, 0.0, 1.0}}));
  EXPECT_EQ(norm(sphere.normal({{1.0, 2.0, 3.0}})), 1.0);
  EXPECT_DOUBLE_EQ(sphere.volume(), pi / 6.0);
  EXPECT_EQ(sphere.bounds().high, (Vector<3>{{1.5, 2.5, 3.5}}));
}

TEST(Solids, DistancesOfABlock) {
  const Vector<3> axis = 1.0 / 3.0 * Vector<3>{{1.0, 2.0, 2.0}};
  const Transform<3> transform{2.0, rotation(axis, 50.0), {{1.0, 0.0, 2.0}}, {{0.0, -3.0, 0.0}}};
  const Block block({{{0.0, 0.0, 0.0}}, {{1.0, 2.0, 3.0}}}, transform);
  const Shape<3>& shape = block;
  EXPECT_DOUBLE_EQ(shape.volume(), 48.0);
  const auto check = [&](const Vector<3>& point, double distance, Vector<3> normal) {
    EXPECT_NEAR(shape.distance(transform(point)), 2.0 * distance, 1e-14);
    normal = 1.0 / norm(normal) * normal;
    EXPECT_NEAR(norm(shape.normal(transform(point)) - transform.rotation * normal), 0.0, 1e-12);
  };
  check({{0.1, 1.0, 1.5}}, -0.1, {{-1.0, 0.0, 0.0}});
  check({{0.5, 1.0, 3.5}}, 0.5, {{0.0, 0.0, 1.0}});
  check({{0.5, 1.0, 3.0}}, 0.0, {{0.0, 0.0, 1.0}});
  check({{-3.0, -4.0, 1.0}}, 5.0, {{-3.0, -4.0, 0.0}});
  check({{2.0, 4.0, 5.0}}, 3.0, {{1.0, 2.0, 2.0}});
  check({{1.0, 2.0, 3.0}}, 0.0, {{1.0, 1.0, 1.0}});  // a corner
  check({{1.0, 2.0, 1.0}}, 0.0, {{1.0, 1.0, 0.0}});  // on an edge
  EXPECT_TRUE(shape.contains(transform({{0.5, 1.0, 1.5}})));
  EXPECT_FALSE(shape.contains(transform({{0.5, -0.1, 1.5}})));

  Vector<3> low, high;
  low.component.fill(infinity);
  high.component.fill(-infinity);
  for (int corner = 0; corner < 8; ++corner) {
    const Vector<3> point = transform({{corner & 1 ? 1.0 : 0.0, corner & 2 ? 2.0 : 0.0, corner & 4 ? 3.0 : 0.0}});
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], point[k]);
      high[k] = std::max(high[k], point[k]);
    }
  }
  EXPECT_NEAR(norm(shape.bounds().low - low), 0.0, 1e-14);
  EXPECT_NEAR(norm(shape.bounds().high - high), 0.0, 1e-14);
}

TEST(Solids, DistancesOfAFrustum) {
  const Vector<3> axis = 1.0 / 3.0 * Vector<3>{{1.0, 2.0, 2.0}};
  const Transform<3> transform{1.0, rotation(axis, 50.0), {}, {{0.0, -3.0, 0.5}}};
  for (const auto& [radius, end_radius] :
       {std::pair(0.5, 0.5), std::pair(0.8, 0.3), std::pair(0.0, 0.6), std::pair(0.7, 0.0)}) {
    const Frustum frustum(transform({}), transform({{0.0, 0.0, 1.0}}), radius, end_radius);
    EXPECT_NEAR(frustum.volume(), pi / 3.0 * (radius * radius + radius * end_radius + end_radius * end_radius), 1e-14);
    // Its surface by points: the mantle, and the discs.
    std::vector<Vector<3>> surface;
    constexpr int rings = 60, turn = 180;
    for (int k = 0; k < turn; ++k) {
      const auto [cosine, sine] = cosine_and_sine(k * 360.0 / turn);
      const auto add = [&](double r, double z) { surface.push_back(transform({{r * cosine, r * sine, z}})); };
      for (int ring = 0; ring <= rings; ++ring) {
        const double share = static_cast<double>(ring) / rings;
        add(radius + share * (end_radius - radius), share);
        add(share * radius, 0.0);
        add(share * end_radius, 1.0);
      }
    }
    const Box<3> bounds = frustum.bounds();
    Box<3> found{surface.front(), surface.front()};
    for (const Vector<3>& point : surface) {
      EXPECT_NEAR(frustum.distance(point), 0.0, 1e-12);
      for (int k = 0; k < 3; ++k) {
        found.low[k] = std::min(found.low[k], point[k]);
        found.high[k] = std::max(found.high[k], point[k]);
      }
    }
    EXPECT_NEAR(norm(bounds.low - found.low), 0.0, 1e-3);
    EXPECT_NEAR(norm(bounds.high - found.high), 0.0, 1e-3);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> across(-1.5, 1.5), along(-1.0, 2.0);
    for (int k = 0; k < 200; ++k) {
      const Vector<3> place{{across(random), across(random), along(random)}}, point = transform(place);
      double nearest = infinity;
      for (const Vector<3>& other : surface) nearest = std::min(nearest, norm(point - other));
      const bool inside = place[2] > 0.0 && place[2] < 1.0 &&
                          std::hypot(place[0], place[1]) < radius + place[2] * (end_radius - radius);
      EXPECT_EQ(frustum.contains(point), inside);
      const double distance = frustum.distance(point);
      EXPECT_NEAR(std::abs(distance), nearest, 2e-3 + 2e-3 * (nearest < 0.1));
      // Along the normal, the surface is where the distance says.
      const Vector<3> normal = frustum.normal(point);
      EXPECT_NEAR(norm(normal), 1.0, 1e-12);
      EXPECT_NEAR(frustum.distance(point - distance * normal), 0.0, 1e-9);
    }
    EXPECT_NEAR(norm(frustum.normal(transform({{0.0, 0.0, 0.5}}))), 1.0, 1e-12);  // on the axis
  }
}

}  // namespace
}  // namespace impinge
