#pragma once
// The MPS operators: plain loops over the pair lists. Numbers in brackets are equations of docs/method.md. They know
// neither MPI nor PETSc. Owned particles first, then the halo, in every array; results are written for owned particles
// only, and are zero where the row is empty.

#include <cstdint>
#include <optional>
#include <span>

#include "impinge/core/vector.hpp"
#include "impinge/particles/neighbours.hpp"

namespace impinge {

/// Particle number density n_i = sum_{j != i} W(r_ij) [-] (4) (Koshizuka & Oka 1996).
void number_density(const PairList& near, std::span<double> density);

/// Packing of particle i, sum_{j != i} packing_weight(W_ij) [-] (14). The lattice and clouds that a flow has stirred
/// have the same mean at the same volume per particle, within half a percent; number density, whose kernel peaks at
/// zero, counts the latter as up to two percent denser (docs/notebook/scheme.md). `kernel`, `radius`: of the weights
/// [m]; those of pairs with an index from `first_scaled` on are not those of their distances but some share of them,
/// which the packing's weights then have, too.
template <int Dim>
double packing(const PairList& near, std::span<const Vector<Dim>> position, KernelType kernel, double radius,
               int first_scaled, int i);

/// F_i = Dim/n0 sum (r_i - r_j)/r_ij W [-] (6), away from the neighbours: large where they are on one side only (Zhang
/// & Wan 2012).
template <int Dim>
Vector<Dim> asymmetry(const PairList& near, std::span<const Vector<Dim>> position, double n0, int i);

/// L_i, inverse of the moment matrix Dim/n0 sum W r_ij r_ij^T / r_ij^2 [-] (8). That is the identity on the full
/// lattice. L_i is zero where neighbours are too few or in line (determinant below 0.15; 0.4 on a flat surface).
/// Operators that are given zero do not correct.
template <int Dim>
Matrix<Dim> moment_correction(const PairList& near, std::span<const Vector<Dim>> position, double n0, int i);

/// Divergence Dim/n0 sum (u_j - u_i).r_ij W / r_ij^2 [1/s] (9) (paper eq. 5).
template <int Dim>
double divergence(const PairList& near, std::span<const Vector<Dim>> position, std::span<const Vector<Dim>> velocity,
                  double n0, int i);

/// Corrected velocity gradient Dim/n0 sum (u_j - u_i) (L_i r_ij)^T W / r_ij^2 [1/s] (9), row k that of component k;
/// exact on linear velocities, and its trace is the divergence. Walls of particles let the fluid slip: of a pair with a
/// wall, whose normal `wall_normal` has for its particles and ghosts and which is zero elsewhere, only the relative
/// velocity along the normal counts. `wall_normal` is empty where no wall has particles.
template <int Dim>
Matrix<Dim> velocity_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                              std::span<const Vector<Dim>> velocity, std::span<const Vector<Dim>> wall_normal,
                              const Matrix<Dim>& correction, double n0, int i);

/// What the velocity gradient has from images that particle i leaves behind: from its pairs with particles from
/// `first_image` on that move away from it [1/s]. Where fluid leaves a wall, no fluid is between both.
template <int Dim>
Matrix<Dim> gradient_to_images_left(const PairList& near, std::span<const Vector<Dim>> position,
                                    std::span<const Vector<Dim>> velocity, const Matrix<Dim>& correction, double n0,
                                    std::size_t first_image, int i);

/// Momentum-conserving pressure gradient Dim/n0 sum (p_j + p_i) r_ij W / r_ij^2 [Pa/m] (10) (paper eq. 4). Ghost
/// particles carry no pressure and are left out. A wall is smooth: its particles push along the wall's unit normal
/// only, the pair's component along which is taken; `wall_normal` has an entry for every particle and is read for wall
/// particles.
template <int Dim>
Vector<Dim> pressure_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                              std::span<const double> pressure, std::span<const ParticleType> type,
                              std::span<const Vector<Dim>> wall_normal, double n0, int i);

/// Corrected pressure gradient Dim/n0 L_i sum (p_j - base) r_ij W / r_ij^2 [Pa/m] (10). With base = p_i it is exact on
/// linear pressures; the smallest pressure around (Koshizuka & Oka 1996) adds a push away from where neighbours crowd.
template <int Dim>
Vector<Dim> corrected_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                               std::span<const double> pressure, double base, const Matrix<Dim>& correction, double n0,
                               int i);

/// Pressure gradient [Pa/m] of a surface particle, by least squares over the differences to its neighbours and to p = 0
/// at its `depth` [m] out along the unit normal: exact on a pressure that is zero at the surface and has the second
/// derivative `curvature` [Pa/m^2] along the normal. On a flat lattice the weight of that point, 1/2, makes up for what
/// the neighbours lack in the moment matrix. Nothing where the neighbours are too few or in line for it.
template <int Dim>
std::optional<Vector<Dim>> surface_gradient(const PairList& near, std::span<const Vector<Dim>> position,
                                            std::span<const double> pressure, const Vector<Dim>& normal, double depth,
                                            double curvature, double n0, int i);

/// The smallest pressure of particle i and its neighbours [Pa].
double least_pressure(const PairList& near, std::span<const double> pressure, int i);

/// Push away from the fluid neighbours that are too near, sum (distance - r_ij/dp) (r_i - r_j)/r_ij [-] (20) over those
/// nearer than `distance` [dp]; equal and opposite for the two of a pair. `spacing`: dp [m].
template <int Dim>
Vector<Dim> repulsion(const PairList& near, std::span<const Vector<Dim>> position, std::span<const ParticleType> type,
                      double distance, double spacing, int i);

/// A change of velocity [m/s], made smaller where the new velocity along it would pass the largest of the neighbours
/// that are no wall: in spray an extrapolation would feed on itself.
template <int Dim>
Vector<Dim> limited_change(const PairList& near, std::span<const Vector<Dim>> velocity,
                           std::span<const ParticleType> type, const Vector<Dim>& change, int i);

/// What a change of velocity [m/s] has beside those of the fluid around, sum (c_i - c_j) W_ij / n0, without images: all
/// together it changes no momentum. `change`: of owned and halo particles.
template <int Dim>
Vector<Dim> off_mean(const PairList& near, std::span<const Vector<Dim>> change, std::span<const ParticleType> type,
                     double n0, int i);

/// What the velocity differences to the neighbours have beyond those of a linear field,
/// 1/n0 sum (u_j - u_i - (G_i + G_j) r_ij/2) W [m/s] (21), equal and opposite for the two of a pair. On a smooth field
/// it is of fourth order in the radius. `gradient`: G [1/s], of particles up to the last that is no image; pairs
/// without it, or where it is zero, are left out.
template <int Dim>
Vector<Dim> off_linear(const PairList& near, std::span<const Vector<Dim>> position,
                       std::span<const Vector<Dim>> velocity, std::span<const Matrix<Dim>> gradient, double n0, int i);

/// Mean of the values of particle i and its neighbours that are not on the free surface, by their weights; particle i
/// has `own_weight`.
double mean_inside(const PairList& near, std::span<const double> value, std::span<const std::uint8_t> free_surface,
                   double own_weight, int i);

/// Mean of the neighbours' values by their weights; 0 without a neighbour.
double weighted_mean(const PairList& near, std::span<const double> value, int i);

/// Laplacian of the velocity, 2 Dim/(n0 lambda) sum (u_j - u_i) W [1/(m s)] (11) (paper eq. 6, with the factor Dim).
/// `factor` = 2 Dim/(n0 lambda) [1/m^2].
template <int Dim>
Vector<Dim> velocity_laplacian(const PairRow& far, std::span<const Vector<Dim>> velocity, double factor, int i);

/// What (11a) sums over the pairs of a particle.
template <int Dim>
struct ViscousSums {
  Vector<Dim> differences;  ///< sum (u_j - u_i) W [m/s]
  Vector<Dim> offsets;      ///< sum r_ij W [m]
  double spread = 0.0;      ///< sum r_ij^2 W [m^2]
};

template <int Dim>
ViscousSums<Dim> viscous_sums(const PairRow& far, std::span<const Vector<Dim>> position,
                              std::span<const Vector<Dim>> velocity, int i);

/// Change of velocity of particle i by its collisions [m/s] (22): with every fluid, inlet or wall neighbour that
/// approaches and would be nearer than `distance` [m] after a step of `dt` [s], the pair's normal relative velocity
/// becomes -restitution times itself; fluid partners share the change equally, so momentum is conserved, walls and
/// inlet do not yield. A wall is smooth: the normal of a pair with it is the wall's. `fastest`: no particle's speed is
/// larger [m/s].
template <int Dim>
Vector<Dim> collision(const PairList& near, std::span<const Vector<Dim>> position,
                      std::span<const Vector<Dim>> velocity, std::span<const ParticleType> type,
                      std::span<const Vector<Dim>> wall_normal, double dt, double distance, double restitution,
                      double fastest, int i);

}  // namespace impinge
