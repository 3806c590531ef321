// The ring of a tyre: its places, strains, forces and tangent. Internal: Eigen.
#pragma once
#include <Eigen/Sparse>
#include <vector>

#include "sim/elastic/contact_point.h"
#include "sim/elastic/model.h"
#include "sim/elastic/tyre/beam.h"
#include "sim/elastic/tyre/sidewall.h"
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {

using Vector = Eigen::VectorXd;
using Triplets = std::vector<Eigen::Triplet<double>>;

/// Strains of the ring. Beam k goes from node k to k + 1: stretch and both turns; then the springs of node k, along the
/// rim's radius and across it, out of the unloaded place [m].
inline constexpr int kStrains = 5;
struct RingShape {
  std::vector<Chord<double>> chord;             // [nodes]
  std::vector<std::array<double, 2>> unit;      // of the rim's radius to each node
  std::vector<std::array<double, 2>> from_hub;  // [nodes] [m]
  std::vector<double> strain;                   // [kStrains nodes]
  double area = 0;                              // inside the belt [m^2]
};

/// Degrees of freedom of node k: x, y [m] and turn [rad] at 3 k. Node k lies at the angle 2 pi k / nodes of the rim.
class Ring {
 public:
  explicit Ring(const Tyre& tyre);
  const Tyre& tyre() const { return tyre_; }
  int nodes() const { return tyre_.nodes; }
  int dofs() const { return 3 * tyre_.nodes; }
  double share() const { return share_; }  // of the belt's length that a node stands for [m]

  Vector unloaded(const Rim& rim) const;
  void measure(const Vector& u, const Rim& rim, RingShape& shape) const;
  /// Adds forces of belt, sidewalls and air for the strains `strain`, which are the shape's own where nothing is lost.
  /// Returns the load of the sidewalls on the rim.
  RimLoad add_forces(const Vector& u, const RingShape& shape, const std::vector<double>& strain, Vector& force) const;
  /// Adds minus the derivative of these forces by u; `stiffening`: factor of the springs of belt and rubber.
  void add_tangent(const Vector& u, const Rim& rim, double stiffening, Triplets& tangent) const;
  /// Of the air, minus the pressure times the volume [J].
  double energy_of_air(const RingShape& shape) const;
  /// Twice the energy of the springs of belt and rubber at the strains `q` [J].
  double square_of(const double* q) const;
  /// Mass and moment of inertia of a node: a share of the belt as a block twice as thick as the tread [kg], [kg m^2].
  std::array<double, 2> mass() const;

  /// Touch of the tread: node k has the point k. Adds forces, and to `tangent` minus their derivative by u or, where
  /// asked, by v. Returns the energy of the compliance [J].
  struct Touching {
    const std::vector<RigidShape>& ground;
    const Vector& v;           // [dofs]
    double time = 0;           // of the ground's displacements [s]
    bool by_velocity = false;  // slopes by v, not by u
    /// Compression of the tread that presses, one per node, in place of the overlap; null: the overlap [m].
    const std::vector<double>* pressing = nullptr;
  };
  double gap(const Vector& u, int k, const std::vector<RigidShape>& ground, double time) const;  // of node k [m]
  double add_contact(const Vector& u, const Touching& at, Vector& force, Triplets* tangent,
                     std::vector<ContactPoint>& points) const;

 private:
  Vec3d surface(const Vector& u, int k) const;
  double contact_of(int k, const RigidShape& shape, const Vector& u, const Touching& at, Vector& force,
                    Triplets* tangent, ContactPoint& point) const;
  int next(int k) const { return k + 1 < tyre_.nodes ? k + 1 : 0; }
  int last(int k) const { return k > 0 ? k - 1 : tyre_.nodes - 1; }
  double angle_of(int k) const;
  std::array<double, 2> outward(const Vector& u, int k) const;

  Tyre tyre_;
  double share_, chord_;
  std::vector<BeamShape> beam_;
  std::vector<std::array<double, 2>> unit_;  // of each node from the hub, unloaded
  Membrane membrane_;
};

/// Length of the tread's surface that touches, by the zeros of the gap between neighbours [m].
double contact_length(const std::vector<ContactPoint>& points);

}  // namespace gonogo::sim::elastic
