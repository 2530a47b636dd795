#include "impinge/io/snapshot.hpp"

#include <fmt/format.h>

#include "impinge/io/snapshot_layout.hpp"
#include "impinge/io/together.hpp"

namespace impinge {

template <int Dim>
void write_snapshot(MPI_Comm comm, const std::string& path, const Particles<Dim>& particles,
                    const SnapshotHeader& header) {
  Hdf5Writer file(comm, path);
  write_state(file, rank_of(comm), particles, header);
  file.finish();
}

SnapshotHeader read_header(const std::string& path) { return StateReader(path).header(); }

std::int64_t count_particles(const std::string& path) { return StateReader(path).rows(points_path); }

template <int Dim>
SnapshotHeader read_snapshot(MPI_Comm comm, const std::string& path, Particles<Dim>& particles) {
  SnapshotHeader header;
  together(comm, [&] {
    const StateReader file(path);
    header = file.header();
    if (header.dimension != Dim) file.fail(fmt::format("it has {} dimensions, not {}", header.dimension, Dim));
    const std::int64_t all = file.rows(points_path);
    const std::int64_t first = all * rank_of(comm) / ranks_of(comm);
    const std::int64_t count = all * (rank_of(comm) + 1) / ranks_of(comm) - first;
    particles = file.particles<Dim>(count, [&]<class Number>(const std::string& name, int columns) {
      if (const auto rows = file.rows(name); rows != all)
        file.fail(fmt::format("dataset {} has {} rows, not {} as {}", name, rows, all, points_path));
      return file.dataset<Number>(name, first, count, columns);
    });
  });
  return header;
}

template void write_snapshot(MPI_Comm, const std::string&, const Particles<2>&, const SnapshotHeader&);
template void write_snapshot(MPI_Comm, const std::string&, const Particles<3>&, const SnapshotHeader&);
template SnapshotHeader read_snapshot(MPI_Comm, const std::string&, Particles<2>&);
template SnapshotHeader read_snapshot(MPI_Comm, const std::string&, Particles<3>&);

}  // namespace impinge
