#include "impinge/io/checkpoint_file.hpp"

#include <fmt/format.h>

#include <numeric>
#include <optional>

#include "impinge/io/snapshot_layout.hpp"
#include "impinge/io/together.hpp"

namespace impinge {
namespace {

constexpr const char* checkpoint_group = "/checkpoint";

std::string path_in_group(const char* name) { return fmt::format("{}/{}", checkpoint_group, name); }

/// True where the ranks' parts of a dataset make its rows.
bool are_parts_of(std::int64_t rows, const std::vector<std::int64_t>& parts) {
  for (const std::int64_t part : parts) {
    if (part < 0 || part > rows) return false;
    rows -= part;
  }
  return rows == 0;
}

}  // namespace

template <int Dim>
void write_checkpoint(MPI_Comm comm, const std::string& path, const Checkpoint<Dim>& state,
                      const SnapshotHeader& header) {
  Hdf5Writer file(comm, path, true);
  write_state(file, rank_of(comm), state.particles, header);
  file.create_group(checkpoint_group);
  for (const auto& [name, value] : state.numbers) file.attribute(checkpoint_group, name.c_str(), value);
  file.dataset(path_in_group("searched_position"), to_numbers(state.searched_position, state.particles.owned), 3, "m");
  std::vector<std::int64_t> first;  // the same on every rank: rank 0 writes them
  std::vector<int> owner;
  for (const Segment& segment : state.segments) {
    if (rank_of(comm) != 0) break;
    first.push_back(segment.first);
    owner.push_back(segment.rank);
  }
  file.dataset(path_in_group("segment_first"), first);
  file.dataset(path_in_group("segment_owner"), owner);
  const CoarseRows& coarse = state.coarse;
  const auto write_size = [&](const char* name, std::size_t size) {
    file.dataset(path_in_group(name), std::vector{static_cast<std::int64_t>(size)});
  };
  write_size("coarse_rows", coarse.cell.size());
  write_size("coarse_entries", coarse.column.size());
  file.dataset(path_in_group("coarse_cell"), coarse.cell);
  file.dataset(path_in_group("coarse_length"), coarse.length);
  file.dataset(path_in_group("coarse_column"), coarse.column);
  file.dataset(path_in_group("coarse_value"), coarse.value);
  file.finish();
}

template <int Dim>
Checkpoint<Dim> read_checkpoint(MPI_Comm comm, const std::string& path) {
  std::optional<StateReader> file;
  std::vector<std::int64_t> pieces;
  std::int64_t all = 0;
  bool has_segments = false;
  Checkpoint<Dim> state;
  together(comm, [&] {
    file.emplace(path);
    if (!file->has(checkpoint_group)) file->fail("a snapshot, not a checkpoint");
    if (const int dimension = file->number<int>("dimension"); dimension != Dim)
      file->fail(fmt::format("it has {} dimensions, not {}", dimension, Dim));
    state.numbers = file->numbers(checkpoint_group);
    pieces = file->checked_whole<std::int64_t>("/VTKHDF/NumberOfPoints");
    all = file->rows(points_path);
    has_segments = file->has(path_in_group("segment_first").c_str());
    if (!are_parts_of(all, pieces)) file->fail("the ranks' numbers of particles do not make the whole");
  });

  const int rank = rank_of(comm);
  const auto ranks = static_cast<std::int64_t>(ranks_of(comm));
  // Older checkpoints have the owner of each cell in the place of segments: they get a new partition.
  const bool own_parts = static_cast<std::int64_t>(pieces.size()) == ranks && has_segments;
  // Where a rank's part of an array of one piece per rank begins.
  const auto before = [&](const std::vector<std::int64_t>& sizes) {
    return std::accumulate(sizes.begin(), sizes.begin() + rank, std::int64_t{0});
  };
  const std::int64_t first = own_parts ? before(pieces) : all * rank / ranks;
  const std::int64_t count = own_parts ? pieces[static_cast<std::size_t>(rank)] : all * (rank + 1) / ranks - first;
  const auto share = [&]<class Number>(const std::string& dataset, int columns) {
    return file->checked_dataset<Number>(comm, dataset, first, count, columns);
  };
  together(comm, [&] { state.particles = file->particles<Dim>(count, share); });
  state.searched_position =
      to_values<Vector<Dim>>(share.template operator()<double>(path_in_group("searched_position"), 3));
  std::int64_t first_node = 0, nodes = 0;
  const auto check = [&] {
    together(comm, [&] {
      if (const std::string problem = problem_of(state, ranks_of(comm), first_node, nodes); !problem.empty())
        file->fail(problem);
    });
  };
  if (!own_parts) {
    check();
    return state;
  }

  std::vector<std::int64_t> rows, entries;
  together(comm, [&] {
    const auto segment_first = file->checked_whole<std::int64_t>(path_in_group("segment_first"));
    const auto segment_owner = file->checked_whole<int>(path_in_group("segment_owner"));
    if (segment_first.empty() || segment_first.size() != segment_owner.size())
      file->fail("the segments of the cells' owners are incomplete");
    for (std::size_t k = 0; k < segment_first.size(); ++k)
      state.segments.push_back({segment_first[k], segment_owner[k]});
    rows = file->checked_whole<std::int64_t>(path_in_group("coarse_rows"));
    entries = file->checked_whole<std::int64_t>(path_in_group("coarse_entries"));
    if (rows.size() != pieces.size() || entries.size() != pieces.size())
      file->fail("its parts are of different numbers of ranks");
    nodes = file->rows(path_in_group("coarse_cell"));
    if (!are_parts_of(nodes, rows) || !are_parts_of(file->rows(path_in_group("coarse_column")), entries))
      file->fail("the ranks' rows of the coarse matrix do not make the whole");
    first_node = before(rows);
  });
  const auto part = [&]<class T>(const char* dataset, const std::vector<std::int64_t>& sizes, std::vector<T>& values) {
    values =
        file->checked_dataset<T>(comm, path_in_group(dataset), before(sizes), sizes[static_cast<std::size_t>(rank)]);
  };
  part("coarse_cell", rows, state.coarse.cell);
  part("coarse_length", rows, state.coarse.length);
  part("coarse_column", entries, state.coarse.column);
  part("coarse_value", entries, state.coarse.value);
  check();
  return state;
}

template void write_checkpoint(MPI_Comm, const std::string&, const Checkpoint<2>&, const SnapshotHeader&);
template void write_checkpoint(MPI_Comm, const std::string&, const Checkpoint<3>&, const SnapshotHeader&);
template Checkpoint<2> read_checkpoint(MPI_Comm, const std::string&);
template Checkpoint<3> read_checkpoint(MPI_Comm, const std::string&);

}  // namespace impinge
