#pragma once
// Where the running program stands, and with it what is built and installed beside it.

#include <filesystem>

namespace impinge {

/// The directory of the running program. Throws std::filesystem::filesystem_error.
std::filesystem::path program_directory();

}  // namespace impinge
