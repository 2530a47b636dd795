#include "impinge/io/series.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "impinge/io/run_directory.hpp"
#include "impinge/io/snapshot_layout.hpp"

namespace impinge {
namespace {

/// A text within XML.
std::string in_xml(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

/// XDMF's words for a type of number.
template <class Number>
constexpr const char* number_type = nullptr;
template <>
constexpr const char* number_type<double> = R"(NumberType="Float" Precision="8")";
template <>
constexpr const char* number_type<std::uint8_t> = R"(NumberType="UChar")";
template <>
constexpr const char* number_type<std::int64_t> = R"(NumberType="Int" Precision="8")";
template <>
constexpr const char* number_type<std::int32_t> = R"(NumberType="Int" Precision="4")";

/// The numbers of a dataset that holds values of type T.
template <class T>
std::string data_item(const std::string& file, const std::string& dataset, std::int64_t rows) {
  constexpr int columns = Stored<T>::columns;
  return fmt::format(R"(<DataItem Format="HDF" Dimensions="{}{}" {}>{}:{}</DataItem>)", rows,
                     columns > 1 ? fmt::format(" {}", columns) : "", number_type<typename Stored<T>::Number>,
                     in_xml(file), dataset);
}

template <class T>
std::string attribute(const std::string& file, const char* name, std::int64_t rows) {
  return fmt::format(R"(      <Attribute Name="{}" AttributeType="{}" Center="Node">{}</Attribute>
)",
                     name, Stored<T>::columns > 1 ? "Vector" : "Scalar", data_item<T>(file, dataset_path(name), rows));
}

}  // namespace

Series::Series(std::string xdmf_path, std::string file_series_path, std::string name)
    : xdmf_path_(std::move(xdmf_path)), file_series_path_(std::move(file_series_path)), name_(std::move(name)) {}

void Series::add(const std::string& file, double time, std::int64_t particles) {
  if (entries_.empty() || entries_.back().file != file) entries_.push_back({file, time, particles});
}

void Series::write() const {
  std::string grids;
  for (const Entry& entry : entries_) {
    grids += fmt::format(R"(    <Grid Name="{}">
      <Time Value="{:.17g}"/>
      <Topology TopologyType="Polyvertex" NumberOfElements="{}"/>
      <Geometry GeometryType="XYZ">{}</Geometry>
)",
                         in_xml(name_), entry.time, entry.particles,
                         data_item<Vector<3>>(entry.file, points_path, entry.particles));
    for_fields<3>([&]<class T>(const Field<3, T>& field) {
      if (field.is_in_series && dataset_path(field.name) != points_path)
        grids += attribute<T>(entry.file, field.name, entry.particles);
    });
    grids += attribute<std::int32_t>(entry.file, rank_name, entry.particles) + "    </Grid>\n";
  }
  write_text(xdmf_path_, fmt::format(R"(<?xml version="1.0"?>
<Xdmf Version="3.0">
  <Domain>
  <Grid GridType="Collection" CollectionType="Temporal">
{}  </Grid>
  </Domain>
</Xdmf>
)",
                                     grids));
  write_file_series();
}

// ParaView's format 1.0 of a file series.
void Series::write_file_series() const {
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const Entry& entry : entries_) files.push_back({{"name", entry.file}, {"time", entry.time}});
  write_text(file_series_path_,
             nlohmann::ordered_json{{"file-series-version", "1.0"}, {"files", files}}.dump(1) + "\n");
}

}  // namespace impinge
