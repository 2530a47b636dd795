#include "impinge/validation/validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <sstream>

#include "impinge/core/errors.hpp"
#include "impinge/io/run_directory.hpp"
#include "impinge/validation/space_target.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;
using Side = AnalyticJet::Side;

/// A metric's key in the report.
struct MetricKey {
  const char* name;
  std::optional<double> JetMetrics::*value;
  const char* meaning;
};

constexpr MetricKey metric_keys[] = {
    {"wall_l2", &JetMetrics::wall_l2, "relative L2 error of the averaged wall pressure"},
    {"wall_l2_near", &JetMetrics::wall_l2_near, "the same of a round jet within 1.5 radii"},
    {"force_ratio", &JetMetrics::force_ratio, "averaged force over the exact one"},
    {"force_scatter", &JetMetrics::force_scatter, "its standard deviation over the snapshots"},
    {"peak_pressure", &JetMetrics::peak_pressure, "largest averaged wall pressure [Pa]"},
    {"peak_x", &JetMetrics::peak_x, "its distance from the stagnation point [m]"},
    {"stagnation_mean", &JetMetrics::stagnation_mean, "wall pressure at the stagnation point, mean [Pa]"},
    {"stagnation_scatter", &JetMetrics::stagnation_scatter, "its standard deviation over the snapshots [Pa]"},
    {"stagnation_ratio", &JetMetrics::stagnation_ratio, "its mean over rho U^2 / 2"},
    {"centre_x", &JetMetrics::centre_x, "centre of pressure of a round jet, along the incline [D]"},
    {"centre_y", &JetMetrics::centre_y, "the same across the incline [D]"},
    {"field_l2", &JetMetrics::field_l2, "relative L2 error of the pressure in a snapshot"},
    {"mean_field_l2", &JetMetrics::mean_field_l2, "the same of the averaged pressure"},
    {"velocity_rms", &JetMetrics::velocity_rms, "RMS error of the velocity over U"},
    {"surface_rms_dp", &JetMetrics::surface_rms_dp, "RMS distance from the analytic free surface [dp]"},
    {"film_h1", &JetMetrics::film_h1, "thickness of the thick sheet over h1"},
    {"film_h2", &JetMetrics::film_h2, "thickness of the thin sheet over h2"},
    {"film_at_d", &JetMetrics::film_at_d, "film of a round jet over the exact one at r = D"},
    {"film_at_1_5_d", &JetMetrics::film_at_1_5_d, "the same at r = 1.5 D"},
    {"film_flux", &JetMetrics::film_flux, "flux of a round jet's film over the jet's"},
    {"film_momentum", &JetMetrics::film_momentum, "its momentum along the incline over the exact one"},
    {"film_law_rms", &JetMetrics::film_law_rms, "RMS distance of the film from the approximate law"},
    {"sheet_speed", &JetMetrics::sheet_speed, "mean speed in the sheets of a wedge or cup over U"},
    {"plane_x", &JetMetrics::plane_x, "stagnation point between two jets, from their middle [m]"},
    {"plane_drift", &JetMetrics::plane_drift, "speed at which it moves [m/s]"},
};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

/// Particle counts in a line of the history.
struct Stock {
  std::int64_t step, in, out, lost, fluid;
};

/// The last line of a history; nothing without a file or without a line. Throws FileError.
std::optional<Stock> last_stock(const std::string& path) {
  if (!fs::is_regular_file(path)) return std::nullopt;
  std::ifstream file(path);
  std::string line, last;
  std::getline(file, line);
  const auto columns = split(line);
  while (std::getline(file, line)) last = line;
  if (!file.eof()) throw FileError(fmt::format("cannot read {}", path));
  if (last.empty()) return std::nullopt;
  const auto fields = split(last);
  const auto number = [&](const char* name) {
    const auto column = static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin());
    std::int64_t value = 0;
    if (column < std::min(columns.size(), fields.size())) {
      const std::string& text = fields[column];
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error == std::errc() && end == text.data() + text.size()) return value;
    }
    throw FileError(fmt::format("cannot read {}: the last line has no whole number in the column '{}'", path, name));
  };
  return Stock{number("step"), number("in"), number("out"), number("lost"), number("fluid")};
}

template <int Dim>
Particles<Dim> particles_of(const std::string& path) {
  Particles<Dim> particles;
  read_snapshot(MPI_COMM_SELF, path, particles);
  return particles;
}

template <int Dim>
std::int64_t count_fluid(const std::string& path) {
  const Particles<Dim> particles = particles_of<Dim>(path);
  return std::count(particles.type.begin(), particles.type.begin() + particles.owned, ParticleType::fluid);
}

/// What acts on the case, but not on the analytic jet, and how strong it is beside inertia.
std::vector<std::string> differences_of(const FluidSettings& fluid, const JetTarget& target) {
  const double width = target.width, speed = target.speed;
  const auto strength = [](const Numbers& g) { return std::hypot(g[0], g[1], g[2]); };
  double gravity = strength(fluid.gravity);
  if (!fluid.gravity_at.empty()) gravity = 0.0;
  for (const GravityEntry& entry : fluid.gravity_at) gravity = std::max(gravity, strength(entry.value));
  std::vector<std::string> differences;
  if (gravity > 0.0) differences.push_back(fmt::format("gravity, g H/U^2 = {:.3g}", gravity * width / (speed * speed)));
  if (fluid.viscosity > 0.0)
    differences.push_back(fmt::format("viscosity, U H/nu = {:.3g}", speed * width / fluid.viscosity));
  if (fluid.central_force > 0.0)
    differences.push_back(fmt::format("a central force, B H/U = {:.3g}", fluid.central_force * width / speed));
  return differences;
}

nlohmann::json to_json(const std::optional<double>& value) { return value ? nlohmann::json(*value) : nullptr; }

/// Origin and axes of the frame of the profiles: two axes of a plane jet, three of a round one.
nlohmann::json frame_of(const JetTarget& target) {
  const auto json = [](const auto& origin, const auto& x, const auto& y) {
    return nlohmann::json{{"origin", origin.component}, {"x", x.component}, {"y", y.component}};
  };
  if (!target.space) return json(target.frame.origin, target.frame.x, target.frame.y);
  const SpacePlate& space = *target.space;
  if (target.type == TargetType::plate) return json(space.origin, space.x, space.z);
  nlohmann::json frame = json(space.origin, space.x, space.y);
  frame["z"] = space.z.component;
  return frame;
}

/// A file that is written line by line.
class TextFile {
 public:
  explicit TextFile(const fs::path& path) : path_(path), file_(path) {}

  template <class... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    file_ << fmt::format(format, std::forward<Values>(values)...);
  }

  /// Throws FileError if anything went wrong so far.
  void finish() {
    file_.close();
    if (!file_) throw FileError(fmt::format("cannot write {}", path_.string()));
  }

 private:
  fs::path path_;
  std::ofstream file_;
};

/// Free surfaces h1 and h2, from the sheet's end to the jet's.
void write_surface(const JetTarget& target, const fs::path& path) {
  const AnalyticJet jet = analytic_jet(target);
  TextFile file(path);
  file.print("sheet,x_m,y_m\n");
  for (const Side side : {Side::h1, Side::h2}) {
    const double sheet_length = std::abs(side == Side::h1 ? target.end : target.begin);
    for (const Vector<2>& point : jet.surface(side, sheet_length, target.distance, target.spacing))
      file.print("{},{:.9g},{:.9g}\n", side == Side::h1 ? 1 : 2, point[0], point[1]);
  }
  file.finish();
}

/// Lines of equal pressure, from plate to plate: |zeta|^2 = 1 - Cp.
void write_isobars(const JetTarget& target, const fs::path& path) {
  const AnalyticJet jet = analytic_jet(target);
  constexpr int levels = 40, segments = 2000;
  TextFile file(path);
  file.print("cp,x_m,y_m\n");
  for (int level = 1; level < levels; ++level) {
    const double cp = static_cast<double>(level) / levels;
    Vector<2> drawn;
    for (int k = 0; k <= segments; ++k) {
      const Vector<2> point = jet.position(std::polar(std::sqrt(1.0 - cp), std::numbers::pi * k / segments));
      if (k > 0 && k < segments && norm(point - drawn) < 0.5 * target.spacing) continue;
      drawn = point;
      file.print("{},{:.9g},{:.9g}\n", cp, point[0], point[1]);
    }
  }
  file.finish();
}

/// A snapshot in the frame of a plate.
Particles<2> in_frame_of(const JetTarget& target, const std::string& path) {
  return target.space ? in_frame(target, particles_of<3>(path)) : in_frame(target, particles_of<2>(path));
}

void take(const JetComparison& comparison, Validation& result) {
  result.metrics = comparison.metrics();
  result.force = analytic_jet(result.target).normal_force();
  result.wall = comparison.wall_profile();
  result.film = comparison.film_profile();
  result.analytic_film_h1 = comparison.analytic_film(Side::h1);
  result.analytic_film_h2 = comparison.analytic_film(Side::h2);
}

/// `average_path`: the snapshot with the time-averaged wall pressure; empty: there is none.
void compare_plate(const std::vector<std::string>& paths, const std::string& average_path, Validation& result) {
  JetComparison comparison(result.target);
  if (!average_path.empty())
    comparison.set_wall_average(in_frame_of(result.target, average_path), result.window->end - result.window->begin);
  for (const std::string& path : paths) comparison.add_snapshot(in_frame_of(result.target, path));
  take(comparison, result);
}

/// Likewise.
void compare_split(const std::vector<std::string>& paths, const std::string& average_path, Validation& result) {
  SplitJetComparison comparison(result.target);
  if (!average_path.empty())
    comparison.set_wall_average(particles_of<2>(average_path), result.window->end - result.window->begin);
  for (const std::string& path : paths) comparison.add_snapshot(particles_of<2>(path));
  result.metrics = comparison.metrics();
  result.wall = comparison.wall_profile();
  result.force = comparison.force();
}

/// Likewise.
void compare_round(const std::vector<std::string>& paths, const std::string& average_path, Validation& result) {
  RoundJetComparison comparison(result.target);
  if (!average_path.empty())
    comparison.set_wall_average(particles_of<3>(average_path), result.window->end - result.window->begin);
  for (const std::string& path : paths) comparison.add_snapshot(particles_of<3>(path));
  result.metrics = comparison.metrics();
  result.wall = comparison.wall_profile();
  result.film = comparison.film_profile();
  result.wall_map = comparison.wall_map();
  result.force = comparison.force();
}

/// The slope of a straight line through values at times, by least squares; nothing of a single time.
std::optional<double> slope_of(const std::vector<double>& times, const std::vector<double>& values) {
  const auto mean = [](const std::vector<double>& x) {
    return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  };
  const double mean_time = mean(times), mean_value = mean(values);
  double products = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    products += (times[k] - mean_time) * (values[k] - mean_value);
    squares += std::pow(times[k] - mean_time, 2);
  }
  return squares > 0.0 ? std::optional(products / squares) : std::nullopt;
}

/// First finds the stagnation point, through whose mean place the plane goes, then compares the flow on both sides.
void compare_jets(const std::vector<std::string>& paths, Validation& result) {
  JetTarget& target = result.target;
  const Vector<2> middle = target.frame.origin, along = -1.0 * target.frame.y;
  Vector<2> sum;
  std::vector<double> places;
  for (const std::string& path : paths) {
    const auto point = stagnation_point(particles_of<2>(path), middle, target.width);
    if (!point) continue;
    sum += *point - middle;
    places.push_back(dot(*point - middle, along));
  }
  const bool is_found = places.size() == paths.size();
  const Vector<2> shift = is_found ? 1.0 / static_cast<double>(paths.size()) * sum : Vector<2>{};
  target.frame.origin += shift;
  target.begin -= dot(shift, target.frame.x);
  target.end -= dot(shift, target.frame.x);

  JetComparison comparison(target);
  Particles<2> particles;
  std::map<std::int64_t, double> sums;  // of the pressures on the plane, by id
  for (const std::string& path : paths) {
    particles = in_frame(target, particles_of<2>(path));
    comparison.add_snapshot(particles);
    for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
      if (particles.type[i] == ParticleType::wall) sums[particles.id[i]] += particles.pressure[i];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (particles.type[i] == ParticleType::wall) particles.pressure_impulse[i] = sums[particles.id[i]];
  comparison.set_wall_average(particles, static_cast<double>(paths.size()));
  take(comparison, result);
  if (!is_found) return;
  result.metrics.plane_x = dot(shift, along);
  result.metrics.plane_drift = slope_of(result.times, places);
}

}  // namespace

Validation validate(const std::string& directory, const SnapshotSelection& selection) {
  if (!fs::is_directory(directory)) throw InputError({fmt::format("{}: no such directory", directory)});
  const std::vector<std::string> paths = list_snapshots(directory);
  if (paths.empty()) throw InputError({fmt::format("{}: no snapshot (*.vtkhdf) in this directory", directory)});
  std::vector<SnapshotHeader> headers;
  for (const std::string& path : paths) headers.push_back(read_header(path));

  Validation result;
  result.last = headers.back();
  result.last_path = paths.back();
  for (std::size_t k = 0; k < paths.size(); ++k)
    if (headers[k].case_text != result.last.case_text &&
        !are_of_one_run({paths[k], headers[k].case_text}, {result.last_path, result.last.case_text}))
      throw InputError({fmt::format("{}: {} and {} are of different cases; one directory, one run", directory, paths[k],
                                    result.last_path)});
  result.config = parse_stored({result.last_path, result.last.case_text});
  const Case& config = result.config;
  result.target = jet_target(config);
  result.differences = differences_of(config.fluid, result.target);

  const auto averaged = std::find_if(headers.rbegin(), headers.rend(),
                                     [](const SnapshotHeader& h) { return h.window_end > h.window_begin; });
  if (averaged != headers.rend()) result.window = {averaged->window_begin, averaged->window_end};
  TimeSpan span = result.window.value_or(TimeSpan{result.last.time, result.last.time});
  if (selection.from || selection.to)
    span = {selection.from.value_or(headers.front().time), selection.to.value_or(result.last.time)};
  const double tolerance = 1e-9 * config.time.end;
  std::vector<std::string> chosen;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    if (!(headers[k].time >= span.begin - tolerance && headers[k].time <= span.end + tolerance)) continue;
    chosen.push_back(paths[k]);
    result.times.push_back(headers[k].time);
  }
  if (result.times.empty())
    throw InputError(
        {fmt::format("{}: no snapshot between {:.6g} s and {:.6g} s; the run's are from {:.6g} s to {:.6g} s",
                     directory, span.begin, span.end, headers.front().time, result.last.time)});

  std::string average_path;
  if (result.window) average_path = paths[static_cast<std::size_t>(headers.rend() - averaged) - 1];
  switch (result.target.type) {
    case TargetType::plate:
      compare_plate(chosen, average_path, result);
      break;
    case TargetType::jet:
      compare_jets(chosen, result);
      break;
    case TargetType::wedge:
    case TargetType::cup:
      compare_split(chosen, average_path, result);
      break;
    case TargetType::flat_wall:
      compare_round(chosen, average_path, result);
  }

  if (const auto stock = last_stock(history_path(directory, config.name))) {
    std::int64_t stored = stock->fluid;
    if (stock->step == result.last.step)
      stored = config.dimension == 3 ? count_fluid<3>(result.last_path) : count_fluid<2>(result.last_path);
    result.particle_balance = stock->in - stock->out - stock->lost - stored;
  }
  return result;
}

std::string to_json(const Validation& validation) {
  using nlohmann::json;
  const Case& config = validation.config;
  const JetTarget& target = validation.target;
  nlohmann::ordered_json report;
  report["case"] = config.name;
  report["code_version"] = validation.last.code_version;
  report["status"] = validation.last.status;
  report["message"] = validation.last.message;
  report["step"] = validation.last.step;
  report["time"] = validation.last.time;
  report["last_snapshot"] = fs::path(validation.last_path).filename().string();
  report["target"] = word_of(target.type);
  report["parameters"] = {{"angle", target.angle * 180.0 / std::numbers::pi},
                          {"width", target.width},
                          {"depth", target.space && target.space->depth > 0.0 ? json(target.space->depth) : nullptr},
                          {"speed", target.speed},
                          {"density", target.density},
                          {"spacing", target.spacing},
                          {"width_over_spacing", target.width / target.spacing},
                          {"scheme", word_of(config.scheme)},
                          {"gamma", config.pressure.gamma},
                          {"kernel", word_of(config.kernel.type)},
                          {"plate_begin", target.begin},
                          {"plate_end", target.end}};
  report["frame"] = frame_of(target);
  const auto sheet = [&](Side side) -> std::optional<double> {
    if (target.type == TargetType::flat_wall) return std::nullopt;
    const bool is_split = target.type == TargetType::wedge || target.type == TargetType::cup;
    return is_split ? 0.5 * target.width : analytic_jet(target).sheet_thickness(side);
  };
  report["analytic"] = {{"stagnation_pressure", 0.5 * target.density * target.speed * target.speed},
                        {"force", validation.force},
                        {"h1", to_json(sheet(Side::h1))},
                        {"h2", to_json(sheet(Side::h2))},
                        {"film_h1", to_json(validation.analytic_film_h1)},
                        {"film_h2", to_json(validation.analytic_film_h2)}};
  report["differences"] = validation.differences;
  report["window"] = nullptr;
  if (validation.window) report["window"] = {{"begin", validation.window->begin}, {"end", validation.window->end}};
  report["snapshots"] = {{"count", validation.times.size()},
                         {"first_time", validation.times.front()},
                         {"last_time", validation.times.back()}};
  for (const MetricKey& key : metric_keys) report["metrics"][key.name] = to_json(validation.metrics.*key.value);
  report["metrics"]["particle_balance"] =
      validation.particle_balance ? json(*validation.particle_balance) : json(nullptr);
  // What another's snapshot says need not be UTF-8.
  return report.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

/// The scheme, and what the paper varies in it.
std::string scheme_text(const Case& config) {
  return config.scheme == Scheme::paper ? fmt::format("paper's scheme, gamma = {}", config.pressure.gamma)
                                        : "consistent scheme";
}

std::string to_table(const Validation& validation) {
  const Case& config = validation.config;
  const JetTarget& target = validation.target;
  const SnapshotHeader& last = validation.last;
  std::string table =
      fmt::format("case       {}: {}, {:.6g} deg, {}/dp = {:.4g}, {}, kernel {}\n", config.name, word_of(target.type),
                  target.angle * 180.0 / std::numbers::pi, target.type == TargetType::flat_wall ? 'D' : 'H',
                  target.width / target.spacing, scheme_text(config), word_of(config.kernel.type));
  table += fmt::format("run        {} at t = {:.6g} s, step {}\n", printable(last.status), last.time, last.step);
  if (!last.message.empty()) table += fmt::format("           {}\n", printable(last.message));
  for (const std::string& difference : validation.differences)
    table += fmt::format("differs    {}: the analytic jet has none; the errors below include its effect\n", difference);
  table += validation.window ? fmt::format("averaged   wall pressure from {:.6g} s to {:.6g} s\n",
                                           validation.window->begin, validation.window->end)
                             : std::string("averaged   nothing yet\n");
  table += fmt::format("compared   {} snapshot(s) from {:.6g} s to {:.6g} s\n\n", validation.times.size(),
                       validation.times.front(), validation.times.back());
  const auto row = [&](const char* name, const std::string& value, const char* meaning) {
    table += fmt::format("  {:<18} {:>10}  {}\n", name, value, meaning);
  };
  for (const MetricKey& key : metric_keys) {
    const auto value = validation.metrics.*key.value;
    row(key.name, value ? fmt::format("{:.4g}", *value) : "-", key.meaning);
  }
  row("particle_balance", validation.particle_balance ? fmt::format("{}", *validation.particle_balance) : "-",
      "particles in minus out, lost and stored");
  return table;
}

void write_report(const Validation& validation, const std::string& directory) {
  const fs::path folder(directory);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw FileError(fmt::format("cannot create {}: {}", directory, error.message()));

  const JetTarget& target = validation.target;
  const bool is_round = target.type == TargetType::flat_wall, is_by_radius = is_round && is_perpendicular(target);
  TextFile wall(folder / "wall_pressure.csv");
  wall.print("{},pressure_Pa,analytic_Pa\n", is_by_radius ? "r_m" : "x_m");
  for (const PlatePoint& point : validation.wall)
    wall.print("{:.9g},{:.9g},{:.9g}\n", point.x, point.pressure, point.analytic);
  wall.finish();

  TextFile film(folder / "film_thickness.csv");
  film.print("{},thickness_m,analytic_m\n", is_by_radius ? "r_m" : is_round ? "azimuth_deg" : "x_m");
  const double unit = is_round && !is_by_radius ? 180.0 / std::numbers::pi : 1.0;
  for (const FilmColumn& column : validation.film)
    film.print("{:.9g},{:.9g},{:.9g}\n", column.x * unit, column.thickness, column.analytic);
  film.finish();

  if (is_round) {
    TextFile map(folder / "wall_map.csv");
    map.print("x_m,y_m,pressure_Pa\n");
    for (const WallMapPoint& point : validation.wall_map)
      map.print("{:.9g},{:.9g},{:.9g}\n", point.x, point.y, point.pressure);
    map.finish();
  }

  if (target.type == TargetType::plate || target.type == TargetType::jet) {
    write_surface(target, folder / "surface.csv");
    write_isobars(target, folder / "isobars.csv");
  }

  TextFile report(folder / "validation.json");
  report.print("{}", to_json(validation));
  report.finish();
}

}  // namespace impinge
