#include "impinge/method/phase.hpp"

#include <fmt/format.h>

namespace impinge {
namespace {

PetscLogStage stage_of(Phase phase) {
  static const auto stages = [] {
    std::array<PetscLogStage, phase_names.size()> all{};
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = LogStage::register_stage(phase_names[k]);
    return all;
  }();
  return stages[static_cast<std::size_t>(phase)];
}

}  // namespace

PhaseLog::PhaseLog(Phase phase) : stage_(stage_of(phase)) {}

SolveError::SolveError(std::int64_t step, Phase phase, const std::string& reason)
    : std::runtime_error(fmt::format("step {}, phase {}: {}", step, name_of(phase), reason)),
      step_(step),
      phase_(phase) {}

}  // namespace impinge
