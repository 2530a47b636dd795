#pragma once
// A plane jet that enters through a rigid inlet buffer and hits a plate.

#include "impinge/scenes/analytic_jet.hpp"
#include "impinge/scenes/scene.hpp"

namespace impinge {

/// Frame: plate surface y = 0, stagnation point of the analytic jet at the origin, incoming velocity
/// U (cos a, -sin a). Along the jet, s runs downstream from the inlet plane and t across, from its lower edge.
class JetGeometry final : public Geometry<2> {
 public:
  explicit JetGeometry(const Case& config);

  Box<2> bounds() const override { return bounds_; }
  Edges<2> edges() const override;
  void fill(int rank, int ranks, Particles<2>& particles) const override;
  Vector<2> inlet_velocity() const override { return speed_ * along_; }
  BoundaryFlow move_boundaries(double dt, Particles<2>& particles,
                               const std::function<bool(const Vector<2>&)>& owns) override;
  InletState inlet() const override { return inlet_; }
  void set_inlet(const InletState& inlet) override { inlet_ = inlet; }
  Vector<2> wall_normal(const Vector<2>&) const override { return {{0.0, 1.0}}; }
  bool on_floor(const Vector<2>&) const override { return true; }

 private:
  Vector<2> at(double s, double t) const { return inlet_corner_ + s * along_ + t * across_; }
  double distance_past_inlet(const Vector<2>& position) const { return dot(position - inlet_corner_, along_); }
  bool past_outlet(const Vector<2>& position) const;
  ParticleRecord<2> steady_fluid(const Vector<2>& position, std::int64_t id) const;

  AnalyticJet jet_;
  JetStart start_;
  bool mirror_;  // the plate is a mirror
  int layers_;   // rows of the plate's particles
  double spacing_;
  double speed_;
  Vector<2> along_;         // unit vector of the incoming flow
  Vector<2> across_;        // unit vector from the lower to the upper edge of the jet
  Vector<2> inlet_corner_;  // lower edge of the inlet plane
  int particles_per_row_;
  int buffer_rows_;
  double plate_begin_;
  double plate_end_;
  Box<2> bounds_;
  double column_end_;  // s where a steady start changes from the jet's lattice to the plate's [m]

  // Initial particles are numbered block by block: walls, inlet buffer, jet column, the rest of a steady jet.
  std::int64_t wall_columns_;
  std::int64_t column_rows_;
  std::int64_t steady_rows_;
  InletState inlet_;
};

}  // namespace impinge
