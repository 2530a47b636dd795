#include "impinge/io/snapshot_layout.hpp"

#include <fmt/format.h>

#include <numeric>

#include "impinge/core/petsc.hpp"
#include "impinge/io/vtkhdf.hpp"

namespace impinge {
namespace {

constexpr int format_version = 1;

std::string mpi_version() {
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string whole(text.data());
  return whole.substr(0, whole.find(','));
}

void write_header(Hdf5Writer& file, const SnapshotHeader& header) {
  file.attribute("/", "format_version", format_version);
  file.attribute("/", "dimension", header.dimension);
  file.attribute("/", "step", header.step);
  file.attribute("/", "time", header.time);
  file.attribute("/", "dt", header.dt);
  file.attribute("/", "window_begin", header.window_begin);
  file.attribute("/", "window_end", header.window_end);
  file.attribute("/", "status", header.status);
  file.attribute("/", "message", header.message);
  file.attribute("/", "case", header.case_text);
  file.attribute("/", "code_version", std::string("impinge " IMPINGE_VERSION));
  file.attribute("/", "petsc_version", petsc_version());
  file.attribute("/", "hdf5_version", hdf5_version());
  file.attribute("/", "mpi_version", mpi_version());
}

/// One vertex per particle.
void write_vertices(Hdf5Writer& file, int count) {
  std::vector<std::int64_t> begin(static_cast<std::size_t>(count) + 1);
  std::iota(begin.begin(), begin.end(), std::int64_t{0});
  write_cells(file, begin, std::vector<std::uint8_t>(static_cast<std::size_t>(count), vtk_vertex));
}

template <int Dim>
void write_field(Hdf5Writer& file, const Particles<Dim>& particles, const auto& field) {
  using T = typename std::remove_cvref_t<decltype(field)>::Value;
  file.dataset(dataset_path(field.name), to_numbers(particles.*field.values, particles.owned), Stored<T>::columns,
               field.unit);
}

template <int Dim>
void write_wall(Hdf5Writer& file, const Particles<Dim>& particles, double window_begin, double window_end) {
  std::vector<Vector<Dim>> position;
  std::vector<double> mean_pressure;
  std::vector<std::int64_t> id;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (particles.type[i] != ParticleType::wall) continue;
    position.push_back(particles.position[i]);
    mean_pressure.push_back(particles.pressure_impulse[i] / (window_end - window_begin));
    id.push_back(particles.id[i]);
  }
  file.create_group("/wall");
  file.attribute("/wall", "window_begin", window_begin);
  file.attribute("/wall", "window_end", window_end);
  file.dataset("/wall/position", to_numbers(position, static_cast<int>(position.size())), 3, "m");
  file.dataset("/wall/mean_pressure", mean_pressure, 0, "Pa");
  file.dataset("/wall/id", id, 0, "1");
}

bool is_position(std::string_view field) { return field == "position"; }

}  // namespace

std::string dataset_path(std::string_view field) {
  return is_position(field) ? points_path : fmt::format("/VTKHDF/PointData/{}", field);
}

StateReader::StateReader(const std::string& path) : Hdf5Reader(path) {
  if (!has_attribute("format_version") || !has("VTKHDF")) fail("not a snapshot of Impinge");
  const auto version = number<int>("format_version");
  if (version != format_version)
    fail(fmt::format("format version {}, but this Impinge reads version {}", version, format_version));
}

SnapshotHeader StateReader::header() const {
  SnapshotHeader header;
  header.dimension = number<int>("dimension");
  header.step = number<std::int64_t>("step");
  header.time = number<double>("time");
  header.dt = number<double>("dt");
  header.window_begin = number<double>("window_begin");
  header.window_end = number<double>("window_end");
  header.status = text("status");
  header.message = text("message");
  header.case_text = text("case");
  header.code_version = text("code_version");
  return header;
}

void StateReader::check_types(std::span<const ParticleType> types) const {
  for (const ParticleType type : types)
    if (type > ParticleType::ghost) fail(fmt::format("a particle has the unknown type {}", static_cast<int>(type)));
}

template <int Dim>
void write_state(Hdf5Writer& file, int rank, const Particles<Dim>& particles, const SnapshotHeader& header) {
  write_header(file, header);
  create_grid(file);
  for_fields<Dim>([&](const auto& field) {
    if (is_position(field.name)) write_field(file, particles, field);
  });
  write_vertices(file, particles.owned);
  file.create_group("/VTKHDF/PointData");
  for_fields<Dim>([&](const auto& field) {
    if (field.is_saved && !is_position(field.name)) write_field(file, particles, field);
  });
  file.dataset(dataset_path(rank_name), std::vector<std::int32_t>(static_cast<std::size_t>(particles.owned), rank), 0,
               "1");
  if (header.window_end > header.window_begin) write_wall(file, particles, header.window_begin, header.window_end);
}

template void write_state(Hdf5Writer&, int, const Particles<2>&, const SnapshotHeader&);
template void write_state(Hdf5Writer&, int, const Particles<3>&, const SnapshotHeader&);

}  // namespace impinge
