#pragma once
// A case: typed, validated, immutable after it is read. SI units; lengths that the method scales are in dp.

#include <array>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "impinge/kernel.hpp"

namespace impinge {

enum class Scheme { consistent, paper };
enum class WallModel { mirror, columns, particles };
enum class GeometryType { jet, tank, periodic_box };
enum class JetStart { impact, steady };
enum class Partitioner { metis, ptscotch };

/// Every key of a case file. The table in config.cpp holds each key's unit, range and doc line (impinge --describe).
struct Config {
  std::string name;  ///< default: the case file's stem
  GeometryType geometry = GeometryType::jet;
  int dimension = 2;
  Scheme scheme = Scheme::consistent;  ///< sets the defaults that are said to be "by scheme"

  struct {
    double density = 1000.0;  ///< [kg/m^3]
    double viscosity = 0.0;   ///< kinematic [m^2/s]
    std::array<double, 3> gravity{0.0, 0.0, 0.0};
  } fluid;

  struct {
    double spacing = 0.0;  ///< dp [m], required
  } particles;

  struct {
    KernelType type = KernelType::non_singular;
    double radius = 2.1;             ///< r_e of number density, gradient and divergence [dp]
    double laplacian_radius = 4.01;  ///< r_e of the Laplacian [dp]
  } kernel;

  struct {
    double gamma = 0.01;                ///< weight of the density term in the PPE source, unless density_speed is set
    double density_speed = 0.0;         ///< speed at which a density error is corrected [u_max]; by scheme
    bool corrected_divergence = false;  ///< divergence exact on linear velocities; by scheme
    bool packing = false;               ///< density errors by the packing, not by the number density; by scheme
    bool corrected_gradient = false;    ///< gradient by differences of pressure, but at the surface; by scheme
    double tolerance = 1e-6;            ///< relative residual of the PPE solve
    bool clamp_negative = true;         ///< set negative pressures to zero after the solve
  } pressure;

  struct {
    WallModel model = WallModel::particles;  ///< by scheme
  } walls;

  struct {
    double surface_density = 0.8;    ///< n/n0 below which a particle is free surface
    double interior_density = 0.97;  ///< n/n0 above which it is not
    double asymmetry = 0.9;          ///< between the two: surface if |F| > asymmetry |F|0
    bool zero_outside = false;       ///< p = 0 half a spacing outside the surface particles, not at them; by scheme
  } free_surface;

  struct {
    double distance = 0.8;     ///< [dp]; 0 switches collisions off; by scheme
    double restitution = 0.2;  ///< [-]
  } collision;

  struct {
    double coefficient = 0.0;       ///< displacement over asymmetry and Courant number [dp]; 0: none; by scheme
    double least_distance = 0.0;    ///< nearer pairs beside the surface drift apart [dp]; 0: none do; by scheme
    bool correct_velocity = false;  ///< take the velocity of the new place; by scheme
  } shifting;

  struct {
    double end = 0.0;            ///< [s], required
    double dt = 0.0;             ///< largest step [s], required
    double cfl = 0.2;            ///< dt <= cfl dp / |u|max
    bool mean_velocity = false;  ///< particles move with the mean of the old and the new velocity; by scheme
    double max_speed = 0.0;      ///< speed that counts as divergence [m/s]; default: 20 times the case's own
  } time;

  struct {
    double width = 0.0;           ///< H [m]
    double speed = 0.0;           ///< U [m/s]
    double angle = 0.0;           ///< between jet and plate [deg]
    double inlet_distance = 3.5;  ///< from the plate along the axis [H]
    JetStart start = JetStart::impact;
  } jet;

  struct {
    double begin = 0.0;  ///< [m] from the stagnation point; default from the analytic jet, a multiple of dp
    double end = 0.0;    ///< [m], likewise
  } plate;

  struct {
    std::array<double, 3> size{0.0, 0.0, 0.0};  ///< inner lengths; the vertical one is the walls' height [m]
    double fluid_height = 0.0;                  ///< [m]
  } tank;

  struct {
    std::array<double, 3> size{0.0, 0.0, 0.0};  ///< periods [m]
    double shear_speed = 0.0;                   ///< amplitude of u_x = U sin(2 pi y / L_y) [m/s]
  } periodic_box;

  struct {
    std::string directory;        ///< default: output/<name>
    std::string directory_place;  ///< where it was given, for messages
    double interval = 0.0;        ///< time between snapshots [s]; 0: first and last only
    double average_start = 0.0;   ///< start of the wall-pressure average [s]; default: 0.8 time.end
  } output;

  struct {
    int steps = 0;          ///< a checkpoint every so many steps; 0: none by steps
    double minutes = 15.0;  ///< and every so many minutes of wall-clock time; 0: none by time
  } checkpoint;

  struct {
    Partitioner partitioner = Partitioner::metis;
    double imbalance = 1.1;  ///< repartition when max/mean of the owned particles passes it
  } parallel;

  std::string resolved_text;  ///< the whole case as one TOML text, every key with its value
};

/// Mistakes in the input, all of them, one message each ("file:line: key = value: what is wrong (range)"). Exit 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<std::string> mistakes);
  const std::vector<std::string>& mistakes() const { return mistakes_; }

 private:
  std::vector<std::string> mistakes_;
};

/// A file's name and its text.
using NamedText = std::pair<std::string, std::string>;

/// The case file followed by the files it includes (key `include`, relative to the including file), as texts.
/// Reads the disk; not collective. Throws InputError (missing file, include cycle) that also lists what else is wrong
/// in the files it could read.
std::vector<NamedText> load_case_files(const std::string& path);

/// Parses and validates; later files are defaults for earlier ones, `settings` ("key=value") override all.
/// Touches no file. Throws InputError with every mistake, in the order of the files and their lines.
Config parse_case(const std::vector<NamedText>& files, const std::vector<std::string>& settings = {});

/// The case of a run that is restarted in `directory`: the case text of its checkpoint with `settings` over it. Touches
/// no file. Throws InputError, also where a setting changes what a run cannot change; OutputError where the text itself
/// is no case.
Config parse_restart(const NamedText& stored, const std::vector<std::string>& settings, const std::string& directory);

/// Every key with type, unit, default, range and doc line, as a text for the terminal.
std::string describe_keys();

/// Creates the output directory where it does not exist and tries a file in it. Touches the disk; not collective.
/// Throws InputError that names the place of output.directory and the reason.
void check_writable(const Config& config);

}  // namespace impinge
