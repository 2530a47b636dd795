#include "impinge/programs/program_directory.hpp"

namespace impinge {

std::filesystem::path program_directory() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

}  // namespace impinge
