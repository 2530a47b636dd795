#pragma once
// The snapshots of a run as one time series: XDMF for ParaView and VisIt, and a file series for ParaView.

#include <cstdint>
#include <string>
#include <vector>

namespace impinge {

/// An XDMF file and a file series (JSON) that list snapshots of their own directory. No function is collective.
class Series {
 public:
  /// Paths of the XDMF file and of the file series; `name`: of the grids. Touches no file.
  Series(std::string xdmf_path, std::string file_series_path, std::string name);

  /// Adds a snapshot, named within the directory, unless it is the last one already. `time` [s].
  void add(const std::string& file, double time, std::int64_t particles);

  /// Writes both files: each complete under its name, or not at all. Throws FileError.
  void write() const;

 private:
  struct Entry {
    std::string file;
    double time;
    std::int64_t particles;
  };

  void write_file_series() const;

  std::string xdmf_path_;
  std::string file_series_path_;
  std::string name_;
  std::vector<Entry> entries_;
};

}  // namespace impinge
