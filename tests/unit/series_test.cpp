// The time series of a run's snapshots.

#include "impinge/io/series.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "shared_directory.hpp"

namespace impinge {
namespace {

class SeriesFile : public SharedDirectory {
 protected:
  std::string text_of(const Series& series) const {
    series.write();
    std::ostringstream all;
    all << std::ifstream(path("x.xmf")).rdbuf();
    return all.str();
  }
};

TEST_F(SeriesFile, NamesTheDatasetsOfASnapshot) {
  Series series(path("x.xmf"), path("x.vtkhdf.series"), "x");
  series.add("x_00000001.vtkhdf", 0.5, 7);
  series.add("x_00000001.vtkhdf", 0.5, 7);
  const std::string text = text_of(series);
  for (const char* part : {
           "<Domain>",
           R"(<Geometry GeometryType="XYZ"><DataItem Format="HDF" Dimensions="7 3" NumberType="Float" Precision="8">)"
           "x_00000001.vtkhdf:/VTKHDF/Points</DataItem>",
           R"(<Attribute Name="type" AttributeType="Scalar" Center="Node"><DataItem Format="HDF" Dimensions="7" )"
           R"(NumberType="UChar">x_00000001.vtkhdf:/VTKHDF/PointData/type</DataItem>)",
           R"(<Attribute Name="velocity" AttributeType="Vector")",
           R"(<Attribute Name="rank" AttributeType="Scalar")",
           R"(<Time Value="0.5"/>)",
       }) {
    const auto found = text.find(part);
    ASSERT_NE(found, std::string::npos) << part << "\n" << text;
    EXPECT_EQ(text.find(part, found + 1), std::string::npos) << part;
  }
  EXPECT_EQ(text.find("pressure_impulse"), std::string::npos);
}

TEST_F(SeriesFile, EscapesNames) {
  Series series(path("x.xmf"), path("x.vtkhdf.series"), R"(<a> & "b")");
  series.add(R"(<a> & "b"_00000001.vtkhdf)", 0.0, 1);
  const std::string text = text_of(series);
  EXPECT_NE(text.find(R"(<Grid Name="&lt;a&gt; &amp; &quot;b&quot;">)"), std::string::npos) << text;
  EXPECT_NE(text.find(R"(>&lt;a&gt; &amp; &quot;b&quot;_00000001.vtkhdf:/VTKHDF/Points<)"), std::string::npos) << text;
}

TEST_F(SeriesFile, ListsFilesWithTheirTimes) {
  const std::string name = R"(<ä> & "b"\)";
  Series series(path("x.xmf"), path("x.vtkhdf.series"), name);
  series.write();
  const auto list = [&] { return nlohmann::json::parse(std::ifstream(path("x.vtkhdf.series"))); };
  EXPECT_EQ(list()["files"], nlohmann::json::array());
  series.add(name + "_00000000.vtkhdf", 0.0, 1);
  series.add(name + "_00000009.vtkhdf", 0.1 + 0.2, 1);
  series.write();
  EXPECT_EQ(list()["file-series-version"], "1.0");
  ASSERT_EQ(list()["files"].size(), 2u);
  EXPECT_EQ(list()["files"][1]["name"], name + "_00000009.vtkhdf");
  EXPECT_EQ(list()["files"][1]["time"], 0.1 + 0.2);
}

}  // namespace
}  // namespace impinge
