// The ring of a tyre, of beams and sidewalls: places, strains, forces and tangent. Internal: Eigen.
#pragma once
#include <Eigen/Sparse>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/elastic/contact.h"
#include "sim/elastic/model.h"
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {

// A straight beam of a plane frame that may move and turn by any amount: strains are small in a frame that goes with
// the chord (Crisfield, Non-linear finite element analysis of solids and structures, volume 1, 1991, chapter 7).
// Degrees of freedom: x, y, turn of both ends. For plain numbers and for Dual.

/// Stretch of the chord [m], turns of both ends against it [rad].
template <class T>
using BeamStrain = std::array<T, 3>;

/// Undeformed: length [m], direction of the chord.
struct BeamShape {
  double length = 0, c = 1, s = 0;
};

template <class T>
struct Chord {
  T length{}, c{}, s{};
  BeamStrain<T> strain{};
};

/// The multiple of a full turn nearest to an angle.
inline double full_turns(double angle) { return 2 * std::numbers::pi * std::round(angle / (2 * std::numbers::pi)); }

template <class T>
Chord<T> chord_of(const BeamShape& shape, const std::array<T, 6>& x) {
  const T dx = x[3] - x[0], dy = x[4] - x[1];
  Chord<T> k;
  k.length = root(dx * dx + dy * dy);
  k.c = dx / k.length;
  k.s = dy / k.length;
  const T turn = angle(k.s * T(shape.c) - k.c * T(shape.s), k.c * T(shape.c) + k.s * T(shape.s));
  k.strain = {k.length - T(shape.length), x[2] - turn, x[5] - turn};
  for (int i = 1; i < 3; ++i) k.strain[i] -= T(full_turns(value_of(k.strain[i])));
  return k;
}

/// Normal force [N] and moments at both ends [N m].
template <class T>
BeamStrain<T> beam_stress(double stretching, double bending, double length, const BeamStrain<T>& strain) {
  const double n = stretching / length, m = bending / length;
  return {T(n) * strain[0], T(4 * m) * strain[1] + T(2 * m) * strain[2], T(2 * m) * strain[1] + T(4 * m) * strain[2]};
}

/// Forces of the beam on its ends, minus the gradient of its energy.
template <class T>
std::array<T, 6> beam_force(const Chord<T>& k, const BeamStrain<T>& stress) {
  const T across = (stress[1] + stress[2]) / k.length;  // shear force
  const T fx = k.c * stress[0] + k.s * across, fy = k.s * stress[0] - k.c * across;
  return {fx, fy, -stress[1], -fx, -fy, -stress[2]};
}

// A sidewall as a membrane: an arc of constant length L between rim and belt, blown out by the pressure p. With the
// chord c and half the angle t of the arc, L = 2 t r and c = 2 r sin t. Balance of the arc: its tension is p r. Along
// the chord it pulls the belt with
//   f(c) = p r cos t = p c / (2 tan t),    f'(c) = p / 2 (t sin t + cos t) / (sin t - t cos t)
// per length of the belt. f falls below 0 when the arc is more than half a circle. f is minus p times the derivative of
// the area between arc and chord.

struct Pull {
  double force = 0;      // towards the rim, per length [N/m]
  double stiffness = 0;  // its derivative by the chord [N/m^2]
  double energy = 0;     // -p times the area between arc and chord, per length [J/m]
};

class Membrane {
 public:
  Membrane() = default;
  /// `chord` above 0 and `bulge` above 0, at most half the chord [m], of the unloaded tyre.
  Membrane(double chord, double bulge, double pressure);
  double length() const { return length_; }
  /// Chords beyond those of t in [0.2, 3] are continued with constant stiffness.
  Pull at(double chord) const;

 private:
  double length_ = 0, pressure_ = 0;
};

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
  double share() const { return share_; }  // length of belt that belongs to a node [m]

  Vector unloaded(const Rim& rim) const;
  void measure(const Vector& u, const Rim& rim, RingShape& shape) const;
  /// Adds forces of belt, sidewalls and air for the strains `strain`, which are the shape's own where nothing is lost.
  /// Returns the load of the sidewalls on the rim.
  RimLoad add_forces(const Vector& u, const RingShape& shape, const std::vector<double>& strain, Vector& force) const;
  /// Adds minus the derivative of these forces by u; `stiffening`: factor of the springs of belt and rubber.
  void add_tangent(const Vector& u, const Rim& rim, double stiffening, Triplets& tangent) const;
  /// Energy of the air, minus the pressure times the volume [J].
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
