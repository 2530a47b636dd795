#pragma once
// Errors of the input and of files. SolveError is in method/phase.hpp.

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace impinge {

/// The text with control characters other than line ends and tabs as \u001b: what others' files say may not steer the
/// terminal.
std::string printable(std::string_view text);

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
  explicit FileError(std::string_view message) : std::runtime_error(printable(message)) {}
};

}  // namespace impinge
