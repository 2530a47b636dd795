#pragma once
// PETSc's error codes, object lifetimes and log stages in C++ terms.

#include <petscksp.h>
#include <petscsf.h>

#include <source_location>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace impinge {

/// A PETSc call that failed on this rank: an environment error or a bug, never a state of the numerics.
class PetscFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws PetscFailure, with the caller's place and PETSc's text, unless the code is 0. Not collective.
void petsc_check(PetscErrorCode code, std::source_location place = std::source_location::current());

/// What a function that PETSc calls back returns: 0, or PETSc's code where action() throws PetscFailure, which must not
/// pass through PETSc.
template <class Action>
PetscErrorCode code_of(Action&& action) {
  try {
    action();
  } catch (const PetscFailure& error) {
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_LIB, "%s", error.what());
  }
  return 0;
}

/// PETSc between construction and destruction, with these command-line words. PETSc's own error traces are silenced;
/// petsc_check() gives its message. Collective.
class PetscSession {
 public:
  PetscSession(const char* program, const std::vector<std::string>& arguments);
  ~PetscSession();
  PetscSession(const PetscSession&) = delete;
  PetscSession& operator=(const PetscSession&) = delete;

  /// Options that PETSC_OPTIONS or a .petscrc file gave, which may belong to another program: unused ones among them
  /// are no mistake.
  const std::vector<std::string>& options_from_elsewhere() const { return options_from_elsewhere_; }

 private:
  std::vector<std::string> options_from_elsewhere_;
};

/// Names of the options in the database that nothing has asked for yet.
std::vector<std::string> unused_petsc_options();

/// PETSc's version, "3.18.5".
std::string petsc_version();

/// Owns one PETSc object; destroy(&object) is PETSc's own function.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class PetscHandle {
 public:
  PetscHandle() = default;
  PetscHandle(PetscHandle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  PetscHandle& operator=(PetscHandle&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~PetscHandle() { reset(); }

  operator Object() const { return object_; }

  /// For PETSc's create functions. Destroys what was held before.
  Object* address() {
    reset();
    return &object_;
  }

  void reset() {
    if (object_ != nullptr) destroy(&object_);
    object_ = nullptr;
  }

 private:
  Object object_ = nullptr;
};

using PetscMatrix = PetscHandle<Mat, MatDestroy>;
using PetscVector = PetscHandle<::Vec, VecDestroy>;
using PetscSolver = PetscHandle<KSP, KSPDestroy>;
using PetscForest = PetscHandle<PetscSF, PetscSFDestroy>;

/// Sets an option, named with its dash, unless the user has; true if it did.
bool set_default_option(const std::string& option, const std::string& value);

/// Attributes the time between construction and destruction to one -log_view stage.
class LogStage {
 public:
  explicit LogStage(PetscLogStage stage) { PetscLogStagePush(stage); }
  ~LogStage() { PetscLogStagePop(); }
  LogStage(const LogStage&) = delete;
  LogStage& operator=(const LogStage&) = delete;

  static PetscLogStage register_stage(const char* name);
};

}  // namespace impinge
