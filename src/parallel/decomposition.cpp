#include "impinge/parallel/decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <tuple>

#include "impinge/parallel/graph_partition.hpp"

namespace impinge {
namespace {

// Relative cost of a particle: one with a row of neighbours against one that is only seen by others.
int work_of(ParticleType type) { return type == ParticleType::fluid || type == ParticleType::wall ? 4 : 1; }

template <int Dim>
double work_of(const Particles<Dim>& particles) {
  double work = 0.0;
  for (int i = 0; i < particles.owned; ++i) work += work_of(particles.type[static_cast<std::size_t>(i)]);
  return work;
}

}  // namespace

template <int Dim>
void add_work(const CellGrid<Dim>& cells, const Particles<Dim>& particles, std::span<int> work) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const int cell = cells.cell(cells.wrapped(particles.position[i]));
    if (cell >= 0) work[static_cast<std::size_t>(cell)] += work_of(particles.type[i]);
  }
}

template <int Dim>
std::vector<int> distribute_cells(MPI_Comm comm, const CellGrid<Dim>& cells, std::span<const int> work, int parts,
                                  Partitioner partitioner) {
  // The graph of the occupied cells.
  std::vector<int> vertex_of(work.size(), -1);
  CellGraph graph;
  std::vector<int> cell_of;
  for (std::size_t cell = 0; cell < work.size(); ++cell) {
    if (work[cell] == 0) continue;
    vertex_of[cell] = static_cast<int>(cell_of.size());
    cell_of.push_back(static_cast<int>(cell));
    graph.vertex_weight.push_back(work[cell]);
  }
  for (const int cell : cell_of) {
    if (!needs_edges(comm, parts, partitioner)) break;
    for_cells_around(cells, cell, 1, [&](int neighbour, const Vector<Dim>&) {
      const auto n = static_cast<std::size_t>(neighbour);
      if (vertex_of[n] < 0 || neighbour == cell) return;
      graph.neighbour.push_back(vertex_of[n]);
      graph.edge_weight.push_back(work[static_cast<std::size_t>(cell)] + work[n]);
    });
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  const std::vector<int> part = partition_graph(comm, graph, parts, partitioner);

  // Empty cells follow the nearest occupied one: a breadth-first walk from all occupied cells at once.
  std::vector<int> owner(work.size(), -1);
  std::deque<int> front;
  for (std::size_t v = 0; v < cell_of.size(); ++v) {
    owner[static_cast<std::size_t>(cell_of[v])] = part[v];
    front.push_back(cell_of[v]);
  }
  while (!front.empty()) {
    const int cell = front.front();
    front.pop_front();
    for_cells_around(cells, cell, 1, [&](int neighbour, const Vector<Dim>&) {
      int& next = owner[static_cast<std::size_t>(neighbour)];
      if (next >= 0) return;
      next = owner[static_cast<std::size_t>(cell)];
      front.push_back(neighbour);
    });
  }
  std::replace(owner.begin(), owner.end(), -1, 0);
  return owner;
}

template <int Dim>
void append_halo_targets(const CellGrid<Dim>& cells, std::span<const int> owner, int cell,
                         std::vector<HaloTarget<Dim>>& targets) {
  const auto first = static_cast<std::ptrdiff_t>(targets.size());
  const HaloTarget<Dim> self{owner[static_cast<std::size_t>(cell)], {}};
  for_cells_around(cells, cell, 1, [&](int neighbour, const Vector<Dim>& shift) {
    const HaloTarget<Dim> target{owner[static_cast<std::size_t>(neighbour)], shift};
    if (target == self || std::find(targets.begin() + first, targets.end(), target) != targets.end()) return;
    targets.push_back(target);
  });
}

template <int Dim>
Decomposition<Dim>::Decomposition(MPI_Comm comm, const Box<Dim>& box, const std::array<bool, Dim>& periodic,
                                  double reach, Partitioner partitioner)
    : comm_(comm), cells_(box, periodic, reach), fine_(cells_.refined(cell_parts)), partitioner_(partitioner) {}

template <int Dim>
void Decomposition<Dim>::partition(const Particles<Dim>& particles) {
  std::vector<int> work(static_cast<std::size_t>(cells_.count()), 0);
  add_work<Dim>(cells_, particles, work);
  MPI_Allreduce(MPI_IN_PLACE, work.data(), cells_.count(), MPI_INT, MPI_SUM, comm_);
  owner_ = distribute_cells<Dim>(comm_, cells_, work, ranks_of(comm_), partitioner_);

  std::vector<double> rank_work(static_cast<std::size_t>(ranks_of(comm_)), 0.0);
  for (std::size_t cell = 0; cell < work.size(); ++cell)
    rank_work[static_cast<std::size_t>(owner_[cell])] += work[cell];
  const double total = std::accumulate(rank_work.begin(), rank_work.end(), 0.0);
  const double largest = *std::max_element(rank_work.begin(), rank_work.end());
  achieved_imbalance_ = total > 0.0 ? largest * static_cast<double>(rank_work.size()) / total : 1.0;
  ++partitions_;
  find_halo_targets();
}

template <int Dim>
void Decomposition<Dim>::set_owners(std::vector<int> owner, double achieved_imbalance) {
  owner_ = std::move(owner);
  achieved_imbalance_ = achieved_imbalance;
  ++partitions_;
  find_halo_targets();
}

template <int Dim>
void Decomposition<Dim>::find_halo_targets() {
  const int self = rank_of(comm_);
  targets_.clear();
  target_start_.assign(1, 0);
  for (int cell = 0; cell < cells_.count(); ++cell) {
    if (owner_[static_cast<std::size_t>(cell)] == self) append_halo_targets<Dim>(cells_, owner_, cell, targets_);
    target_start_.push_back(static_cast<int>(targets_.size()));
  }
}

template <int Dim>
double Decomposition<Dim>::imbalance(const Particles<Dim>& particles) const {
  const double work = work_of(particles);
  const double total = sum_over_ranks(comm_, work);
  return total > 0.0 ? max_over_ranks(comm_, work) * ranks_of(comm_) / total : 1.0;
}

template <int Dim>
bool Decomposition<Dim>::owns(const Vector<Dim>& position) const {
  const int cell = cells_.cell(cells_.wrapped(position));
  return cell >= 0 && owner_[static_cast<std::size_t>(cell)] == rank_of(comm_);
}

template <int Dim>
Strays Decomposition<Dim>::migrate(Particles<Dim>& particles) {
  particles.resize(particles.owned);
  const int self = rank_of(comm_);
  Strays strays;
  std::vector<std::pair<int, int>> leaving;  // (destination, index)
  int kept = 0;
  std::vector<ParticleRecord<Dim>> packed;
  for (int i = 0; i < particles.owned; ++i) {
    ParticleRecord<Dim> record = particles.record(i);
    record.position = cells_.wrapped(record.position);
    const int cell = cells_.cell(record.position);
    if (cell < 0) {
      ++(std::isfinite(norm(record.position)) ? strays.outside : strays.not_finite);
      continue;
    }
    const int rank = owner_[static_cast<std::size_t>(cell)];
    if (rank == self) {
      particles.set_record(kept++, record);
    } else {
      leaving.emplace_back(rank, static_cast<int>(packed.size()));
      packed.push_back(record);
    }
  }
  std::stable_sort(leaving.begin(), leaving.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<ParticleRecord<Dim>> send;
  std::vector<std::pair<int, int>> runs;
  for (const auto& [rank, index] : leaving) {
    if (runs.empty() || runs.back().first != rank) runs.emplace_back(rank, 0);
    ++runs.back().second;
    send.push_back(packed[static_cast<std::size_t>(index)]);
  }
  const Exchange exchange(comm_, runs);
  std::vector<ParticleRecord<Dim>> received(static_cast<std::size_t>(exchange.n_receive()));
  exchange.forward(send.data(), received.data());

  particles.owned = kept;
  particles.resize(kept);
  for (const auto& record : received) particles.append(record);
  sort_along_cells(particles);
  return strays;
}

template <int Dim>
void Decomposition<Dim>::sort_along_cells(Particles<Dim>& particles) const {
  std::vector<int> cell(static_cast<std::size_t>(particles.owned));
  for (std::size_t i = 0; i < cell.size(); ++i) cell[i] = fine_.cell(particles.position[i]);
  const auto before = [&](int a, int b) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return cell[i] != cell[j] ? cell[i] < cell[j] : particles.id[i] < particles.id[j];
  };
  std::vector<int> order(cell.size());
  std::iota(order.begin(), order.end(), 0);
  if (std::ranges::is_sorted(order, before)) return;
  std::ranges::sort(order, before);
  particles.reorder(order);
}

template <int Dim>
void Decomposition<Dim>::build_halo(Particles<Dim>& particles) {
  particles.resize(particles.owned);
  PetscInt first_row = 0;
  const PetscInt owned = particles.owned;
  MPI_Exscan(&owned, &first_row, 1, MPIU_INT, MPI_SUM, comm_);

  // What is sent, by destination and then in the order of the owned particles.
  std::vector<std::tuple<int, int, int>> sends;  // (destination, index, target)
  for (int i = 0; i < particles.owned; ++i) {
    const auto cell = static_cast<std::size_t>(cells_.cell(particles.position[static_cast<std::size_t>(i)]));
    for (int t = target_start_[cell]; t < target_start_[cell + 1]; ++t)
      sends.emplace_back(targets_[static_cast<std::size_t>(t)].rank, i, t);
  }
  std::sort(sends.begin(), sends.end());
  std::vector<std::pair<int, int>> runs;
  std::vector<int> index;
  std::vector<Vector<Dim>> shifts;
  std::vector<HaloRecord> packed;
  for (const auto& [rank, i, target] : sends) {
    if (runs.empty() || runs.back().first != rank) runs.emplace_back(rank, 0);
    ++runs.back().second;
    index.push_back(i);
    shifts.push_back(targets_[static_cast<std::size_t>(target)].shift);
    packed.push_back({particles.record(i), first_row + i});
    packed.back().particle.position += shifts.back();
  }
  halo_ = Halo(Exchange(comm_, runs), std::move(index));
  halo_shift_ = std::move(shifts);

  std::vector<HaloRecord> received(static_cast<std::size_t>(halo_.exchange().n_receive()));
  halo_.exchange().forward(packed.data(), received.data());
  particles.resize(particles.owned + halo_.exchange().n_receive());
  rows_.resize(static_cast<std::size_t>(particles.size()));
  std::iota(rows_.begin(), rows_.begin() + particles.owned, first_row);
  for (std::size_t k = 0; k < received.size(); ++k) {
    const auto at = static_cast<std::size_t>(particles.owned) + k;
    particles.set_record(static_cast<int>(at), received[k].particle);
    rows_[at] = received[k].row;
  }
}

template <int Dim>
void Decomposition<Dim>::refresh_positions(Particles<Dim>& particles) const {
  std::vector<Vector<Dim>> packed(halo_shift_);
  for (std::size_t k = 0; k < packed.size(); ++k)
    packed[k] += particles.position[static_cast<std::size_t>(halo_.index()[k])];
  halo_.exchange().forward(packed.data(), particles.position.data() + particles.owned);
}

template void add_work(const CellGrid<2>&, const Particles<2>&, std::span<int>);
template void add_work(const CellGrid<3>&, const Particles<3>&, std::span<int>);
template std::vector<int> distribute_cells(MPI_Comm, const CellGrid<2>&, std::span<const int>, int, Partitioner);
template std::vector<int> distribute_cells(MPI_Comm, const CellGrid<3>&, std::span<const int>, int, Partitioner);
template void append_halo_targets(const CellGrid<2>&, std::span<const int>, int, std::vector<HaloTarget<2>>&);
template void append_halo_targets(const CellGrid<3>&, std::span<const int>, int, std::vector<HaloTarget<3>>&);
template class Decomposition<2>;
template class Decomposition<3>;

}  // namespace impinge
