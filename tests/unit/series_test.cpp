// The time series of a run's snapshots.

#include "impinge/io/series.hpp"

#include <gtest/gtest.h>

#include <fstream>
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
  Series series(path("x.xmf"), "x");
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
  Series series(path("x.xmf"), R"(<a> & "b")");
  series.add(R"(<a> & "b"_00000001.vtkhdf)", 0.0, 1);
  const std::string text = text_of(series);
  EXPECT_NE(text.find(R"(<Grid Name="&lt;a&gt; &amp; &quot;b&quot;">)"), std::string::npos) << text;
  EXPECT_NE(text.find(R"(>&lt;a&gt; &amp; &quot;b&quot;_00000001.vtkhdf:/VTKHDF/Points<)"), std::string::npos) << text;
}

}  // namespace
}  // namespace impinge
