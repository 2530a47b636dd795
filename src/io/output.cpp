#include "impinge/io/output.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <utility>
#include <vector>

#include "impinge/io/checkpoint_file.hpp"
#include "impinge/io/run_directory.hpp"
#include "impinge/io/together.hpp"
#include "impinge/observe/history.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kept_checkpoints = 2;

std::string file_name(const std::string& path) { return fs::path(path).filename().string(); }

}  // namespace

Output::Output(MPI_Comm comm, RunFiles files, const std::vector<TableLine>& observed,
               std::optional<std::int64_t> restart_step)
    : comm_(comm),
      files_(std::move(files)),
      history_(history_path(files_.directory, files_.name), history_header()),
      series_(series_path(files_.directory, files_.name), file_series_path(files_.directory, files_.name),
              files_.name) {
  for (const auto& [kind, header] : observed)
    tables_.emplace_back(kind, TableFile(table_path(files_.directory, files_.name, kind), header));
  std::vector<std::string> mistakes;
  on_first_rank(comm, [&] {
    try {
      lock_ = RunLock(files_.directory, files_.name);
    } catch (const InputError& error) {
      mistakes = error.mistakes();
    }
  });
  if (any_rank(comm, !mistakes.empty())) throw InputError(mistakes);
  on_first_rank(comm, [&] {
    for (const std::string& path : list_partial_files(files_.directory, files_.name)) remove_file(path);
    if (restart_step) {
      go_on(*restart_step);
    } else {
      start();
    }
    check_tables();
  });
}

void Output::start() {
  if (holds_run(files_.directory, files_.name)) set_aside_ = set_run_aside(files_.directory, files_.name);
  history_.create();
  for (auto& [kind, table] : tables_) table.create();
}

void Output::check_tables() const {
  history_.check();
  for (const auto& [kind, table] : tables_) table.check();
}

// What was written after the step belongs to a future that will be computed again.
void Output::go_on(std::int64_t step) {
  for (const auto& files :
       {list_checkpoints(files_.directory, files_.name), list_snapshots(files_.directory, files_.name)})
    for (const std::string& path : files)
      if (name_and_step(path).second > step) remove_file(path);
  for (const std::string& path : list_snapshots(files_.directory, files_.name)) {
    try {
      series_.add(file_name(path), read_header(path).time, count_particles(path));
    } catch (const FileError& error) {
      fmt::print(stderr, "impinge: {}; the series goes on without it\n", error.what());
    }
  }
  if (const std::int64_t rows = history_.resume(step); rows != step)
    fmt::print(stderr, "impinge: {} has {} of the {} steps so far\n", history_.path(), rows, step);
  for (auto& [kind, table] : tables_) table.resume(step);
}

void Output::record(const StepReport& report, double seconds) {
  lock_.beat();
  history_.append(history_row(report, seconds));
}

void Output::record(const std::vector<TableLine>& rows) {
  for (const auto& [kind, row] : rows)
    for (auto& [name, table] : tables_)
      if (name == kind) table.append(row);
}

std::string Output::last_row(const std::string& kind) const {
  std::string row;
  for (const auto& [name, table] : tables_)
    if (name == kind) row = table.last_row();
  return broadcast(comm_, row, 0);
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
          .case_text = files_.case_text,
          .code_version = {}};
}

template <int Dim>
std::string Output::save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) {
  const StepReport& report = simulation.report();
  const std::string path = snapshot_path(files_.directory, files_.name, report.step);
  write_snapshot(comm_, path, simulation.particles(), header(simulation, status, message));
  series_.add(file_name(path), report.time,
              sum_over_ranks(comm_, static_cast<std::int64_t>(simulation.particles().owned)));
  on_first_rank(comm_, [&] {
    check_tables();
    series_.write();
  });
  return path;
}

template <int Dim>
std::string Output::save_checkpoint(const Simulation<Dim>& simulation) {
  on_first_rank(comm_, [&] {  // a restart needs the tables up to here
    history_.synchronise();
    for (const auto& [kind, table] : tables_) table.synchronise();
  });
  const std::string path = checkpoint_path(files_.directory, files_.name, simulation.report().step);
  write_checkpoint(comm_, path, simulation.checkpoint(), header(simulation, "running", ""));
  on_first_rank(comm_, [&] {
    const std::vector<std::string> all = list_checkpoints(files_.directory, files_.name);
    std::error_code ignored;  // one too many does no harm
    for (std::size_t k = 0; k + kept_checkpoints < all.size(); ++k) fs::remove(all[k], ignored);
  });
  return path;
}

template std::string Output::save(const Simulation<2>&, const std::string&, const std::string&);
template std::string Output::save(const Simulation<3>&, const std::string&, const std::string&);
template std::string Output::save_checkpoint(const Simulation<2>&);
template std::string Output::save_checkpoint(const Simulation<3>&);

}  // namespace impinge
