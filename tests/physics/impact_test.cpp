// Sudden changes: the first moment of a dam break, and a block that hits a floor.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "impinge/cases/make_simulation.hpp"
#include "shipped_case.hpp"

namespace impinge {
namespace {

using std::numbers::pi;

const MPI_Comm comm = MPI_COMM_WORLD;

/// Sums term(m) over the odd m.
template <class Term>
double sum_over_odd(Term&& term) {
  double sum = 0.0;
  for (int m = 1; m < 400; m += 2) sum += term(m);
  return sum;
}

// The column of the case is a = 1 m long and H = 0.5 m high, and its front face free: laplacian p = 0, p_y = -rho g on
// the floor, p_x = 0 on the wall, else p = 0.
TEST(DamBreak, StartsWithTheExactPressure) {
  constexpr double length = 1.0, height = 0.5;
  const Case config = shipped_case("dam-break-start/dam-break-start.toml", {"particles.spacing=0.025"});
  auto simulation = make_simulation<2>(comm, config);
  simulation.step();
  const Particles<2>& particles = simulation.particles();
  const double unit = config.fluid.density * 9.81 * height;
  double square = 0.0, count = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::fluid) continue;
    const Vector<2> place = particles.position[i];
    const double exact = sum_over_odd([&](int m) {
      const double rate = m * pi / (2.0 * length);
      return (m % 4 == 1 ? 8.0 : -8.0) * length / std::pow(m * pi, 2) / height * std::cos(rate * place[0]) *
             std::sinh(rate * (height - place[1])) / std::cosh(rate * height);
    });
    square += std::pow(particles.pressure[i] / unit - exact, 2);
    count += 1.0;
  }
  const double error = std::sqrt(sum_over_ranks(comm, square) / sum_over_ranks(comm, count));
  if (rank_of(comm) == 0) fmt::print("  RMS error {:.5f} rho g H\n", error);
  EXPECT_LT(error, 0.01);
}

// E. g. Marrone et al., Eur. J. Mech. B 49 (2015) 332: 8/pi^3 L/H sum over odd n of tanh(n pi H/L)/n^3 of the energy is
// lost.
TEST(Block, LosesTheExactShareOfItsEnergyOnAFloor) {
  const Case config = shipped_case("block/block.toml", {"particles.spacing=0.025", "time.dt=2.5e-3", "time.end=0.05"});
  auto simulation = make_simulation<2>(comm, config);
  const double before = simulation.report().kinetic_energy;
  while (simulation.report().time < config.time.end - 1e-9) simulation.step();
  const double lost = 1.0 - simulation.report().kinetic_energy / before;
  const double exact =
      8.0 / std::pow(pi, 3) * 2.0 * sum_over_odd([](int n) { return std::tanh(0.5 * n * pi) / std::pow(n, 3); });
  if (rank_of(comm) == 0) fmt::print("  lost {:.4f} of the energy, exact {:.4f}\n", lost, exact);
  EXPECT_NEAR(exact, 0.5, 1e-6);
  EXPECT_NEAR(lost, exact, 0.02);
}

}  // namespace
}  // namespace impinge
