#pragma once
// Files that could not be written or read.

#include <stdexcept>

namespace impinge {

/// A file could not be written or read; the message names it and the reason. Thrown by all ranks. Exit 1.
class OutputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace impinge
