#pragma once
// The phases of a step, and the error of a step that could not be completed.

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "impinge/core/petsc.hpp"

namespace impinge {

enum class Phase { predict, redistribute, neighbours, density, assembly, set_up, solve, correct, totals };

/// Their names, in -log_view and in messages.
inline constexpr std::array phase_names{"Predict",    "Redistribute", "Neighbours", "Density", "PPE assembly",
                                        "PPE set-up", "PPE solve",    "Correct",    "Totals"};
constexpr const char* name_of(Phase phase) { return phase_names[static_cast<std::size_t>(phase)]; }

/// Attributes the time between construction and destruction to a phase.
class PhaseLog {
 public:
  explicit PhaseLog(Phase phase);

 private:
  LogStage stage_;
};

/// A step that could not be completed: divergence of the flow or of the linear solver. Thrown by all ranks. Exit 3.
class SolveError : public std::runtime_error {
 public:
  SolveError(std::int64_t step, Phase phase, const std::string& reason);
  std::int64_t step() const { return step_; }
  Phase phase() const { return phase_; }

 private:
  std::int64_t step_;
  Phase phase_;
};

}  // namespace impinge
