#pragma once
// Tables in CSV: the history of a run, and what is sampled step by step.

#include <cstdint>
#include <fstream>
#include <string>

namespace impinge {

/// A CSV file that grows by rows while a run goes on, and that a restarted run continues. The first column is the step.
/// Every row is whole and readable as soon as it is appended. No function is collective: one rank has the table.
class TableFile {
 public:
  /// `header`: names of the columns, separated by commas. Touches no file.
  TableFile(std::string path, std::string header);

  const std::string& path() const { return path_; }

  /// Begins the file anew, with the header alone. A failure is kept for check.
  void create();

  /// Continues the file after `step`: keeps its rows up to there. Returns how many it keeps. A missing file counts as
  /// one without rows. Throws FileError, also where the file has other columns.
  std::int64_t resume(std::int64_t step);

  /// The last row that resume has kept; empty if there is none.
  const std::string& last_row() const { return last_row_; }

  /// Appends a row, values separated by commas, if the table was created or resumed. A failure is kept for check.
  void append(const std::string& row);

  /// Throws FileError if any row so far could not be written.
  void check() const;

  /// Forces the rows so far to the disk. Throws FileError, also as check does.
  void synchronise() const;

 private:
  void open(std::ios::openmode mode);
  void write(const std::string& line);

  std::string path_;
  std::string header_;
  std::string last_row_;
  std::ofstream file_;
  std::string failure_;  // why a row could not be written
};

}  // namespace impinge
