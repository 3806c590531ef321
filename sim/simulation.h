// The engine: a batch of worlds on one backend. Choose the backend once, at make_simulation; after that one virtual
// call per batch of steps, none per contact.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/scene.h"

namespace gonogo::sim {

enum class Backend { cpu, cuda };

/// What one world did in its latest step.
struct [[nodiscard]] StepReport {
  double time = 0;            // [s]
  double kinetic_energy = 0;  // [J]
  double gravity_power = 0;   // at the end of the step [W]
  double motor_power = 0;     // [W]
  double rms_residual = 0;    // scaled natural map of the CCP over contacts [m/s]
  double max_residual = 0;    // [m/s]
  Index contact_count = 0;
  Index iterations = 0;  // that the solver took
  Index flags = 0;       // StepFlag bits raised so far
};

/// Everything a world batch needs to go on with the same bits.
struct Snapshot {
  std::vector<Vec3d> position;
  std::vector<Quat> orientation;
  std::vector<Velocity> velocity;
  std::vector<Index> first_contact, flags;
  std::vector<std::uint64_t> key;
  std::vector<Impulse> impulse;
  std::vector<Real> motor_impulse;
  std::vector<WorldParameters> world;
  std::vector<Motor> motor;
  std::int64_t step_count = 0;
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Takes `count` steps of all worlds.
  virtual void advance(Index count) = 0;
  virtual StepReport report(WorldIndex world) = 0;

  virtual BodyState body(WorldIndex world, BodyIndex b) = 0;
  virtual void set_body(WorldIndex world, BodyIndex b, const BodyState& state) = 0;
  /// All bodies of a world in order.
  virtual std::vector<BodyState> bodies(WorldIndex world) = 0;

  virtual void set_gravity(WorldIndex world, const Vec3& gravity) = 0;
  virtual void set_law(WorldIndex world, int material_a, int material_b, const PairLaw& law) = 0;
  virtual void set_motor(WorldIndex world, Index motor, Real speed, Real max_torque) = 0;
  /// Impulse of a motor in the latest step divided by the step [N m].
  virtual double motor_torque(WorldIndex world, Index motor) = 0;

  /// Sum of the contact impulses on a body in the latest step divided by the step [N].
  virtual Vec3d contact_force(WorldIndex world, BodyIndex b) = 0;
  /// Contacts of all worlds in the latest step and their impulses, in the same order; bodies are counted through the
  /// batch: index in its world plus the bodies of the worlds before. Empty before the first step and after restore.
  virtual std::vector<Contact> contacts() = 0;
  virtual std::vector<Impulse> impulses() = 0;

  virtual Snapshot snapshot() = 0;
  /// Reports and contact forces are zero until the next step.
  virtual void restore(const Snapshot& snapshot) = 0;

  virtual const StepSettings& settings() const = 0;
};

/// Throws InputError for a scene that cannot run (no bodies, bad sizes, motors or springs without a body to move) and
/// for a backend this program was built without or this machine lacks.
std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads);

/// Host-side preparation shared by the backends: flat arrays of all worlds, bins laid out. See state.h.
struct FlatScene {
  std::vector<WorldParameters> world;
  std::vector<BodyState> body;
  std::vector<BodyMass> mass;
  std::vector<WorldIndex> world_of_body;
  std::vector<Shape> shape;
  std::vector<Index> first_shape, bin_of_shape, first_motor, first_spring;
  std::vector<LargeShape> large;
  std::vector<Motor> motor;
  std::vector<SpringDamper> spring;
  Index bin_count = 0;
};
FlatScene flatten(const Scene& scene, const StepSettings& settings);

std::unique_ptr<Simulation> make_cpu_simulation(const FlatScene& scene, const StepSettings& settings, int threads);
std::unique_ptr<Simulation> make_cuda_simulation(const FlatScene& scene, const StepSettings& settings);

}  // namespace gonogo::sim
