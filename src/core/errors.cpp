#include "impinge/core/errors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace impinge {

// The control characters of UTF-8 are the bytes below 0x20, 0x7f, and 0x80 to 0x9f behind 0xc2.
std::string printable(std::string_view text) {
  std::string result;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = [&](std::size_t place) {
      return place < text.size() ? static_cast<unsigned char>(text[place]) : 0u;
    };
    const bool is_long = byte(k) == 0xc2 && byte(k + 1) >= 0x80 && byte(k + 1) < 0xa0;
    if (is_long) ++k;
    if (is_long || byte(k) == 0x7f || (byte(k) < 0x20 && text[k] != '\n' && text[k] != '\t')) {
      result += fmt::format("\\u{:04x}", byte(k));
    } else {
      result += text[k];
    }
  }
  return result;
}

InputError::InputError(std::vector<std::string> mistakes)
    : std::runtime_error(printable(fmt::format("{}", fmt::join(mistakes, "\n")))), mistakes_(std::move(mistakes)) {
  for (std::string& mistake : mistakes_) mistake = printable(mistake);
}

}  // namespace impinge
