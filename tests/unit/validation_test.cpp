// The measures of a run, on particles laid out on the analytic jet and displaced from it by known amounts; the report
// on a directory.

#include "impinge/validation/validation.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mpi.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "impinge/io/run_directory.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
using Side = AnalyticJet::Side;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double window = 0.5;  // of the wall average [s]
constexpr std::int64_t step = 1000;

Case jet_case(double angle, double spacing = 0.01, const std::string& more = "") {
  return parse_case({{"exact.toml", fmt::format(R"(geometry = "jet"
jet.width = 0.4
jet.speed = 1.5
jet.angle = {:.1f}
particles.spacing = {}
time.end = 2.0
time.dt = 1e-4
{})",
                                                angle, spacing, more)}});
}

/// Wall particles, and fluid on a square lattice inside the analytic jet up to the inlet, with the analytic velocity
/// and pressure. Every column of the lattice is shifted in height by another fraction of the spacing, so that counting
/// particles measures a thickness to much less than the spacing.
Particles<2> exact_state(const Case& config) {
  const AnalyticJet jet = analytic_jet(jet_target(config));
  const double dp = config.particles.spacing;
  Particles<2> particles;
  const auto columns = std::lround((config.plate.end - config.plate.begin) / dp);
  for (std::int64_t column = 0; column < columns; ++column) {
    const double x = config.plate.begin + (static_cast<double>(column) + 0.5) * dp;
    const double pressure = jet.wall_pressure(x);
    particles.append({{{x, -0.5 * dp}}, {}, pressure, pressure * window, particles.owned, ParticleType::wall});
    particles.append({{{x, -1.5 * dp}}, {}, 0.0, 0.0, particles.owned, ParticleType::ghost});
    const double shift = std::fmod(static_cast<double>(column) * 0.6180339887498949, 1.0);
    for (double y = shift * dp; y < 3.0 * config.jet.width; y += dp)
      if (const auto state = jet.state({{x, y}}))
        particles.append({{{x, y}}, state->velocity, state->pressure, 0.0, particles.owned, ParticleType::fluid});
  }
  return particles;
}

/// Free-surface particles that lie `outward` [m] further out than half a spacing below the analytic surface.
void append_surface(const Case& config, double outward, Particles<2>& particles) {
  const AnalyticJet jet = analytic_jet(jet_target(config));
  const double dp = config.particles.spacing;
  for (const Side side : {Side::h1, Side::h2}) {
    for (const Vector<2>& point : jet.surface(side, config.jet.width, 2.0 * config.jet.width, dp)) {
      const auto surface = jet.nearest_surface(point);
      const double sign = side == Side::h1 ? 1.0 : -1.0;  // the fluid lies to the right or left of the stream
      const Vector<2> inward = (sign / jet.speed()) * Vector<2>{{surface.velocity[1], -surface.velocity[0]}};
      const Vector<2> position = point + (0.5 * dp - outward) * inward;
      const auto state = jet.state(position);
      particles.append({position, state ? state->velocity : surface.velocity, state ? state->pressure : 0.0, 0.0,
                        particles.owned, ParticleType::fluid});
      particles.free_surface.back() = 1;
    }
  }
}

/// Applies `change` to the index of every fluid particle.
void change_fluid(Particles<2>& particles, const std::function<void(std::size_t)>& change) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::fluid) change(i);
}

JetMetrics compare(const Case& config, const std::vector<Particles<2>>& snapshots) {
  JetComparison comparison(jet_target(config));
  comparison.set_wall_average(snapshots.back(), window);
  for (const auto& snapshot : snapshots) comparison.add_snapshot(snapshot);
  return comparison.metrics();
}

class ExactJet : public testing::TestWithParam<double> {
 protected:
  Case config = jet_case(GetParam());
  AnalyticJet jet = analytic_jet(jet_target(config));
  Particles<2> particles = exact_state(config);
};
INSTANTIATE_TEST_SUITE_P(Angles, ExactJet, testing::Values(30.0, 60.0, 90.0));

TEST_P(ExactJet, HasNoError) {
  append_surface(config, 0.0, particles);
  const JetMetrics metrics = compare(config, {particles, particles});
  EXPECT_NEAR(metrics.wall_l2.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.force_ratio.value(), 1.0, 2e-3);  // the plate is finite
  EXPECT_NEAR(metrics.peak_x.value(), 0.0, 0.51 * config.particles.spacing);
  EXPECT_EQ(metrics.peak_pressure.value(), jet.wall_pressure(metrics.peak_x.value()));
  const double beside = 0.5 * config.particles.spacing;  // the two wall particles at the stagnation point
  EXPECT_NEAR(metrics.stagnation_mean.value(), 0.5 * (jet.wall_pressure(-beside) + jet.wall_pressure(beside)), 1e-9);
  EXPECT_EQ(metrics.stagnation_scatter.value(), 0.0);
  EXPECT_NEAR(metrics.field_l2.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.mean_field_l2.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.velocity_rms.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.surface_rms_dp.value(), 0.0, 1e-6);
}

TEST_P(ExactJet, HasTheAnalyticFilms) {
  JetComparison comparison(jet_target(config));
  comparison.add_snapshot(particles);
  const JetMetrics metrics = comparison.metrics();
  const double least = 0.1 * config.particles.spacing;  // thickness that counting particles can tell [m]
  EXPECT_NEAR(metrics.film_h1.value(), comparison.analytic_film(Side::h1).value(),
              least / jet.sheet_thickness(Side::h1));
  EXPECT_NEAR(metrics.film_h2.value(), comparison.analytic_film(Side::h2).value(),
              least / jet.sheet_thickness(Side::h2));
  // The sheets have nearly reached their far thickness.
  EXPECT_GT(comparison.analytic_film(Side::h1).value(), 1.005);
  EXPECT_LT(comparison.analytic_film(Side::h1).value(), 1.04);
  EXPECT_NEAR(comparison.analytic_film(Side::h2).value(), 1.0, 1e-3);

  const auto profile = comparison.film_profile();
  ASSERT_GT(profile.size(), 50u);
  EXPECT_LT(profile.front().x, -2.0 * config.jet.width);
  EXPECT_GT(profile.back().x, 4.0 * config.jet.width);
  for (const FilmColumn& column : profile) {
    const auto film = jet.film(column.x);
    ASSERT_TRUE(film) << column.x;
    EXPECT_DOUBLE_EQ(column.analytic, film->top);
    if (std::abs(column.x) > config.jet.width) {  // where the surface is steep a column's middle is not its mean
      EXPECT_NEAR(column.thickness, column.analytic, 1.5 * config.particles.spacing) << column.x;
    }
  }
}

TEST_P(ExactJet, FilmsFollowTheNumberOfParticlesInTheirStretches) {
  const double width = config.jet.width, thin = jet.plate_position_of_cp(0.01, Side::h2);
  const auto in_h1 = [&](double x) { return x >= 1.5 * width && x < 3.0 * width; };
  const auto in_h2 = [&](double x) { return x >= thin - width && x < thin - 0.5 * width; };
  const auto with_twice = [&](const std::function<bool(double)>& chosen) {
    auto doubled = particles;
    for (int i = 0; i < particles.owned; ++i) {
      const auto record = particles.record(i);
      if (record.type == ParticleType::fluid && chosen(record.position[0])) doubled.append(record);
    }
    return compare(config, {doubled});
  };
  const JetMetrics exact = compare(config, {particles});
  EXPECT_NEAR(with_twice(in_h1).film_h1.value(), 2.0 * exact.film_h1.value(), 1e-12);
  EXPECT_EQ(with_twice(in_h1).film_h2.value(), exact.film_h2.value());
  EXPECT_NEAR(with_twice(in_h2).film_h2.value(), 2.0 * exact.film_h2.value(), 1e-12);
  EXPECT_EQ(with_twice(in_h2).film_h1.value(), exact.film_h1.value());
  const JetMetrics elsewhere = with_twice([&](double x) { return !in_h1(x) && !in_h2(x); });
  EXPECT_EQ(elsewhere.film_h1.value(), exact.film_h1.value());
  EXPECT_EQ(elsewhere.film_h2.value(), exact.film_h2.value());
  // Over snapshots it is the mean.
  EXPECT_NEAR(compare(config, {particles, particles}).film_h1.value(), exact.film_h1.value(), 1e-12);
}

TEST_P(ExactJet, WallErrorCountsWhereThereIsPressure) {
  const double small = 1e-3 * jet.stagnation_pressure();
  double reference = 0.0, made = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    const double exact = jet.wall_pressure(particles.position[i][0]);
    if (exact <= small) {
      particles.pressure_impulse[i] = 300.0 * window;
    } else {
      reference += exact * exact;
      if (exact > 10.0 * small) continue;
      particles.pressure_impulse[i] += 50.0 * window;
      made += 50.0 * 50.0;
    }
  }
  EXPECT_NEAR(compare(config, {particles}).wall_l2.value(), std::sqrt(made / reference), 1e-12);
}

TEST_P(ExactJet, PressureErrorsComeOutAsMade) {
  auto wrong = particles;
  for (double& pressure : wrong.pressure) pressure *= 1.1;
  for (double& impulse : wrong.pressure_impulse) impulse *= 1.1;
  const JetMetrics exact = compare(config, {particles});
  const JetMetrics metrics = compare(config, {wrong, wrong});
  EXPECT_NEAR(metrics.wall_l2.value(), 0.1, 1e-12);
  EXPECT_NEAR(metrics.force_ratio.value(), 1.1 * exact.force_ratio.value(), 1e-12);
  EXPECT_NEAR(metrics.peak_pressure.value(), 1.1 * exact.peak_pressure.value(), 1e-9);
  EXPECT_NEAR(metrics.field_l2.value(), 0.1, 1e-12);
  EXPECT_NEAR(metrics.mean_field_l2.value(), 0.1, 1e-12);
  EXPECT_NEAR(metrics.velocity_rms.value(), 0.0, 1e-12);
}

TEST_P(ExactJet, PressureErrorsOfSnapshotsAverageOut) {
  auto high = particles, low = particles;
  for (double& pressure : high.pressure) pressure *= 1.2;
  for (double& pressure : low.pressure) pressure *= 0.8;
  const JetMetrics metrics = compare(config, {high, low});
  EXPECT_NEAR(metrics.field_l2.value(), 0.2, 1e-12);
  EXPECT_NEAR(metrics.mean_field_l2.value(), 0.0, 1e-12);
  const double exact = compare(config, {particles}).stagnation_mean.value();
  EXPECT_NEAR(metrics.stagnation_mean.value(), exact, 1e-9);
  EXPECT_NEAR(metrics.stagnation_scatter.value(), 0.2 * std::sqrt(2.0) * exact, 1e-9);
  EXPECT_FALSE(compare(config, {high}).stagnation_scatter);  // one value does not scatter
}

TEST_P(ExactJet, VelocityErrorsComeOutAsMade) {
  change_fluid(particles, [&](std::size_t i) { particles.velocity[i] += jet.speed() * Vector<2>{{0.03, -0.04}}; });
  const JetMetrics metrics = compare(config, {particles});
  EXPECT_NEAR(metrics.velocity_rms.value(), 0.05, 1e-12);
  EXPECT_NEAR(metrics.field_l2.value(), 0.0, 1e-12);
}

TEST_P(ExactJet, SurfaceErrorsComeOutAsMade) {
  const double dp = config.particles.spacing;
  for (const double displacement : {-0.5, 0.25, 1.0, 3.0}) {
    Particles<2> surface = exact_state(config);
    append_surface(config, displacement * dp, surface);
    const JetMetrics metrics = compare(config, {surface});
    // Inside the tight corner of the thin sheet another piece of the surface may be nearer.
    EXPECT_NEAR(metrics.surface_rms_dp.value(), std::abs(displacement), displacement < 0.0 ? 1e-2 : 1e-6);
    EXPECT_NEAR(metrics.velocity_rms.value(), 0.0, 1e-8) << "outside, the velocity is that of the surface";
  }
}

TEST_P(ExactJet, ParticlesOutsideTheFluidHaveAnalyticPressureZero) {
  double reference = 0.0;
  change_fluid(particles, [&](std::size_t i) {
    if (std::abs(particles.position[i][0] / config.jet.width - 1.0) <= 3.0)
      reference += std::pow(particles.pressure[i], 2);
  });
  const Vector<2> outside{{3.0 * config.jet.width, 2.0 * config.jet.width}};
  ASSERT_FALSE(jet.contains(outside));
  particles.append({outside, jet.nearest_surface(outside).velocity, 700.0, 0.0, particles.owned, ParticleType::fluid});
  const JetMetrics metrics = compare(config, {particles});
  EXPECT_NEAR(metrics.field_l2.value(), 700.0 / std::sqrt(reference), 1e-9);
  EXPECT_NEAR(metrics.velocity_rms.value(), 0.0, 1e-12);
}

TEST_P(ExactJet, ParticlesFarFromTheStagnationPointDoNotCount) {
  const auto exact = compare(config, {particles});
  change_fluid(particles, [&](std::size_t i) {
    const double x = particles.position[i][0] / config.jet.width;
    if (x >= -2.0 && x <= 4.0) return;
    particles.pressure[i] = 1e5;
    particles.velocity[i] = {{7.0, 7.0}};
    particles.free_surface[i] = 1;
  });
  append_surface(config, 0.0, particles);
  const JetMetrics metrics = compare(config, {particles});
  EXPECT_NEAR(metrics.field_l2.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.velocity_rms.value(), 0.0, 1e-12);
  EXPECT_NEAR(metrics.surface_rms_dp.value(), 0.0, 1e-6);
  EXPECT_FALSE(exact.surface_rms_dp);  // nothing is flagged
}

TEST_P(ExactJet, NumbersThatAreNotFiniteGiveNoMetric) {
  const std::size_t last = static_cast<std::size_t>(particles.owned) - 1;
  ASSERT_EQ(particles.type[last], ParticleType::fluid);
  const std::function<void(Particles<2>&)> spoil[] = {
      [&](Particles<2>& p) {
        p.position[last] = {{nan, 0.1}};
      },
      [&](Particles<2>& p) {
        p.velocity[last] = {{0.0, nan}};
      },
      [&](Particles<2>& p) { p.pressure[last] = std::numeric_limits<double>::infinity(); },
  };
  for (const auto& change : spoil) {
    auto wrong = particles;
    change(wrong);
    const JetMetrics metrics = compare(config, {particles, wrong});
    for (const auto& metric : {metrics.field_l2, metrics.mean_field_l2, metrics.velocity_rms, metrics.surface_rms_dp,
                               metrics.film_h1, metrics.film_h2})
      EXPECT_FALSE(metric);
    EXPECT_TRUE(metrics.wall_l2 && metrics.force_ratio && metrics.peak_x && metrics.stagnation_mean);
  }
  auto wrong = particles;
  ASSERT_EQ(wrong.type[0], ParticleType::wall);
  wrong.pressure_impulse[0] = nan;
  const JetMetrics metrics = compare(config, {wrong});
  EXPECT_FALSE(metrics.force_ratio || metrics.peak_pressure || metrics.peak_x);
  EXPECT_TRUE(metrics.field_l2);
}

TEST(JetComparison, PlateThatEndsBeforeTheFilmsGivesNone) {
  const Case config = jet_case(60.0, 0.02, "plate.begin = -0.6\nplate.end = 0.58\n");
  JetComparison comparison(jet_target(config));
  comparison.add_snapshot(exact_state(config));
  EXPECT_FALSE(comparison.metrics().film_h1);
  EXPECT_FALSE(comparison.metrics().film_h2);
  EXPECT_FALSE(comparison.analytic_film(Side::h1));
}

TEST(JetComparison, WithoutDataThereIsNoMetric) {
  const JetMetrics metrics = JetComparison(jet_target(jet_case(60.0))).metrics();
  EXPECT_FALSE(metrics.wall_l2 || metrics.force_ratio || metrics.peak_x || metrics.stagnation_mean ||
               metrics.field_l2 || metrics.film_h1);
}

/// A directory of a run, removed at the end.
class RunDirectory : public testing::Test {
 protected:
  RunDirectory() { fs::create_directories(directory); }
  ~RunDirectory() override { fs::remove_all(directory); }

  std::string save(const Case& of, std::int64_t at_step, double time, const Particles<2>& state,
                   const std::string& status = "running", double window_end = 0.0) {
    const std::string path = snapshot_path(directory, of.name, at_step);
    write_snapshot(MPI_COMM_SELF, path, state,
                   {.dimension = 2,
                    .step = at_step,
                    .time = time,
                    .dt = 1e-4,
                    .window_begin = window_end > 0.0 ? window_end - window : 0.0,
                    .window_end = window_end,
                    .status = status,
                    .message = status == "failed" ? "step 1000, phase pressure: no convergence" : "",
                    .case_text = of.resolved_text,
                    .code_version = {}});
    return path;
  }

  void write_history(std::int64_t at_step, std::int64_t in, std::int64_t out, std::int64_t stored) {
    std::ofstream file(directory + "/" + config.name + "_history.csv");
    file << "step,t,dt,limit,particles,fluid,in,out,lost\n"
         << "1,1e-4,1e-4,case,1,1,1,0,0\n"
         << fmt::format("{},2.0,1e-4,case,9,{},{},{},0\n", at_step, stored, in, out);
  }

  template <class Error>
  std::string error_of(const SnapshotSelection& selection = {}) {
    try {
      validate(directory, selection);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  std::string directory = (fs::temp_directory_path() / fmt::format("impinge_validation_{}", getpid())).string();
  Case config = jet_case(60.0, 0.02);
  Particles<2> particles = exact_state(config);
  std::int64_t fluid = std::count(particles.type.begin(), particles.type.end(), ParticleType::fluid);
};

TEST_F(RunDirectory, WindowChoosesTheSnapshots) {
  auto early = particles;
  for (double& pressure : early.pressure) pressure *= 3.0;
  save(config, 500, 1.0, early);
  save(config, 800, 1.6, particles, "running", 1.6);
  save(config, step, 2.0, particles, "finished", 2.0);
  const Validation validation = validate(directory);
  EXPECT_EQ(validation.times, (std::vector{1.6, 2.0}));
  EXPECT_EQ(validation.window.value().begin, 1.5);
  EXPECT_NEAR(validation.metrics.wall_l2.value(), 0.0, 1e-12);
  EXPECT_NEAR(validation.metrics.field_l2.value(), 0.0, 1e-12);
  EXPECT_FALSE(validation.particle_balance);

  EXPECT_NEAR(validate(directory, {.from = {}, .to = 1.2}).metrics.field_l2.value(), 2.0, 1e-12);
  EXPECT_NEAR(validate(directory, {.from = 0.9, .to = 1.7}).metrics.field_l2.value(), 1.0, 1e-12);
  EXPECT_NE(error_of<InputError>({.from = 1.1, .to = 1.2}).find("between 1.1 s and 1.2 s"), std::string::npos);
}

TEST_F(RunDirectory, BalanceIsTheHistorysAgainstTheLastSnapshot) {
  save(config, step, 2.0, particles, "finished", 2.0);
  write_history(step, fluid + 5, 5, -77);
  EXPECT_EQ(validate(directory).particle_balance.value(), 0);
  write_history(step, fluid + 5, 2, -77);
  EXPECT_EQ(validate(directory).particle_balance.value(), 3);
  write_history(step + 1, 20, 4, 15);  // of another step: the history's own count
  EXPECT_EQ(validate(directory).particle_balance.value(), 1);
  std::ofstream(directory + "/" + config.name + "_history.csv") << "step,in,out,lost\n1,2,3,0\n";
  EXPECT_NE(error_of<FileError>().find("'fluid'"), std::string::npos);
  const std::string history = directory + "/" + config.name + "_history.csv";
  fs::remove(history);
  ASSERT_EQ(mkfifo(history.c_str(), 0600), 0);  // nobody writes into it
  EXPECT_FALSE(validate(directory).particle_balance);
}

TEST_F(RunDirectory, FailedRunIsReportedWithoutNumbersThatAreNotFinite) {
  change_fluid(particles, [&](std::size_t i) { particles.position[i] = particles.velocity[i] = {{nan, nan}}; });
  save(config, step, 0.3, particles, "failed");
  const Validation validation = validate(directory);
  write_report(validation, directory + "/validation");

  std::ifstream file(directory + "/validation/validation.json");
  const auto report = nlohmann::json::parse(file);
  EXPECT_EQ(report["status"], "failed");
  EXPECT_EQ(report["message"], "step 1000, phase pressure: no convergence");
  EXPECT_TRUE(report["window"].is_null());
  EXPECT_EQ(report["snapshots"]["count"], 1);
  for (const char* key : {"wall_l2", "force_ratio", "peak_pressure", "peak_x", "field_l2", "mean_field_l2",
                          "velocity_rms", "surface_rms_dp", "film_h1", "film_h2", "particle_balance"}) {
    ASSERT_TRUE(report["metrics"].contains(key)) << key;
    EXPECT_TRUE(report["metrics"][key].is_null()) << key;
  }
  const std::string table = to_table(validation);
  EXPECT_NE(table.find("no convergence"), std::string::npos);
  EXPECT_EQ(table.find("nan"), std::string::npos);
  EXPECT_NE(table.find("film_h1                     -"), std::string::npos) << table;
}

TEST_F(RunDirectory, ReportHoldsMetricsAndProfiles) {
  append_surface(config, 0.0, particles);
  fluid = std::count(particles.type.begin(), particles.type.end(), ParticleType::fluid);
  save(config, step, 2.0, particles, "finished", 2.0);
  write_history(step, fluid, 0, fluid);
  const Validation validation = validate(directory);
  write_report(validation, directory + "/validation");
  std::ifstream file(directory + "/validation/validation.json");
  const auto report = nlohmann::json::parse(file);
  EXPECT_EQ(report["case"], "exact");
  EXPECT_NEAR(report["parameters"]["angle"].get<double>(), 60.0, 1e-12);
  EXPECT_NEAR(report["parameters"]["width_over_spacing"].get<double>(), 20.0, 1e-12);
  EXPECT_EQ(report["last_snapshot"], "exact_00001000.vtkhdf");
  EXPECT_EQ(report["window"]["end"], 2.0);
  EXPECT_EQ(report["metrics"]["film_h1"], validation.metrics.film_h1.value());
  EXPECT_EQ(report["metrics"]["particle_balance"], 0);

  // The lines of the analytic jet that the figures show lie where they should.
  const AnalyticJet jet = analytic_jet(jet_target(config));
  const auto rows_of = [&](const char* name) {
    std::ifstream table(directory + "/validation/" + name);
    std::string line;
    std::getline(table, line);
    std::vector<std::array<double, 3>> rows;
    while (std::getline(table, line)) {
      std::array<double, 3> row{};
      EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &row[0], &row[1], &row[2]), 3) << line;
      rows.push_back(row);
    }
    return rows;
  };
  const auto isobars = rows_of("isobars.csv"), surface = rows_of("surface.csv"), wall = rows_of("wall_pressure.csv"),
             film = rows_of("film_thickness.csv");
  ASSERT_GT(isobars.size(), 500u);
  for (const auto& [cp, x, y] : isobars) {
    const auto state = jet.state({{x, std::max(y, 0.0)}});
    ASSERT_TRUE(state);
    EXPECT_NEAR(state->pressure, cp * jet.stagnation_pressure(), 1e-4 * jet.stagnation_pressure());
  }
  ASSERT_GT(surface.size(), 100u);
  for (const auto& [sheet, x, y] : surface) EXPECT_NEAR(jet.nearest_surface({{x, y}}).depth, 0.0, 1e-8);
  EXPECT_EQ(wall.size(), std::lround((config.plate.end - config.plate.begin) / config.particles.spacing));
  for (const auto& [x, pressure, analytic] : wall) EXPECT_NEAR(pressure, analytic, 1e-5);
  EXPECT_EQ(film.size(), validation.film.size());
}

TEST_F(RunDirectory, AProlongedAndMovedRunIsOneRun) {
  Case longer = config;
  const auto change = [&](const std::string& from, const std::string& to) {
    const auto at = longer.resolved_text.find(from);
    ASSERT_NE(at, std::string::npos);
    longer.resolved_text.replace(at, from.size(), to);
  };
  change("[time]\nend = ", "[time]\nend = 1");
  change("directory = \"", "directory = \"moved/");
  save(config, 1, 0.1, particles);
  save(longer, 2, 0.2, particles);
  EXPECT_EQ(validate(directory).times.size(), 1u);
}

TEST_F(RunDirectory, WhatTheAnalyticJetHasNotIsTold) {
  const auto report_of = [&](const Case& of) {
    fs::remove_all(directory);
    fs::create_directories(directory);
    save(of, step, 2.0, particles);
    const Validation validation = validate(directory);
    write_report(validation, directory + "/validation");
    std::ifstream file(directory + "/validation/validation.json");
    return std::pair{nlohmann::json::parse(file)["differences"], to_table(validation)};
  };
  const auto [none, plain] = report_of(config);
  EXPECT_EQ(none, nlohmann::json::array());
  EXPECT_EQ(plain.find("differs"), std::string::npos);

  const double width = config.jet.width, speed = config.jet.speed;
  const auto [all, table] = report_of(
      jet_case(60.0, 0.02, "fluid.gravity = [3.0, -4.0]\nfluid.viscosity = 1e-3\nfluid.central_force = 0.5\n"));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0], fmt::format("gravity, g H/U^2 = {:.3g}", 5.0 * width / (speed * speed)));
  EXPECT_EQ(all[1], fmt::format("viscosity, U H/nu = {:.3g}", speed * width / 1e-3));
  EXPECT_EQ(all[2], fmt::format("a central force, B H/U = {:.3g}", 0.5 * width / speed));
  for (const auto& difference : all)
    EXPECT_NE(table.find("differs    " + difference.get<std::string>() + ": the analytic jet has none"),
              std::string::npos)
        << table;

  // A table takes the place of the constant.
  const auto [in_time, unused] = report_of(jet_case(60.0, 0.02,
                                                    "[[fluid.gravity_at]]\ntime = 0.0\nvalue = [0.0, 0.0]\n"
                                                    "[[fluid.gravity_at]]\ntime = 1.0\nvalue = [0.0, 2.0]\n"));
  ASSERT_EQ(in_time.size(), 1u);
  EXPECT_EQ(in_time[0], fmt::format("gravity, g H/U^2 = {:.3g}", 2.0 * width / (speed * speed)));
}

TEST_F(RunDirectory, ReportsAreUtf8WhateverASnapshotSays) {
  save(config, step, 2.0, particles, "caf\xe9");
  write_report(validate(directory), directory + "/validation");
  std::ifstream file(directory + "/validation/validation.json");
  EXPECT_EQ(nlohmann::json::parse(file)["status"], "caf\xef\xbf\xbd");
  save(config, step, 2.0, particles, "\x1b[2Jfinished");
  EXPECT_NE(to_table(validate(directory)).find("run        \\u001b[2Jfinished at"), std::string::npos);
}

TEST_F(RunDirectory, WrongInputIsToldApart) {
  EXPECT_NE(error_of<InputError>().find("no snapshot"), std::string::npos);

  save(config, 1, 0.1, particles);
  save(jet_case(30.0, 0.02), 2, 0.2, particles);
  EXPECT_NE(error_of<InputError>().find("different cases"), std::string::npos);

  fs::remove_all(directory);
  EXPECT_NE(error_of<InputError>().find("no such directory"), std::string::npos);

  fs::create_directories(directory);
  const Case tank = parse_case({{"tank.toml", R"(geometry = "tank"
fluid.gravity = [0.0, -9.81]
particles.spacing = 0.01
tank.size = [0.2, 0.3]
tank.fluid_height = 0.2
time.end = 1.0
time.dt = 1e-3
)"}});
  save(tank, 1, 0.1, particles);
  EXPECT_NE(error_of<InputError>().find("no jet with an exact solution"), std::string::npos);

  std::ofstream(snapshot_path(directory, "tank", 2)) << "not HDF5";
  EXPECT_NE(error_of<FileError>().find("tank_00000002.vtkhdf"), std::string::npos);
}

}  // namespace
}  // namespace impinge
