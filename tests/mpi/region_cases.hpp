#pragma once
// Cases whose fluid is given by regions, solved tightly.

#include "impinge/cases/case.hpp"

namespace impinge {

/// Two regions without walls that a central force pulls together.
inline Case drops_case(const std::vector<std::string>& settings = {}) {
  return parse_case({{"drops.toml", R"(geometry = "scene"
particles.spacing = 0.1
time = {end = 10.0, dt = 1e-2}
pressure.tolerance = 1e-12
fluid.central_force = 1.0
[[fluid.region]]
shape = "circle"
center = [0, 0]
radius = 1.0
gradient = [0.25, 0, 0, -0.25]
[[fluid.region]]
shape = "box"
low = [1.1, -0.3]
high = [1.7, 0.3]
velocity = [-0.5, 0.2]
spin = 0.5
)"}},
                    settings);
}

/// A column of water in a tank that is then tilted.
inline Case column_case(const std::vector<std::string>& settings = {}) {
  return parse_case({{"column.toml", R"(geometry = "tank"
particles.spacing = 0.05
time = {end = 10.0, dt = 2e-3}
pressure.tolerance = 1e-12
tank.size = [1.0, 0.5]
[[fluid.region]]
shape = "box"
low = [0, 0]
high = [0.4, 0.4]
[[fluid.gravity_at]]
time = 0
value = [0, -9.81]
[[fluid.gravity_at]]
time = 0.1
value = [9.81, -9.81]
)"}},
                    settings);
}

/// A sphere that a central force in three dimensions deforms.
inline Case sphere_case(const std::vector<std::string>& settings = {}) {
  return parse_case({{"sphere.toml", R"(dimension = 3
geometry = "scene"
particles.spacing = 0.2
time = {end = 10.0, dt = 1e-2}
pressure.tolerance = 1e-12
fluid.central_force = 1.0
fluid.force_center = [0.1, 0, 0]
[[fluid.region]]
shape = "sphere"
center = [0, 0, 0]
radius = 1.0
gradient = [0.25, 0, 0, 0, 0, 0, 0, 0, -0.25]
)"}},
                    settings);
}

}  // namespace impinge
