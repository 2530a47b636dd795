// Scenes with walls and inlets in three dimensions, from case files.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "impinge/cases/case.hpp"
#include "impinge/core/errors.hpp"
#include "impinge/geometry/mesh_file.hpp"
#include "impinge/scenes/scenes.hpp"

namespace impinge {
namespace {

const std::string head =
    "geometry = \"scene\"\ndimension = 3\nparticles.spacing = 0.1\ntime = {end = 1, dt = 1e-3}\n"
    "[[fluid.region]]\nshape = \"box\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\n";

Case parse(const std::string& text) { return parse_case({{"case.toml", head + text}}); }

std::vector<std::string> mistakes(const std::string& text) {
  try {
    parse(text);
  } catch (const InputError& error) {
    return error.mistakes();
  }
  return {};
}

/// The only mistake that a text has.
std::string mistake(const std::string& text) {
  const auto found = mistakes(text);
  EXPECT_EQ(found.size(), 1u);
  return found.empty() ? "" : found[0];
}

void expect_has(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

std::int64_t count(const Scene<3>& scene, ParticleType type) {
  Particles<3> particles;
  scene.fill(0, 1, particles);
  return std::ranges::count(particles.type, type);
}

TEST(SceneInSpace, ShapesAreWalls) {
  const Case config = parse(
      "[[wall]]\nshape = \"box\"\nlow = [0, 0, 0]\nhigh = [1, 1, 2]\nwet = \"inside\"\n"
      "[[wall]]\nshape = \"cylinder\"\nbegin = [0.5, 0.5, 0.0]\nend = [0.5, 0.5, 0.4]\nradius = 0.2\n"
      "[[wall]]\nshape = \"polygon\"\npoints = [[0, 0, 1.5], [1, 0, 1.5], [0, 1, 1.5]]\naxis = [0, 0, 1]\nrotate = 90\n"
      "about = [0.5, 0.5, 0]\n");
  const Scene<3> scene = make_scene<3>(config, config);
  ASSERT_EQ(scene.walls.size(), 3u);
  EXPECT_TRUE(scene.walls[0].wet_back && !scene.walls[0].wet_front);
  EXPECT_TRUE(scene.walls[2].wet_back && scene.walls[2].wet_front);
  EXPECT_NEAR(scene.walls[2].surface->bounds().low[0], 0.0, 1e-12);
  EXPECT_NEAR(scene.walls[2].surface->nearest({{1.0, 1.0, 1.5}}).distance, 0.0, 1e-12);
  const double solid = 0.4 * 0.04 * std::numbers::pi;
  EXPECT_NEAR(static_cast<double>(count(scene, ParticleType::fluid)) * 1e-3, 1.0 - solid, 4e-3);
  // No wall particle stands under the cylinder.
  for (const WallPoint<3>& point : scene.wall_points) {
    if (point.position[2] < 0.05) {
      EXPECT_GT(std::hypot(point.position[0] - 0.5, point.position[1] - 0.5), 0.15);
    }
  }
}

TEST(SceneInSpace, ADrumThatTurnsNeedsNoMoreRoomThanItsOwn) {
  const auto found = [](double room) {
    return mistakes(fmt::format(
        "[[wall]]\nname = \"drum\"\nshape = \"cylinder\"\nbegin = [0.5, 0.5, -0.5]\nend = [0.5, 0.5, 1.5]\n"
        "radius = 1\nwet = \"inside\"\nmotion = \"turn\"\n[[motion]]\nname = \"turn\"\ntype = \"constant\"\n"
        "center = [0.5, 0.5, 0]\nspin = 360\n[domain]\nlow = [{0}, {0}, -1]\nhigh = [{1}, {1}, 2]\n",
        0.5 - room, 0.5 + room));
  };
  EXPECT_EQ(found(1.11), std::vector<std::string>{});
  ASSERT_EQ(found(1.09).size(), 1u);
  expect_has(found(1.09)[0], "the wall reaches from x = -0.5 to 1.5 m");
}

TEST(SceneInSpace, WhatIsWrongWithAWallIsTold) {
  expect_has(mistake("[[wall]]\nshape = \"polyline\"\npoints = [[0, 0, 0], [1, 0, 0]]\n"), "have two dimensions");
  expect_has(mistake("[[wall]]\nshape = \"polygon\"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]]\n"),
             "off the plane of the others");
  expect_has(mistake("[[wall]]\nshape = \"polygon\"\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\nwet = \"left\"\n"),
             "an open surface has no such side; allowed: \"front\", \"back\", \"both\"");
  expect_has(mistake("[[wall]]\nshape = \"cone\"\nbegin = [0, 0, 0]\nend = [0, 0, 0]\nradius = 1\n"),
             "begins where it ends");
  expect_has(mistake("[[wall]]\nshape = \"mesh\"\nfile = \"none.stl\"\n"), "cannot read none.stl");
  expect_has(mistake("[[wall]]\nshape = \"mesh\"\nfile = \"none.step\"\n"), "allowed: .stl, .obj, .ply");
}

TEST(SceneInSpace, RoundInletsHoldTheirVolume) {
  const std::string place = "center = [3, 0, 0]\ndirection = [0, 1, 1]\nspeed = 1\n";
  for (const auto& [section, area] :
       {std::pair(std::string("section = \"circle\"\nradius = 0.7\n"), 0.49 * std::numbers::pi),
        std::pair(std::string("section = \"annulus\"\nradius = 0.7\ninner_radius = 0.3\n"), 0.4 * std::numbers::pi),
        std::pair(std::string("section = \"rectangle\"\nwidth = 1.03\nheight = 0.48\nacross = [1, 0, 0]\n"), 0.4944)}) {
    const Case config = parse(fmt::format("[[inlet]]\n{}{}", section, place));
    const Scene<3> scene = make_scene<3>(config, config);
    const Inlet<3>& inlet = scene.inlets.at(0);
    EXPECT_NEAR(area * inlet.spacing, static_cast<double>(inlet.section.size()) * 1e-3, 1e-12) << section;
    EXPECT_NEAR(inlet.spacing, 0.1, 0.01);
    // No two particles of the rows are nearer to each other than two thirds of a spacing, and none is outside.
    Particles<3> particles;
    scene.fill(0, 1, particles);
    double least = 1.0;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      if (particles.type[i] != ParticleType::inlet) continue;
      EXPECT_EQ(inlet.distance_from_block(particles.position[i]), 0.0);
      for (std::size_t j = 0; j < i; ++j)
        if (particles.type[j] == ParticleType::inlet)
          least = std::min(least, norm(particles.position[i] - particles.position[j]));
    }
    EXPECT_GT(least, 0.066) << section;
  }
}

TEST(SceneInSpace, WhatIsWrongWithAnInletIsTold) {
  const std::string inlet = "[[inlet]]\ncenter = [3, 0, 0]\ndirection = [1, 0, 0]\nspeed = 1\n";
  expect_has(mistake(inlet + "section = \"circle\"\nradius = 0.04\n"), "less than a particle wide");
  expect_has(mistake(inlet + "section = \"annulus\"\nradius = 0.5\ninner_radius = 0.5\n"),
             "not wider than its inner radius");
  expect_has(mistake(inlet + "section = \"rectangle\"\nwidth = 1\nheight = 1\nacross = [2, 0, 0]\n"), "along the flow");
  const std::string round = inlet + "section = \"circle\"\nradius = 0.5\n";
  expect_has(mistake(round + "[[inlet]]\ncenter = [3, 0.8, 0]\ndirection = [1, 0, 0]\nspeed = 1\nsection = \"circle\"\n"
                             "radius = 0.5\n"),
             "its rows overlap those of the inlet \"inlet_1\"");
  expect_has(mistake(round + "[[wall]]\nshape = \"box\"\nlow = [3.1, -1, -1]\nhigh = [4, 1, 1]\n"),
             "blows into the wall");
  expect_has(mistake(round + "[[wall]]\nshape = \"box\"\nlow = [2.8, -1, -1]\nhigh = [2.9, 1, 1]\n"),
             "the inlet is cut by the wall \"wall_1\"");
}

class MeshFile : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() / ("impinge_mesh_" + std::to_string(getpid()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::string path = directory_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  /// A cube of an edge, as STL with one facet after the other.
  static std::string cube(double edge) {
    const Facets box = box_facets({}, {{edge, edge, edge}});
    std::string text = "solid cube\n";
    for (const Facet& facet : box.facets) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int corner : facet) {
        const Vector<3>& x = box.points[static_cast<std::size_t>(corner)];
        text += fmt::format("vertex {} {} {}\n", x[0], x[1], x[2]);
      }
      text += "endloop\nendfacet\n";
    }
    return text + "endsolid cube\n";
  }

  std::filesystem::path directory_;
};

TEST_F(MeshFile, IsTheSameWallAsAShape) {
  write("cube.stl", cube(20.0));
  const std::string wall =
      "[[wall]]\nname = \"tank\"\nshape = \"mesh\"\nfile = \"cube.stl\"\nscale = 0.1\nwet = \"inside\"\n";
  const Case config = parse_case(load_case_files(write("case.toml", head + wall)));
  const Scene<3> scene = make_scene<3>(config, config);
  EXPECT_TRUE(scene.walls.at(0).surface->closed());
  EXPECT_NEAR(scene.walls[0].surface->volume(), 8.0, 1e-6);
  EXPECT_EQ(scene.walls[0].surface->patches().size(), 6u);
  // A run stores where the file is and what it held.
  const NamedText stored{"x_00000007.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  EXPECT_TRUE(are_of_one_run(stored, stored));
  write("cube.stl", cube(21.0));
  EXPECT_THROW(parse_restart(stored, {}, "out"), FileError);
}

TEST_F(MeshFile, MayHoldFluidOrSwallowIt) {
  write("cube.stl", cube(20.0));
  const std::string shape = "shape = \"mesh\"\nfile = \"cube.stl\"\nscale = 0.05\ntranslate = [3, 0, 0]\n";
  const auto parsed = [&](const std::string& text) {
    return parse_case(load_case_files(write("case.toml", head + text)));
  };
  const Case config = parsed("[[fluid.region]]\n" + shape + "[[outlet]]\n" + shape);
  const Scene<3> scene = make_scene<3>(config, config);
  EXPECT_EQ(count(scene, ParticleType::fluid), 2000);
  EXPECT_TRUE(scene.outlets.at(0).has_passed({{3.1, 0.9, 0.9}}));
  EXPECT_FALSE(scene.outlets[0].has_passed({{2.9, 0.9, 0.9}}));
  const NamedText stored{"x_00000007.checkpoint", config.resolved_text};
  EXPECT_NO_THROW(parse_restart(stored, {"time.end=2"}, "out"));
  // Without one of its facets it has no inside.
  std::string open = cube(20.0);
  open.erase(open.rfind("facet normal"));
  write("cube.stl", open + "endsolid cube\n");
  try {
    parsed("[[fluid.region]]\n" + shape);
    ADD_FAILURE();
  } catch (const InputError& error) {
    ASSERT_EQ(error.mistakes().size(), 1u);
    expect_has(error.mistakes()[0], "fluid.region[2].shape = \"mesh\": the surface has an end, and no inside");
  }
  write("cube.stl", cube(21.0));
  EXPECT_THROW(parse_restart(stored, {}, "out"), FileError);
}

TEST_F(MeshFile, MayBeObjOrPly) {
  const std::string object = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
  const std::string polygons =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
  write("sheet.obj", object);
  write("sheet.ply", polygons);
  for (const std::string name : {"sheet.obj", "sheet.ply"}) {
    const std::string wall = fmt::format("[[wall]]\nshape = \"mesh\"\nfile = \"{}\"\ntranslate = [0, 0, -0.5]\n", name);
    const Case config = parse_case(load_case_files(write("case.toml", head + wall)));
    const Scene<3> scene = make_scene<3>(config, config);
    EXPECT_NEAR(scene.walls.at(0).surface->area(), 1.0, 1e-6) << name;
    EXPECT_FALSE(scene.walls[0].surface->closed());
  }
}

TEST_F(MeshFile, WithAWrongHeaderIsRefused) {
  std::vector<std::string> mistakes;
  EXPECT_FALSE(read_facets("a.ply", "ply\nformat ascii 1.0\n[[time]]\nend = 1\n", mistakes));
  EXPECT_FALSE(read_facets("a.ply", "ply\nformat ascii 1.0\n", mistakes));
  ASSERT_EQ(mistakes.size(), 2u);
  EXPECT_NE(mistakes[0].find("line 3 is none of the header of a PLY file"), std::string::npos) << mistakes[0];
  EXPECT_NE(mistakes[1].find("there is no end_header"), std::string::npos) << mistakes[1];
}

// Materials make no walls: their file, which may be a pipe, is not opened.
TEST_F(MeshFile, OpensNoFileThatItNames) {
  const std::string path = write("a.mtl", "newmtl a\n");
  const int events = inotify_init1(IN_NONBLOCK);
  ASSERT_GE(inotify_add_watch(events, path.c_str(), IN_OPEN), 0);
  std::vector<std::string> mistakes;
  EXPECT_TRUE(read_facets("a.obj", "mtllib " + path + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", mistakes));
  char event[4096];
  EXPECT_EQ(read(events, event, sizeof event), -1);
  close(events);
}

TEST_F(MeshFile, ThatIsDamagedIsToldByItsName) {
  for (const auto& [name, text] :
       {std::pair("half.stl", cube(1.0).substr(0, 300)), std::pair("noise.ply", std::string("ply\nxyz")),
        std::pair("empty.obj", std::string("v 0 0 0\n"))}) {
    write(name, text);
    const std::string wall = fmt::format("[[wall]]\nshape = \"mesh\"\nfile = \"{}\"\n", name);
    try {
      parse_case(load_case_files(write("case.toml", head + wall)));
      ADD_FAILURE() << name;
    } catch (const InputError& error) {
      ASSERT_EQ(error.mistakes().size(), 1u) << name;
      expect_has(error.mistakes()[0], "wall[1].");
    }
  }
}

}  // namespace
}  // namespace impinge
