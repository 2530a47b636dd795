#include "impinge/core/petsc.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace impinge {
namespace {

// What PETSc said about the last error, the first message of a chain.
std::string last_message;

PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                            const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) last_message = message ? message : "";
  return code;
}

}  // namespace

void petsc_check(PetscErrorCode code, std::source_location place) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw PetscFailure(fmt::format("PETSc error {} ({}) at {}:{}: {}", code, text ? text : "unknown", place.file_name(),
                                 place.line(), last_message));
}

PetscSession::PetscSession(const char* program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  int count = static_cast<int>(words.size());
  char** values = pointers.data();
  petsc_check(PetscInitialize(&count, &values, nullptr, nullptr));
  petsc_check(PetscPushErrorHandler(keep_message, nullptr));
  for (const std::string& option : unused_petsc_options()) {
    if (std::ranges::find(arguments, option) != arguments.end()) continue;
    PetscBool given = PETSC_FALSE;
    petsc_check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));  // it now counts as used
    options_from_elsewhere_.push_back(option);
  }
}

PetscSession::~PetscSession() {
  PetscPopErrorHandler();
  // PETSc's own warning of unused options would name the solver's defaults too; see unused_petsc_options.
  PetscOptionsSetValue(nullptr, "-options_left", "no");
  PetscFinalize();
}

std::vector<std::string> unused_petsc_options() {
  PetscInt count = 0;
  char** names = nullptr;
  char** values = nullptr;
  petsc_check(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  std::vector<std::string> unused;
  for (PetscInt k = 0; k < count; ++k) unused.push_back(fmt::format("-{}", names[k]));
  petsc_check(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return unused;
}

bool set_default_option(const std::string& option, const std::string& value) {
  PetscBool given = PETSC_FALSE;
  petsc_check(PetscOptionsHasName(nullptr, nullptr, option.c_str(), &given));
  if (given) return false;
  petsc_check(PetscOptionsSetValue(nullptr, option.c_str(), value.c_str()));
  return true;
}

std::string petsc_version() {
  PetscInt major = 0, minor = 0, subminor = 0;
  petsc_check(PetscGetVersionNumber(&major, &minor, &subminor, nullptr));
  return fmt::format("{}.{}.{}", major, minor, subminor);
}

PetscLogStage LogStage::register_stage(const char* name) {
  PetscLogStage stage = -1;
  petsc_check(PetscLogStageGetId(name, &stage));
  if (stage < 0) petsc_check(PetscLogStageRegister(name, &stage));
  return stage;
}

}  // namespace impinge
