#include "impinge/output.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "impinge/parallel.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

constexpr const char* history_columns =
    "step,t,dt,limit,particles,fluid,in,out,lost,kinetic_energy,max_speed,max_pressure,plate_force,iterations,residual,"
    "seconds\n";

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

Output::Output(MPI_Comm comm, const Config& config)
    : comm_(comm), directory_(config.output.directory), name_(config.name), case_text_(config.resolved_text) {
  std::vector<std::string> mistakes;
  std::string failure;
  if (rank_of(comm) == 0) {
    try {
      check_writable(config);
      for (const std::string& path : list_snapshots(directory_, name_)) {
        fs::remove(path);
        ++removed_;
      }
      history_.open(history_path());
      history_ << history_columns << std::flush;
      failure = history_failure();
    } catch (const InputError& error) {
      mistakes = error.mistakes();
    } catch (const std::exception& error) {
      failure = error.what();
    }
  }
  if (any_rank(comm, !mistakes.empty())) throw InputError(mistakes);
  if (any_rank(comm, !failure.empty())) throw OutputError(failure);
}

std::string Output::history_path() const {
  return (fs::path(directory_) / fmt::format("{}_history.csv", name_)).string();
}

std::string Output::history_failure() const { return history_ ? "" : fmt::format("cannot write {}", history_path()); }

void Output::record(const StepReport& report, double seconds) {
  if (!history_.is_open()) return;
  history_ << fmt::format("{},{:.17g},{:.17g},{},{},{},{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.3e},{:.4f}\n",
                          report.step, report.time, report.dt, name_of(report.limit), report.particles, report.fluid,
                          report.in, report.out, report.lost, report.kinetic_energy, report.max_speed,
                          report.max_pressure, report.floor_force, report.pressure.iterations, report.pressure.residual,
                          seconds)
           << std::flush;
}

template <int Dim>
std::string Output::save(const Simulation<Dim>& simulation, const std::string& status, const std::string& message) {
  const StepReport& report = simulation.report();
  const std::string path = snapshot_path(directory_, name_, report.step);
  write_snapshot(comm_, path, simulation.particles(),
                 {.dimension = Dim,
                  .step = report.step,
                  .time = report.time,
                  .dt = report.dt,
                  .window_begin = simulation.window_begin(),
                  .window_end = simulation.window_end(),
                  .status = status,
                  .message = message,
                  .case_text = case_text_,
                  .code_version = {}});
  const SeriesEntry entry{fs::path(path).filename().string(), report.time,
                          sum_over_ranks(comm_, static_cast<std::int64_t>(simulation.particles().owned))};
  if (series_.empty() || series_.back().file != entry.file) series_.push_back(entry);
  std::string failure;
  if (rank_of(comm_) == 0) {
    failure = history_failure();
    if (failure.empty()) failure = write_series();
  }
  if (any_rank(comm_, !failure.empty())) throw OutputError(failure);
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
      <Geometry GeometryType="XYZ">{}</Geometry>
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
  const fs::path path = fs::path(directory_) / fmt::format("{}.xmf", name_);
  const fs::path partial = path.string() + ".partial";
  std::ofstream file(partial);
  file << R"(<?xml version="1.0"?>
<Xdmf Version="3.0">
  <Domain>
  <Grid GridType="Collection" CollectionType="Temporal">
)" << grids
       << R"(  </Grid>
  </Domain>
</Xdmf>
)";
  file.close();
  std::error_code error;
  if (file) fs::rename(partial, path, error);
  return file && !error ? "" : fmt::format("cannot write {}", path.string());
}

template std::string Output::save(const Simulation<2>&, const std::string&, const std::string&);
template std::string Output::save(const Simulation<3>&, const std::string&, const std::string&);

}  // namespace impinge
