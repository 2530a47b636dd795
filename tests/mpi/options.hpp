#pragma once
// PETSc options for the length of a test.

#include "impinge/core/petsc.hpp"

namespace impinge {

/// The option of the database while it lives.
class Option {
 public:
  Option(const char* name, const char* value) : name_(name) { petsc_check(PetscOptionsSetValue(nullptr, name, value)); }
  ~Option() { PetscOptionsClearValue(nullptr, name_); }

 private:
  const char* name_;
};

}  // namespace impinge
