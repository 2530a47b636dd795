#include "impinge/petsc.hpp"

#include <fmt/format.h>

namespace impinge {

void check(PetscErrorCode code, std::source_location place) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw PetscFailure(
      fmt::format("{}:{}: PETSc error {}: {}", place.file_name(), place.line(), code, text ? text : "unknown"));
}

PetscLogStage LogStage::register_stage(const char* name) {
  PetscLogStage stage = -1;
  check(PetscLogStageGetId(name, &stage));
  if (stage < 0) check(PetscLogStageRegister(name, &stage));
  return stage;
}

}  // namespace impinge
