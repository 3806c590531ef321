// A tyre pressed on rigid ground, slowly: balance of the ring by Newton's method. Public; free of Eigen.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/elastic/model.h"
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {

struct PressSettings {
  double increment = 1e-3;   // longest way of the rim between two balances [m]
  int max_iterations = 40;   // of Newton's method, per increment
  double tolerance = 1e-10;  // residual over the largest of the forces, Euclidean norms
};

struct NodeForce {
  int node = 0;
  double x = 0, y = 0;  // [N]
};

/// Without friction: nothing here has a speed.
class PressedTyre {
 public:
  /// Inflates the tyre about a hub `height` above the origin; the tread must not touch. Throws InputError as check_tyre
  /// does. `ground`: by default the half-space below y = 0.
  PressedTyre(const Tyre& tyre, double height, std::vector<RigidShape> ground = {RigidShape{}},
              const PressSettings& settings = {});
  ~PressedTyre();
  PressedTyre(PressedTyre&&) noexcept;

  /// Moves the rim on in increments. False when Newton's method fails; reason() then says why, and the state is that
  /// of the last balance.
  bool move_rim(const Rim& to);
  /// Lowers the hub until the ground carries `load` [N], within 1e-6 of it. Throws InputError for a load not above 0.
  bool carry(double load);
  /// Sets forces on nodes of the belt and finds the balance. Throws InputError for a node that does not exist.
  bool pull(const std::vector<NodeForce>& forces);
  /// Finds the balance anew, after the ground was moved.
  bool settle();

  const std::string& reason() const;
  int iterations() const;  // of Newton's method, so far
  const Rim& rim() const;
  RimLoad rim_load() const;
  Vec3d node(int k) const;                          // place of the belt [m]
  double contact_load() const;                      // sum over the tread, upward [N]
  double contact_length() const;                    // [m]
  const std::vector<ContactPoint>& points() const;  // of the tread, one per node
  std::vector<double> state() const;                // x, y [m] and turn [rad] of every node

  struct Parts;

 private:
  std::unique_ptr<Parts> parts_;
};

}  // namespace gonogo::sim::elastic
