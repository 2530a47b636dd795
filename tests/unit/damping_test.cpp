// Zones that damp waves.

#include "impinge/method/damping.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "impinge/config/case_file.hpp"
#include "impinge/core/errors.hpp"

namespace impinge {
namespace {

using Texts = std::vector<std::string>;

DampingSettings zone(const Numbers& direction) {
  return {.name = "beach", .low = {2, 0, 0}, .high = {4, 1, 1}, .strength = 5.0, .direction = direction};
}

TEST(Damping, RisesAsTheSquareOfTheWayInItsDirection) {
  const DampingZones<2> right({zone({3, 0})});
  EXPECT_EQ(right.rate({{2.0, 0.5}}), 0.0);
  EXPECT_NEAR(right.rate({{3.0, 0.1}}), 1.25, 1e-12);
  EXPECT_NEAR(right.rate({{4.0, 0.9}}), 5.0, 1e-12);
  EXPECT_EQ(right.rate({{4.1, 0.5}}), 0.0);
  EXPECT_EQ(right.rate({{3.0, 1.1}}), 0.0);
  const DampingZones<2> left({zone({-1, 0})});
  EXPECT_NEAR(left.rate({{2.5, 0.5}}), 5.0 * 0.75 * 0.75, 1e-12);
  // Slanted: from one corner to the opposite one.
  const DampingZones<3> slanted({zone({1, 1, -1})});
  EXPECT_NEAR(slanted.rate({{2.0, 0.0, 1.0}}), 0.0, 1e-12);
  EXPECT_NEAR(slanted.rate({{3.0, 0.5, 0.5}}), 1.25, 1e-12);
  EXPECT_NEAR(slanted.rate({{4.0, 1.0, 0.0}}), 5.0, 1e-12);
}

TEST(Damping, WithoutADirectionIsTheSameEverywhereAndAddsUp) {
  const DampingZones<2> both({zone({0, 0}), zone({1, 0})});
  EXPECT_NEAR(both.rate({{3.0, 0.5}}), 5.0 + 1.25, 1e-12);
  EXPECT_TRUE(DampingZones<2>({}).empty());
  EXPECT_EQ(DampingZones<2>({}).rate({{3.0, 0.5}}), 0.0);
}

TEST(Damping, SlowsDownExponentiallyWhateverTheStep) {
  const DampingZones<2> zones({zone({0, 0})});
  Vector<2> velocity{{2.0, -1.0}};
  for (int step = 0; step < 10; ++step) velocity += zones.velocity_change({{3.0, 0.5}}, velocity, 0.02);
  EXPECT_NEAR(velocity[0], 2.0 * std::exp(-1.0), 1e-12);
  EXPECT_NEAR(velocity[1], -std::exp(-1.0), 1e-12);
  EXPECT_NEAR(norm(velocity + zones.velocity_change({{3.0, 0.5}}, velocity, 1e6)), 0.0, 1e-12);
  EXPECT_EQ(zones.velocity_change({{1.0, 0.5}}, velocity, 0.1), Vector<2>{});
}

Texts mistakes_in(const std::string& text) {
  int dimension = 2;
  std::vector<DampingSettings> zones;
  Keys keys(dimension);
  keys.add("dimension", dimension, "of space");
  declare_damping(keys, zones);
  read_files(keys, {{"case.toml", text}}, {});
  derive_damping(keys, zones);
  check_damping(keys, dimension, zones);
  try {
    keys.throw_mistakes();
  } catch (const InputError& error) {
    return error.mistakes();
  }
  return {};
}

TEST(Damping, MistakesAreToldAtOnce) {
  EXPECT_EQ(mistakes_in("[[damping]]\nlow = [0, 0]\nhigh = [1, 1]\nstrength = 2\n"), Texts{});
  EXPECT_EQ(
      mistakes_in("[[damping]]\nname = \"a\"\nlow = [0, 0]\nhigh = [1, 0]\nstrength = 2\n"
                  "[[damping]]\nname = \"a\"\nlow = [0, 0]\nhigh = [1, 1]\nstrength = 0\n"),
      (Texts{"case.toml:4: damping[1].high = [1.0, 0.0]: not above the low corner along every axis; allowed: above "
             "0.0 (m) along y",
             "case.toml:7: damping[2].name = \"a\": the name is used twice, first at case.toml:2; allowed: a name "
             "of its own",
             "case.toml:10: damping[2].strength = 0: out of range; allowed: > 0 (1/s)"}));
}

}  // namespace
}  // namespace impinge
