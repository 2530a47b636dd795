#include "impinge/core/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace impinge {

InputError::InputError(std::vector<std::string> mistakes)
    : std::runtime_error(fmt::format("{}", fmt::join(mistakes, "\n"))), mistakes_(std::move(mistakes)) {}

}  // namespace impinge
