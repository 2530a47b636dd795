#include "impinge/io/output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "impinge/parallel/exchange.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr const char* history_columns =
    "step,t,dt,limit,particles,fluid,in,out,lost,kinetic_energy,max_speed,max_pressure,plate_force,iterations,residual,"
    "cold_solves,halvings,seconds\n";

constexpr std::size_t kept_checkpoints = 2;

/// Writes a text file: complete under its name, or not at all. Returns what went wrong; nothing if all is well.
std::string write_file(const std::string& path, const std::string& text) {
  const std::string partial = path + ".partial";
  errno = 0;
  std::ofstream file(partial);
  file << text;
  file.close();
  std::string reason = file ? synchronise(partial) : std::strerror(errno);
  if (reason.empty() && std::rename(partial.c_str(), path.c_str()) != 0) reason = std::strerror(errno);
  return reason.empty() ? "" : fmt::format("cannot write {}: {}", path, reason);
}

const char* name_of(StepLimit limit) { return step_limit_names[static_cast<std::size_t>(limit)]; }

struct SeriesField {
  const char* name;
  const char* type;  // attributes of XDMF's DataItem
  int columns;
};

constexpr SeriesField series_fields[] = {
    {"velocity", R"(NumberType="Float" Precision="8")", 3},
    {"pressure", R"(NumberType="Float" Precision="8")", 1},
    {"number_density", R"(NumberType="Float" Precision="8")", 1},
    {"type", R"(NumberType="UChar")", 1},
    {"free_surface", R"(NumberType="UChar")", 1},
    {"id", R"(NumberType="Int" Precision="8")", 1},
    {"rank", R"(NumberType="Int" Precision="4")", 1},
};

std::string data_item(const std::string& file, const std::string& path, const char* type, std::int64_t rows,
                      int columns) {
  return fmt::format(R"(<DataItem Format="HDF" Dimensions="{}{}" {}>{}:{}</DataItem>)", rows,
                     columns > 1 ? fmt::format(" {}", columns) : "", type, file, path);
}

}  // namespace

Output::Output(MPI_Comm comm, const Case& config, std::optional<std::int64_t> restart_step)
    : comm_(comm), directory_(config.output.directory), name_(config.name), case_text_(config.resolved_text) {
  std::vector<std::string> mistakes;
  std::string failure;
  if (rank_of(comm) == 0) {
    try {
      check_writable(config);
      for (const std::string& path : list_partial_files(directory_, name_)) fs::remove(path);
      if (restart_step) {
        go_on(*restart_step);
      } else {
        start();
      }
      failure = history_failure();
    } catch (const InputError& error) {
      mistakes = error.mistakes();
    } catch (const std::exception& error) {
      failure = error.what();
    }
  }
  if (any_rank(comm, !mistakes.empty())) throw InputError(mistakes);
  if (any_rank(comm, !failure.empty())) throw FileError(failure);
}

void Output::start() {
  for (const std::string& path : list_checkpoints(directory_, name_)) fs::remove(path);
  for (const std::string& path : list_snapshots(directory_, name_)) {
    fs::remove(path);
    ++removed_;
  }
  open_history(std::ios::trunc);
  history_ << history_columns << std::flush;
}

// What was written after the step belongs to a future that will be computed again.
void Output::go_on(std::int64_t step) {
  for (const auto& files : {list_checkpoints(directory_, name_), list_snapshots(directory_, name_)})
    for (const std::string& path : files)
      if (name_and_step(path).second > step) fs::remove(path);
  for (const std::string& path : list_snapshots(directory_, name_)) {
    try {
      series_.push_back({fs::path(path).filename().string(), read_header(path).time, count_particles(path)});
    } catch (const FileError& error) {
      fmt::print(stderr, "impinge: {}; the series goes on without it\n", error.what());
    }
  }

  std::ifstream old(history_path());
  std::string text = history_columns;
  std::int64_t lines = 0;
  std::string line;
  std::getline(old, line);
  while (std::getline(old, line)) {
    if (std::atoll(line.c_str()) > step) break;
    text += line + '\n';
    ++lines;
  }
  old.close();
  if (lines != step) fmt::print(stderr, "impinge: {} has {} of the {} steps so far\n", history_path(), lines, step);
  if (const std::string failure = write_file(history_path(), text); !failure.empty()) throw FileError(failure);
  open_history(std::ios::app);
}

void Output::open_history(std::ios::openmode mode) {
  errno = 0;
  history_.open(history_path(), std::ios::out | mode);
  if (!history_) history_reason_ = std::strerror(errno);
}

std::string Output::history_path() const {
  return (fs::path(directory_) / fmt::format("{}_history.csv", name_)).string();
}

std::string Output::history_failure() const {
  return history_ ? "" : fmt::format("cannot write {}: {}", history_path(), history_reason_);
}

void Output::record(const StepReport& report, double seconds) {
  if (!history_.is_open() || !history_) return;
  errno = 0;
  history_ << fmt::format("{},{:.17g},{:.17g},{},{},{},{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.3e},{},{},{:.4f}\n",
                          report.step, report.time, report.dt, name_of(report.limit), report.particles, report.fluid,
                          report.in, report.out, report.lost, report.kinetic_energy, report.max_speed,
                          report.max_pressure, report.floor_force, report.pressure.iterations, report.pressure.residual,
                          report.cold_solves, report.halvings, seconds)
           << std::flush;
  if (!history_) history_reason_ = std::strerror(errno);
}

template <int Dim>
SnapshotHeader Output::header(const Simulation<Dim>& simulation, const std::string& status,
                              const std::string& message) const {
  const StepReport& report = simulation.report();
  return {.dimension = Dim,
          .step = report.step,
          .time = report.time,
          .dt = report.dt,
          .window_begin = simulation.window().begin,
          .window_end = simulation.window().end,
          .status = status,
          .message = message,
          .case_text = case_text_,
          .code_version = {}};
}

template <int Dim>
std::string Output::save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) {
  const StepReport& report = simulation.report();
  const std::string path = snapshot_path(directory_, name_, report.step);
  write_snapshot(comm_, path, simulation.particles(), header(simulation, status, message));
  const SeriesEntry entry{fs::path(path).filename().string(), report.time,
                          sum_over_ranks(comm_, static_cast<std::int64_t>(simulation.particles().owned))};
  if (series_.empty() || series_.back().file != entry.file) series_.push_back(entry);
  std::string failure;
  if (rank_of(comm_) == 0) {
    failure = history_failure();
    if (failure.empty()) failure = write_series();
  }
  if (any_rank(comm_, !failure.empty())) throw FileError(failure);
  return path;
}

template <int Dim>
std::string Output::save_checkpoint(const Simulation<Dim>& simulation) {
  // A restart needs the history up to here.
  std::string failure;
  if (rank_of(comm_) == 0) {
    failure = history_failure();
    if (failure.empty())
      if (const std::string reason = synchronise(history_path()); !reason.empty())
        failure = fmt::format("cannot write {}: {}", history_path(), reason);
  }
  if (any_rank(comm_, !failure.empty())) throw FileError(failure);

  const std::string path = checkpoint_path(directory_, name_, simulation.report().step);
  write_checkpoint(comm_, path, simulation.checkpoint(), header(simulation, "running", ""));
  if (rank_of(comm_) == 0) {
    const std::vector<std::string> all = list_checkpoints(directory_, name_);
    std::error_code ignored;  // one too many does no harm
    for (std::size_t k = 0; k + kept_checkpoints < all.size(); ++k) fs::remove(all[k], ignored);
  }
  return path;
}

std::string Output::write_series() const {
  std::string grids;
  for (const SeriesEntry& entry : series_) {
    const auto item = [&](const char* path, const char* type, int columns) {
      return data_item(entry.file, path, type, entry.particles, columns);
    };
    grids += fmt::format(R"(    <Grid Name="{}">
      <Time Value="{:.17g}"/>
      <Topology TopologyType="Polyvertex" NumberOfElements="{}"/>
      <Geometry SceneType="XYZ">{}</Geometry>
)",
                         name_, entry.time, entry.particles,
                         item("/VTKHDF/Points", R"(NumberType="Float" Precision="8")", 3));
    for (const SeriesField& field : series_fields)
      grids += fmt::format(R"(      <Attribute Name="{}" AttributeType="{}" Center="Node">{}</Attribute>
)",
                           field.name, field.columns == 3 ? "Vector" : "Scalar",
                           item(fmt::format("/VTKHDF/PointData/{}", field.name).c_str(), field.type, field.columns));
    grids += "    </Grid>\n";
  }
  return write_file((fs::path(directory_) / fmt::format("{}.xmf", name_)).string(), fmt::format(R"(<?xml version="1.0"?>
<Xdmf Version="3.0">
  <Decomposition>
  <Grid GridType="Collection" CollectionType="Temporal">
{}  </Grid>
  </Decomposition>
</Xdmf>
)",
                                                                                                grids));
}

template std::string Output::save(const Simulation<2>&, const std::string&, const std::string&);
template std::string Output::save(const Simulation<3>&, const std::string&, const std::string&);
template std::string Output::save_checkpoint(const Simulation<2>&);
template std::string Output::save_checkpoint(const Simulation<3>&);

}  // namespace impinge
