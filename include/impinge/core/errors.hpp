#pragma once
// Errors of the input and of files. SolveError is in method/phase.hpp.

#include <stdexcept>
#include <string>
#include <vector>

namespace impinge {

/// Mistakes in the input, all of them, one message each ("file:line: key = value: what is wrong (range)"). Exit 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<std::string> mistakes);
  const std::vector<std::string>& mistakes() const { return mistakes_; }

 private:
  std::vector<std::string> mistakes_;
};

/// A file could not be written or read; the message names it and the reason. Thrown by all ranks. Exit 1.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace impinge
