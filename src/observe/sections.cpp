#include "impinge/observe/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "impinge/core/mpi.hpp"

namespace impinge {
namespace {

// A particle that crosses is within the first width afterwards and was within the second before: in a step it moves by
// less than their difference, and by less than the first [dp].
constexpr double width_after = 1.5;
constexpr double width_before = 3.5;

bool crosses(const ParticleType type) { return type == ParticleType::fluid || type == ParticleType::inlet; }

/// The items of all ranks. Collective.
template <class T>
std::vector<T> of_all_ranks(MPI_Comm comm, const std::vector<T>& own) {
  const int bytes = static_cast<int>(own.size() * sizeof(T));
  std::vector<int> counts(static_cast<std::size_t>(ranks_of(comm))), starts(counts.size(), 0);
  MPI_Allgather(&bytes, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  for (std::size_t k = 1; k < counts.size(); ++k) starts[k] = starts[k - 1] + counts[k - 1];
  std::vector<T> all(static_cast<std::size_t>(starts.back() + counts.back()) / sizeof(T));
  MPI_Allgatherv(own.data(), bytes, MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, comm);
  return all;
}

}  // namespace

template <int Dim>
Sections<Dim>::Sections(MPI_Comm comm, const std::vector<SectionSettings>& settings, const Scene<Dim>& scene,
                        double spacing, const Particles<Dim>& particles, double time)
    : comm_(comm), spacing_(spacing), offsets_(scene), since_(time) {
  for (const SectionSettings& one : settings) {
    const Vector<Dim> begin = vector_of<Dim>(one.begin), end = vector_of<Dim>(one.end);
    Section section{.name = one.name, .middle = 0.5 * (begin + end), .along = {}, .across = {}};
    section.length = norm(end - begin);
    section.along = 1.0 / section.length * (end - begin);
    section.across[0] = section.along[1];
    section.across[1] = -section.along[0];
    sections_.push_back(section);
  }
  remember(particles);
}

template <int Dim>
bool Sections<Dim>::is_near(const Vector<Dim>& position, double width) const {
  return std::ranges::any_of(sections_, [&](const Section& section) {
    const Vector<Dim> offset = offsets_(section.middle, position);
    return std::abs(dot(offset, section.across)) < width * spacing_ &&
           std::abs(dot(offset, section.along)) < 0.5 * section.length + width * spacing_;
  });
}

template <int Dim>
void Sections<Dim>::remember(const Particles<Dim>& particles) {
  position_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i)
    if (crosses(particles.type[i]) && is_near(particles.position[i], width_before))
      position_[particles.id[i]] = particles.position[i];
}

template <int Dim>
std::vector<std::string> Sections<Dim>::columns() const {
  std::vector<std::string> columns;
  for (const Section& section : sections_) {
    columns.push_back(fmt::format("{} [m^2/s]", section.name));
    columns.push_back(fmt::format("total_{} [m^2]", section.name));
  }
  return columns;
}

template <int Dim>
void Sections<Dim>::go_on(double time, const std::vector<double>& values) {
  since_ = time;
  for (std::size_t k = 0; k < sections_.size(); ++k)
    sections_[k].total = std::llround(values[2 * k + 1] / (spacing_ * spacing_));
}

template <int Dim>
void Sections<Dim>::count(const Particles<Dim>& particles) {
  std::vector<std::size_t> near;
  bool is_known = true;
  for (std::size_t i = 0; i < static_cast<std::size_t>(particles.owned); ++i) {
    if (!crosses(particles.type[i]) || !is_near(particles.position[i], width_after)) continue;
    near.push_back(i);
    is_known &= position_.contains(particles.id[i]);
  }
  // A particle that is new here was on another rank, or new in the run.
  if (any_rank(comm_, !is_known)) {
    std::vector<Place> own;
    for (const auto& [id, position] : position_) own.push_back({id, position});
    for (const Place& place : of_all_ranks(comm_, own)) position_[place.id] = place.position;
  }
  for (const std::size_t i : near) {
    const auto before = position_.find(particles.id[i]);
    if (before == position_.end()) continue;
    const Vector<Dim> way = offsets_(before->second, particles.position[i]);
    for (Section& section : sections_) {
      const Vector<Dim> end = offsets_(section.middle, particles.position[i]);
      const Vector<Dim> begin = end - way;
      const double from = dot(begin, section.across), to = dot(end, section.across);
      if ((from < 0.0) == (to < 0.0)) continue;
      const double share = from / (from - to);
      const double at = dot(begin, section.along) + share * dot(way, section.along);
      if (at < -0.5 * section.length || at >= 0.5 * section.length) continue;
      section.crossings += to < 0.0 ? -1 : 1;
    }
  }
  remember(particles);
}

template <int Dim>
std::vector<double> Sections<Dim>::measure(double time) {
  std::vector<std::int64_t> crossings;
  for (Section& section : sections_) crossings.push_back(std::exchange(section.crossings, 0));
  MPI_Allreduce(MPI_IN_PLACE, crossings.data(), static_cast<int>(crossings.size()), MPI_INT64_T, MPI_SUM, comm_);
  const double volume = spacing_ * spacing_;
  std::vector<double> values;
  for (std::size_t k = 0; k < sections_.size(); ++k) {
    sections_[k].total += crossings[k];
    values.push_back(time > since_ ? static_cast<double>(crossings[k]) * volume / (time - since_) : 0.0);
    values.push_back(static_cast<double>(sections_[k].total) * volume);
  }
  since_ = time;
  return values;
}

template class Sections<2>;
template class Sections<3>;

}  // namespace impinge
