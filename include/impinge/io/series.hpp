#pragma once
// The snapshots of a run as one time series, which ParaView and VisIt open.

#include <cstdint>
#include <string>
#include <vector>

namespace impinge {

/// An XDMF file that lists snapshots of its own directory. No function is collective.
class Series {
 public:
  /// `name`: of the grids. Touches no file.
  Series(std::string path, std::string name);

  /// Adds a snapshot, named within the directory, unless it is the last one already. `time` [s].
  void add(const std::string& file, double time, std::int64_t particles);

  /// Writes the file: complete under its name, or not at all. Throws FileError.
  void write() const;

 private:
  struct Entry {
    std::string file;
    double time;
    std::int64_t particles;
  };

  std::string path_;
  std::string name_;
  std::vector<Entry> entries_;
};

}  // namespace impinge
