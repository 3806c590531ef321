// The engine: a batch of worlds that take their steps together on one backend, chosen by make_simulation().
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "sim/scene/flat_world.h"

namespace gonogo::sim {

/// Force and moment of a joint, spring or damper in the latest step, on body a at a's point, and oppositely on b; world
/// frame.
struct JointLoad {
  Vec3d force;   // [N]
  Vec3d moment;  // [N m]
};

/// A body of a world of the batch.
struct WorldBody {
  WorldIndex world = 0;
  BodyIndex body = 0;
};

enum class Backend { cpu, cuda };

/// One world after its latest step. Powers are those of the last substep.
struct [[nodiscard]] StepReport {
  double time = 0;            // [s]
  double kinetic_energy = 0;  // [J]
  double gravity_power = 0;   // at the end of the step [W]
  double motor_power = 0;     // [W]
  double force_power = 0;     // of force elements [W]
  double spring_energy = 0;   // [J]
  double rms_residual = 0;    // over contacts; see contact_residual in split.h [m/s]
  double max_residual = 0;    // [m/s]
  Index contact_count = 0;
  Index iterations = 0;  // of the solver, over all substeps
  Index flags = 0;       // StepFlag bits raised so far
  Fault fault;           // the first of them
  Index slowed = 0;      // times that a body was slowed so far, see StepSettings::max_slowed
};

/// A sentence such as "body 12 in step 340 (at 0.34 s) has left the domain"; empty without a fault. `step` [s].
std::string description(const Fault& fault, double step);

/// Bodies in memory of the backend, which lives as long as `state` is held.
struct BodiesOnDevice {
  std::shared_ptr<BodyState> state;  // [count]
  Index count = 0;
  int gpu = -1;  // number of the CUDA device; -1: the host's memory
};

/// What a rank or GPU has of a divided world.
struct PartShare {
  Index bodies = 0, contacts = 0;  // its own; contacts of the latest step
  double load = 0;                 // share of all bodies and contacts, which borders balance
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Takes `count` steps of all worlds.
  virtual void advance(Index count) = 0;
  virtual StepReport report(WorldIndex world) = 0;
  /// Of all worlds, in fewer transfers from a GPU than one by one.
  virtual std::vector<StepReport> reports() = 0;

  /// Whether, when and why a world stopped. A stopped world is still stepped with the others, but its monitors are not.
  virtual WorldStop stop(WorldIndex world) = 0;
  virtual std::vector<WorldStop> stops() = 0;
  virtual MonitorState monitor(WorldIndex world, Index monitor) = 0;
  /// Samples `first` .. `first` + `count` - 1 of a monitor. Throws InputError when they have not all been recorded.
  virtual std::vector<MonitorSample> samples(WorldIndex world, Index monitor, Index first, Index count) = 0;

  virtual BodyState body(WorldIndex world, BodyIndex b) = 0;
  virtual void set_body(WorldIndex world, BodyIndex b, const BodyState& state) = 0;
  /// Sets many bodies at once: `states` in the order of `which`.
  virtual void set_bodies(WorldIndex world, const std::vector<BodyIndex>& which,
                          const std::vector<BodyState>& states) = 0;
  /// All bodies of a world, in the order of its scene.
  virtual std::vector<BodyState> bodies(WorldIndex world) = 0;
  /// The same for `count` worlds, one after the other, without leaving the backend's memory. Ready when it returns.
  virtual BodiesOnDevice bodies_on_device(WorldIndex first, WorldIndex count) = 0;

  virtual void set_gravity(WorldIndex world, const Vec3& gravity) = 0;
  virtual void set_law(WorldIndex world, int material_a, int material_b, const PairLaw& law) = 0;
  /// `target`: speed [rad/s] or torque [N m], by the motor's kind. Throws InputError for a motor that a controller or
  /// driveline sets.
  virtual void set_motor(WorldIndex world, Index motor, Real target, Real max_torque) = 0;
  /// From now on the controller's command has this value, whatever the time. A snapshot does not hold it. Throws
  /// InputError for a value that a controller of its type refuses.
  virtual void set_command(WorldIndex world, Index controller, double value) = 0;
  /// Likewise of a driveline: throttle and brake, 0 to 1.
  virtual void set_pedals(WorldIndex world, Index driveline, double throttle, double brake) = 0;
  /// Impulse of a motor in the last substep divided by its length [N m].
  virtual double motor_torque(WorldIndex world, Index motor) = 0;
  /// Load of a joint or spring on its body a in the last substep; zero before the world's first step and after restore.
  virtual JointLoad joint_load(WorldIndex world, Index joint) = 0;
  virtual JointLoad spring_load(WorldIndex world, Index spring) = 0;

  /// Sums of the contact impulses on bodies in the last substep divided by its length [N]. Zero before a world's first
  /// step and after restore.
  virtual std::vector<Vec3d> contact_forces(const std::vector<WorldBody>& of) = 0;
  Vec3d contact_force(WorldIndex world, BodyIndex b) { return contact_forces({{world, b}}).front(); }
  /// Contacts of a world in the latest step, and their impulses in the same order. Bodies are counted in their world.
  /// Empty before the world's first step and after restore.
  virtual std::vector<Contact> contacts(WorldIndex world) = 0;
  virtual std::vector<Impulse> impulses(WorldIndex world) = 0;

  virtual Snapshot snapshot(WorldIndex world) = 0;
  /// Reports and contact forces of the world are zero until its next step. Throws InputError for a snapshot of a world
  /// with other numbers of bodies, shapes, motors or elements.
  virtual void restore(WorldIndex world, const Snapshot& snapshot) = 0;

  /// Puts a new world into a place of the batch; the other worlds keep their bits. Throws InputError, naming the
  /// numbers, when the place is too small. The second form takes the result of flatten() for this place.
  virtual void replace(WorldIndex place, const SceneWorld& world) = 0;
  virtual void replace(WorldIndex place, FlatWorld world) = 0;

  virtual const StepSettings& settings() const = 0;

  /// By part; empty for worlds in one piece.
  virtual std::vector<PartShare> shares() { return {}; }
};

/// Throws InputError for a backend that this program was built without or that this machine lacks.
void require_backend(Backend backend);

/// `threads`: of the CPU backend. `room`: min size of every place, for larger worlds that will replace() the first
/// ones. Throws InputError for bad settings, a scene that the checks in sim/scene refuse, and as require_backend does.
/// Throws OutOfMemory, naming the bytes and the GPUs that would do, when a GPU's memory does not suffice.
std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads, const WorldSize& room = {});

std::unique_ptr<Simulation> make_cpu_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                const WorldSize& room, int threads);
std::unique_ptr<Simulation> make_cuda_simulation(std::vector<FlatWorld> worlds, const StepSettings& settings,
                                                 const WorldSize& room);

/// Stages of a step, in order; see step.h. `lists`: the contacts of each body, and tiles of contacts.
enum class Stage { bins, contacts, lists, motion, forces, solve, integrate };
inline constexpr int kStageCount = 7;
inline constexpr const char* kStageNames[kStageCount] = {"bins",   "contacts", "lists",    "motion",
                                                         "forces", "solve",    "integrate"};

struct StageTimes {
  double seconds[kStageCount] = {};  // [stage], wall clock

  double of(Stage stage) const { return seconds[int(stage)]; }
};

/// What a search for the contacts of all worlds found, and how long it took.
struct SearchReport {
  Index contact_count = 0;
  StageTimes times;  // bins and contacts
};

/// Measurements of a simulation: the time of each stage of a step, and the search for contacts by itself.
class StepByStage {
 public:
  virtual ~StepByStage() = default;

  /// Takes one step of all worlds and waits for the device after every stage. The same bits as advance(1).
  virtual StageTimes timed_step() = 0;
  /// Finds all contacts at the bodies' present positions, but takes no step. contacts(), impulses() and contact_force()
  /// are empty until the next step.
  virtual SearchReport timed_search() = 0;
  /// Bytes that one update of the latest step's contacts and bodies moves, if every record is moved once. Caches may
  /// move fewer to and from memory.
  virtual double solver_traffic() = 0;
};

/// The same object, as StepByStage.
StepByStage& by_stage(Simulation& simulation);

/// Bytes per second read and written while a large array is copied. Throws as require_backend does.
double copy_bandwidth(Backend backend, int threads);
double cpu_copy_bandwidth(int threads);
double cuda_copy_bandwidth();

/// Names of the CUDA devices of this machine; empty where there are none and in a build without CUDA.
std::vector<std::string> cuda_device_names();

/// GPUs 0, 1, ... that reach each other's memory, so that a world can be divided over them.
int linked_gpus();

/// Throws InputError, saying why, where there is no CUDA device.
void require_cuda_device();

/// Simulations that this thread makes from now on are on this device, counted from 0. Throws InputError when there is
/// none of that number.
void use_cuda_device(int index);

}  // namespace gonogo::sim
