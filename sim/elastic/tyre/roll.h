// A tyre that rolls, by central differences with lumped mass. The rim moves forward and turns as it is told; it bears a
// load and may rise and fall, or keeps its height. Public; free of Eigen.
#pragma once
#include <memory>
#include <vector>

#include "sim/elastic/model.h"
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {

struct Hub {
  double speed = 0;    // forward [m/s]
  double spin = 0;     // of the rim [rad/s]; forward rolling: below 0
  double load = 0;     // weight that the rim carries [N]; 0: the rim keeps its height
  double mass = 0;     // that rises and falls with the rim, where it carries a load [kg]
  double damping = 0;  // of rise and fall [N s/m]
};

/// Since the first step, at the places of the last one. Work done on the tyre equals what it stores plus what is lost.
struct RollEnergy {
  double stored = 0;    // kinetic, elastic, air's, of the contact [J]
  double work = 0;      // of what drives the rim, and of the load [J]
  double loss = 0;      // in the rubber [J]
  double friction = 0;  // on the ground [J]
  double damping = 0;   // of the hub [J]
  double balance() const { return work - stored - loss - friction - damping; }  // 0 but for the step
};

class RollingTyre {
 public:
  /// Starts from the balance under the load, or without load or ground at the height `height`, in steady motion. Throws
  /// InputError as check_tyre does, for a belt without mass, a load without mass, and where no balance is found.
  RollingTyre(const Tyre& tyre, const Hub& hub, double height = 0, std::vector<RigidShape> ground = {RigidShape{}});
  ~RollingTyre();
  RollingTyre(RollingTyre&&) noexcept;

  /// Largest stable step with every node of the tread in touch [s].
  double critical_step() const;
  /// Takes `count` steps. Throws InputError for a step above the critical one.
  void advance(double step, long count);

  const Hub& hub() const;
  void set_motion(double speed, double spin);
  double time() const;  // [s]
  const Rim& rim() const;
  RimLoad rim_load() const;                         // of the sidewalls, last step
  double torque() const;                            // that turns the rim, last step [N m]
  Vec3d ground_force() const;                       // on the tread, last step [N]
  const std::vector<ContactPoint>& points() const;  // of the tread, last step
  double contact_length() const;                    // [m]
  RollEnergy energy() const;

  /// Nodes of the belt: places, velocities, and the tread's outward normal.
  Vec3d node(int k) const;      // [m]
  Vec3d velocity(int k) const;  // [m/s]
  Vec3d normal(int k) const;
  double spin(int k) const;  // [rad/s]
  /// Forces on the nodes from outside, kept until they are set again [N], with moments about the node [N m].
  void set_load(int k, double fx, double fy, double moment);

  struct Parts;

 private:
  std::unique_ptr<Parts> parts_;
};

/// Mean over a time of a rolling tyre.
struct RollMeans {
  double load = 0;            // of the ground, upward [N]
  double pull = 0;            // of the ground on the tyre, forward [N]
  double torque = 0;          // that drives the rim, forward positive [N m]
  double height = 0;          // of the hub [m]
  double contact_length = 0;  // [m]
  double lost = 0;            // in rubber and by friction, per metre of the hub's way [N]
  double worked = 0;          // by torque and pull of the hub, per metre of the way [N]
};
/// Rolls on by `turns` of the rim and takes means.
RollMeans roll(RollingTyre& tyre, double step, double turns);

}  // namespace gonogo::sim::elastic
