// The engine: a batch of worlds on one backend. Choose the backend once, at make_simulation; after that one virtual
// call per batch of steps, none per contact.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "sim/scene/flat_world.h"
#include "sim/simulation/joint_load.h"

namespace gonogo::sim {

enum class Backend { cpu, cuda };

/// What one world did in its latest step.
struct [[nodiscard]] StepReport {
  double time = 0;            // [s]
  double kinetic_energy = 0;  // [J]
  double gravity_power = 0;   // at the end of the step [W]
  double motor_power = 0;     // [W]
  double force_power = 0;     // of force elements [W]
  double spring_energy = 0;   // [J]
  double rms_residual = 0;    // scaled natural map of the CCP over contacts [m/s]
  double max_residual = 0;    // [m/s]
  Index contact_count = 0;
  Index iterations = 0;  // that the solver took
  Index flags = 0;       // StepFlag bits raised so far
  Fault fault;           // the first of them
  Index slowed = 0;      // times that a body was slowed so far, see StepSettings::max_slowed
};

/// "body 12 in step 340 (0.34 s): left the domain" for people; empty where nothing went wrong.
std::string description(const Fault& fault, double step);

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Takes `count` steps of all worlds.
  virtual void advance(Index count) = 0;
  virtual StepReport report(WorldIndex world) = 0;

  /// Whether, when and why a world stopped. It is stepped on with the others, but its monitors rest.
  virtual WorldStop stop(WorldIndex world) = 0;
  virtual std::vector<WorldStop> stops() = 0;
  virtual MonitorState monitor(WorldIndex world, Index monitor) = 0;
  /// Recorded samples `first` .. `first` + `count` - 1 of a monitor; all of them must have been recorded.
  virtual std::vector<MonitorSample> samples(WorldIndex world, Index monitor, Index first, Index count) = 0;

  virtual BodyState body(WorldIndex world, BodyIndex b) = 0;
  virtual void set_body(WorldIndex world, BodyIndex b, const BodyState& state) = 0;
  /// Many at once: `states` in the order of `which`.
  virtual void set_bodies(WorldIndex world, const std::vector<BodyIndex>& which,
                          const std::vector<BodyState>& states) = 0;
  /// All bodies of a world in order.
  virtual std::vector<BodyState> bodies(WorldIndex world) = 0;

  virtual void set_gravity(WorldIndex world, const Vec3& gravity) = 0;
  virtual void set_law(WorldIndex world, int material_a, int material_b, const PairLaw& law) = 0;
  /// `target` is a speed [rad/s] or torque [N m], after the motor's kind. Refused for a motor that a controller sets.
  virtual void set_motor(WorldIndex world, Index motor, Real target, Real max_torque) = 0;
  /// Impulse of a motor in the latest step divided by the step [N m].
  virtual double motor_torque(WorldIndex world, Index motor) = 0;
  /// What a joint or spring did to its body a in the latest step; zero before the world's first step and after restore.
  virtual JointLoad joint_load(WorldIndex world, Index joint) = 0;
  virtual JointLoad spring_load(WorldIndex world, Index spring) = 0;

  /// Sum of the contact impulses on a body in the latest step divided by the step [N].
  virtual Vec3d contact_force(WorldIndex world, BodyIndex b) = 0;
  /// Contacts of a world in the latest step and their impulses, in the same order; bodies are counted in their world.
  /// Empty before the world's first step and after restore.
  virtual std::vector<Contact> contacts(WorldIndex world) = 0;
  virtual std::vector<Impulse> impulses(WorldIndex world) = 0;

  virtual Snapshot snapshot(WorldIndex world) = 0;
  /// Reports and contact forces of the world are zero until the next step. Throws InputError for a snapshot of a world
  /// of another make.
  virtual void restore(WorldIndex world, const Snapshot& snapshot) = 0;

  /// Puts a new world in the place of one that has served; the others do not notice. Throws InputError, naming the
  /// numbers, when the place is too small for it. The second form takes what flatten() made for this place.
  virtual void replace(WorldIndex place, const SceneWorld& world) = 0;
  virtual void replace(WorldIndex place, FlatWorld world) = 0;

  virtual const StepSettings& settings() const = 0;
};

/// Throws InputError for a backend that this program was built without or that this machine lacks, so that nobody waits
/// for a refusal.
void require_backend(Backend backend);

/// `room`: every world's place holds at least this much, for larger worlds that will take it over.
/// Throws InputError for a scene that cannot run (no bodies; masses, places, sizes, laws out of range; shapes that
/// could meet without a routine; joints, springs or motors that cannot work), for bad settings, and as require_backend
/// does; DeviceError, naming the bytes, when a GPU's memory does not suffice.
std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads, const WorldSize& room = {});

std::unique_ptr<Simulation> make_cpu_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                const WorldSize& room, int threads);
std::unique_ptr<Simulation> make_cuda_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                 const WorldSize& room);

}  // namespace gonogo::sim
