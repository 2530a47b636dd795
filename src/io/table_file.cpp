#include "impinge/io/table_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <utility>

#include "impinge/core/errors.hpp"
#include "impinge/io/run_directory.hpp"

namespace impinge {
namespace {

namespace fs = std::filesystem;

/// The next line of a file; false at its end and for a line that was broken off.
bool next_line(std::ifstream& file, std::string& line) { return std::getline(file, line) && !file.eof(); }

/// The number that a row begins with; -1 where it is none.
std::int64_t step_of(const std::string& row) {
  std::int64_t step = -1;
  std::from_chars(row.data(), row.data() + row.size(), step);
  return step;
}

}  // namespace

TableFile::TableFile(std::string path, std::string header) : path_(std::move(path)), header_(std::move(header)) {}

void TableFile::create() {
  open(std::ios::trunc);
  write(header_);
}

std::int64_t TableFile::resume(std::int64_t step) {
  std::error_code error;
  if (fs::exists(path_, error) && !fs::is_regular_file(path_, error))  // a pipe may have no end
    throw FileError(fmt::format("cannot continue {}: it is no regular file", path_));
  std::string text = header_ + '\n';
  std::int64_t rows = 0;
  std::int64_t last = -1;
  std::ifstream old(path_);
  std::string line;
  if (next_line(old, line) && line != header_)
    throw FileError(fmt::format("cannot continue {}: its columns are {}, not {}", path_, line, header_));
  while (next_line(old, line)) {
    const std::int64_t next = step_of(line);
    if (next <= last || next > step) break;
    last = next;
    text += line + '\n';
    last_row_ = line;
    ++rows;
  }
  old.close();
  write_text(path_, text);
  open(std::ios::app);
  check();
  return rows;
}

void TableFile::append(const std::string& row) {
  if (file_.is_open() && file_) write(row);
}

void TableFile::check() const {
  if (!failure_.empty()) throw FileError(fmt::format("cannot write {}: {}", path_, failure_));
}

void TableFile::synchronise() const {
  check();
  if (const std::string reason = impinge::synchronise(path_); !reason.empty())
    throw FileError(fmt::format("cannot write {}: {}", path_, reason));
}

void TableFile::open(std::ios::openmode mode) {
  errno = 0;
  file_.open(path_, std::ios::out | mode);
  if (!file_) failure_ = std::strerror(errno);
}

void TableFile::write(const std::string& line) {
  errno = 0;
  file_ << line + '\n' << std::flush;
  if (!file_ && failure_.empty()) failure_ = std::strerror(errno);
}

}  // namespace impinge
