#include "impinge/parallel/decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace impinge {
namespace {

/// The work of the owned particles, cell by cell along the curve. Particles outside the cells count for nothing.
template <int Dim>
std::vector<CellWork> work_along(const CellCurve<Dim>& curve, const CellGrid<Dim>& cells,
                                 const Particles<Dim>& particles) {
  std::vector<CellWork> work;
  std::int64_t last = -1;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    const std::int64_t cell = cells.cell(cells.wrapped(particles.position[i]));
    if (cell < 0) continue;
    if (cell != last) work.push_back({curve.key(cells.coordinates(cell)), 0});
    work.back().work += work_of(1, has_row(particles.type[i]));
    last = cell;
  }
  merge_keys(work, [](CellWork& to, const CellWork& from) { to.work += from.work; });
  return work;
}

}  // namespace

template <int Dim>
void append_halo_targets(const CellGrid<Dim>& cells, const CellOwners<Dim>& owner, std::int64_t cell,
                         std::vector<HaloTarget<Dim>>& targets) {
  const auto first = static_cast<std::ptrdiff_t>(targets.size());
  const HaloTarget<Dim> self{owner(cell), {}};
  for_cells_around(cells, cell, 1, [&](std::int64_t neighbour, const Vector<Dim>& shift) {
    const HaloTarget<Dim> target{owner(neighbour), shift};
    if (target == self || std::find(targets.begin() + first, targets.end(), target) != targets.end()) return;
    targets.push_back(target);
  });
}

template <int Dim>
Decomposition<Dim>::Decomposition(MPI_Comm comm, const Box<Dim>& box, const std::array<bool, Dim>& periodic,
                                  double reach, Partitioner partitioner)
    : comm_(comm),
      cells_(box, periodic, reach),
      fine_(cells_.refined(cell_parts)),
      partitioner_(partitioner),
      owner_(cells_) {
  forget_targets();
}

template <int Dim>
void Decomposition<Dim>::partition(const Particles<Dim>& particles) {
  const int ranks = ranks_of(comm_);
  std::vector<CellWork> work;
  if (ranks > 1) work = work_along(owner_.curve(), cells_, particles);
  set_owners(distribute_cells<Dim>(comm_, cells_, work, ranks, partitioner_));
}

template <int Dim>
void Decomposition<Dim>::set_owners(Cut cut) {
  owner_ = CellOwners<Dim>(cells_, std::move(cut.segments));
  achieved_imbalance_ = cut.imbalance;
  ++partitions_;
  forget_targets();
}

template <int Dim>
void Decomposition<Dim>::forget_targets() {
  seen_.clear();
  target_start_.assign(1, 0);
  targets_.clear();
}

// Where in target_start_ the range of a cell of this rank begins.
template <int Dim>
std::size_t Decomposition<Dim>::place_of_targets(std::int64_t cell) {
  const auto place = static_cast<std::size_t>(seen_.insert(cell));
  if (place + 1 == target_start_.size()) {
    append_halo_targets<Dim>(cells_, owner_, cell, targets_);
    target_start_.push_back(targets_.size());
  }
  return place;
}

template <int Dim>
double Decomposition<Dim>::imbalance(const Particles<Dim>& particles) const {
  std::int64_t rows = 0;
  for (int i = 0; i < particles.owned; ++i) rows += has_row(particles.type[static_cast<std::size_t>(i)]);
  const auto work = static_cast<double>(work_of(particles.owned, rows));
  const double total = sum_over_ranks(comm_, work);
  return total > 0.0 ? max_over_ranks(comm_, work) * ranks_of(comm_) / total : 1.0;
}

template <int Dim>
bool Decomposition<Dim>::owns(const Vector<Dim>& position) const {
  const std::int64_t cell = cells_.cell(cells_.wrapped(position));
  return cell >= 0 && owner_(cell) == rank_of(comm_);
}

template <int Dim>
std::size_t Decomposition<Dim>::bytes() const {
  return owner_.bytes() + seen_.bytes() + target_start_.capacity() * sizeof(std::size_t) +
         targets_.capacity() * sizeof(HaloTarget<Dim>);
}

template <int Dim>
Strays Decomposition<Dim>::migrate(Particles<Dim>& particles) {
  particles.resize(particles.owned);
  const int self = rank_of(comm_);
  if (seen_.size() > 2 * particles.owned + 1024) forget_targets();  // of cells that were left long ago
  Strays strays;
  std::vector<std::pair<int, ParticleRecord<Dim>>> leaving;
  int kept = 0, rank = self;
  std::int64_t last = -1;
  for (int i = 0; i < particles.owned; ++i) {
    ParticleRecord<Dim> record = particles.record(i);
    record.position = cells_.wrapped(record.position);
    const std::int64_t cell = cells_.cell(record.position);
    if (cell < 0) {
      ++(std::isfinite(norm(record.position)) ? strays.outside : strays.not_finite);
      continue;
    }
    if (cell != last) rank = owner_(cell);
    last = cell;
    if (rank == self) {
      particles.set_record(kept++, record);
    } else {
      leaving.emplace_back(rank, record);
    }
  }
  const std::vector<ParticleRecord<Dim>> received =
      exchange_items(comm_, std::span<const std::pair<int, ParticleRecord<Dim>>>(leaving));

  particles.owned = kept;
  particles.resize(kept);
  for (const auto& record : received) particles.append(record);
  sort_along_cells(particles);
  return strays;
}

template <int Dim>
void Decomposition<Dim>::sort_along_cells(Particles<Dim>& particles) const {
  std::vector<std::int64_t> cell(static_cast<std::size_t>(particles.owned));
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
  std::vector<std::tuple<int, int, std::size_t>> sends;  // (destination, index, target)
  std::int64_t last = -1;
  std::size_t place = 0;
  for (int i = 0; i < particles.owned; ++i) {
    const std::int64_t cell = cells_.cell(particles.position[static_cast<std::size_t>(i)]);
    if (cell != last) place = place_of_targets(cell);
    last = cell;
    for (std::size_t t = target_start_[place]; t < target_start_[place + 1]; ++t)
      sends.emplace_back(targets_[t].rank, i, t);
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
    shifts.push_back(targets_[target].shift);
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

template void append_halo_targets(const CellGrid<2>&, const CellOwners<2>&, std::int64_t, std::vector<HaloTarget<2>>&);
template void append_halo_targets(const CellGrid<3>&, const CellOwners<3>&, std::int64_t, std::vector<HaloTarget<3>>&);
template class Decomposition<2>;
template class Decomposition<3>;

}  // namespace impinge
