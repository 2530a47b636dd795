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
    const Vector<Dim> begin = vector_of<Dim>(one.begin), end = vector_of<Dim>(one.end), way = end - begin;
    Section section{.name = one.name, .middle = 0.5 * (begin + end), .across = {}};
    if constexpr (Dim == 2) {
      section.across = -1.0 / norm(way) * turned_left(way);
      section.inverse = {1.0 / dot(way, way) * way};
    } else {
      const Vector<3> side = vector_of<3>(one.side), area = cross(way, side);
      section.middle += 0.5 * side;
      section.across = 1.0 / norm(area) * area;
      section.inverse = {1.0 / dot(area, area) * cross(side, area), 1.0 / dot(area, area) * cross(area, way)};
    }
    sections_.push_back(section);
  }
  remember(particles);
}

template <int Dim>
double Sections<Dim>::volume() const {
  return Dim == 2 ? spacing_ * spacing_ : spacing_ * spacing_ * spacing_;
}

template <int Dim>
bool Sections<Dim>::is_near(const Vector<Dim>& position, double width) const {
  return std::ranges::any_of(sections_, [&](const Section& section) {
    const Vector<Dim> offset = offsets_(section.middle, position);
    return std::abs(dot(offset, section.across)) < width * spacing_ &&
           std::ranges::all_of(section.inverse, [&](const Vector<Dim>& along) {
             return std::abs(dot(offset, along)) < 0.5 + width * spacing_ * norm(along);
           });
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
    columns.push_back(fmt::format("{} [m^{}/s]", section.name, Dim));
    columns.push_back(fmt::format("total_{} [m^{}]", section.name, Dim));
  }
  return columns;
}

template <int Dim>
void Sections<Dim>::go_on(double time, const std::vector<double>& values) {
  since_ = time;
  for (std::size_t k = 0; k < sections_.size(); ++k) sections_[k].total = std::llround(values[2 * k + 1] / volume());
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
      if (!std::ranges::all_of(section.inverse, [&](const Vector<Dim>& along) {
            const double at = dot(begin, along) + share * dot(way, along);
            return at >= -0.5 && at < 0.5;
          }))
        continue;
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
  std::vector<double> values;
  for (std::size_t k = 0; k < sections_.size(); ++k) {
    sections_[k].total += crossings[k];
    values.push_back(time > since_ ? static_cast<double>(crossings[k]) * volume() / (time - since_) : 0.0);
    values.push_back(static_cast<double>(sections_[k].total) * volume());
  }
  since_ = time;
  return values;
}

template class Sections<2>;
template class Sections<3>;

}  // namespace impinge
