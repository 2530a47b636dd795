// Fuzzes restarts: whatever the values in a checkpoint whose checksums match, the outcome is a run that goes on or a
// FileError or SolveError, or a PetscFailure where hypre refuses a coarse matrix.
//
// The input is a list of changes to the checkpoint of a small jet, of twelve bytes each: see change(). The run goes on
// for two steps. Where the first byte is 126 or more, the run is a scene with two inlets, an outlet and a moving wall.

#include <mpi.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fuzz_directory.hpp"
#include "impinge/cases/make_simulation.hpp"
#include "impinge/core/petsc.hpp"
#include "impinge/io/checkpoint_file.hpp"
#include "impinge/io/hdf5_file.hpp"

namespace {

using namespace impinge;

const Case& jet() {
  static const Case config = parse_case({{"jet.toml", R"(geometry = "jet"
particles.spacing = 0.2
jet = {width = 1.0, speed = 1.0, angle = 60.0}
time = {end = 1.0, dt = 0.02}
)"}});
  return config;
}

const Case& scene() {
  static const Case config = parse_case({{"scene.toml", R"(geometry = "scene"
particles.spacing = 0.1
fluid.gravity = [0, -9.81]
time = {end = 1.0, dt = 0.02}
fluid.region = [{shape = "box", low = [0, 0], high = [1, 0.4]}]
wall = [{name = "tank", shape = "polyline", points = [[0, 1.5], [0, 0], [1, 0], [1, 1.5]], wet = "left"},
        {name = "plate", shape = "polyline", points = [[0.3, 0.2], [0.7, 0.2]], motion = "heave"}]
motion = [{name = "heave", type = "harmonic", amplitude = [0, 0.05], frequency = 2.0}]
inlet = [{name = "early", center = [0.2, 0.8], direction = [0, -1], width = 0.2, speed = 1.0},
         {name = "late", center = [0.8, 0.8], direction = [0, -1], width = 0.2, speed = 1.0, start = 0.02}]
outlet = [{name = "drain", shape = "box", low = [0.8, 0], high = [1, 0.2]}]
)"}});
  return config;
}

Checkpoint<2> checkpoint_of(const Case& config) {
  auto simulation = make_simulation<2>(MPI_COMM_SELF, config);
  for (int step = 0; step < 3; ++step) simulation.step();
  return simulation.checkpoint();
}

constexpr std::size_t change_size = 12;

template <class T>
T value_of(std::span<const std::uint8_t, change_size> bytes) {
  static constexpr std::array limits{0.0, -1.0, 1.0, 1e-300, 1e5, 1e300, -1e300, 4294967296.0};
  T value{};
  if (bytes[3] >= 128) {
    std::memcpy(&value, &bytes[4], std::min<std::size_t>(sizeof value, 8));
  } else if constexpr (std::is_floating_point_v<T>) {
    value = limits[bytes[3] % limits.size()];
  } else {
    static constexpr std::array ends{T{0}, T{1}, std::numeric_limits<T>::min(), std::numeric_limits<T>::max()};
    value = ends[bytes[3] % ends.size()];
  }
  return value;
}

/// Byte 0 chooses what is changed, 1 and 2 the place in it, 3 whether bytes 4 to 11 are the value or which special one.
void change(Checkpoint<2>& state, std::span<const std::uint8_t, change_size> bytes) {
  const std::size_t place = bytes[1] + 256u * bytes[2];
  const auto number = [&] { return std::next(state.numbers.begin(), static_cast<long>(place % state.numbers.size())); };
  const auto put = [&]<class T>(std::vector<T>& values) {
    if (!values.empty()) values[place % values.size()] = value_of<T>(bytes);
  };
  const auto put_vector = [&](std::vector<Vector<2>>& values) {
    if (!values.empty()) values[place / 2 % values.size()][static_cast<int>(place % 2)] = value_of<double>(bytes);
  };
  Particles<2>& particles = state.particles;
  CoarseRows& coarse = state.coarse;
  switch (bytes[0] % 18) {
    case 0:
      if (!state.numbers.empty()) number()->second = value_of<double>(bytes);
      break;
    case 1:
      if (!state.numbers.empty()) state.numbers.erase(number());
      break;
    case 2:
      return put_vector(particles.position);
    case 3:
      return put_vector(particles.velocity);
    case 4:
      return put_vector(state.searched_position);
    case 5:
      return put(particles.pressure);
    case 6:
      return put(particles.pressure_impulse);
    case 7:
      return put(particles.number_density);
    case 8:
      return put(particles.id);
    case 9:
      particles.type[place % particles.type.size()] = static_cast<ParticleType>(bytes[3]);
      break;
    case 10:
      return put(particles.free_surface);
    case 11: {
      Segment& segment = state.segments[place / 2 % state.segments.size()];
      if (place % 2 == 0) segment.rank = value_of<int>(bytes);
      if (place % 2 == 1) segment.first = value_of<std::int64_t>(bytes);
      break;
    }
    case 12:
      return put(coarse.cell);
    case 13:
      return put(coarse.length);
    case 14:
      return put(coarse.column);
    case 15:
      return put(coarse.value);
    case 16:  // one row less or one segment more
      if (place % 2 == 0) state.segments.push_back({value_of<std::int64_t>(bytes), 0});
      if (place % 2 == 1 && !coarse.cell.empty()) {
        coarse.cell.pop_back();
        for (std::int64_t k = 0; k < coarse.length.back(); ++k) {
          if (coarse.column.empty()) break;
          coarse.column.pop_back();
          coarse.value.pop_back();
        }
        coarse.length.pop_back();
      }
      break;
    case 17:  // a heap of particles
      for (std::size_t i = 0; i < particles.position.size() && i < place; ++i)
        particles.position[i] = state.searched_position[i] = particles.position.front();
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 1);  // no daemon beside the fuzzer
  setenv("OMPI_MCA_opal_signal", "", 1);              // crashes are the fuzzer's
  prepare_file_access();
  MPI_Init(argc, argv);
  static auto session = std::make_unique<PetscSession>((*argv)[0], std::vector<std::string>{"-no_signal_handler"});
  std::atexit([] {
    session.reset();
    MPI_Finalize();
  });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzDirectory directory;
  const std::string path = directory.path() / "fuzz_00000003.checkpoint";
  static const Checkpoint<2> of_jet = checkpoint_of(jet()), of_scene = checkpoint_of(scene());
  constexpr std::uint8_t first_of_scene = 126;
  const bool is_scene = size > 0 && data[0] >= first_of_scene;
  Checkpoint<2> state = is_scene ? of_scene : of_jet;
  for (; size >= change_size; data += change_size, size -= change_size)
    change(state, std::span<const std::uint8_t, change_size>(data, change_size));
  try {
    write_checkpoint(MPI_COMM_SELF, path, state,
                     {.dimension = 2, .status = "running", .message = "", .case_text = "", .code_version = {}});
    const auto from = read_checkpoint<2>(MPI_COMM_SELF, path);
    auto simulation = make_simulation<2>(MPI_COMM_SELF, is_scene ? scene() : jet(), &from);
    for (int step = 0; step < 2; ++step) simulation.step();
  } catch (const FileError&) {
  } catch (const SolveError&) {
  } catch (const PetscFailure&) {
  }
  return 0;
}
