// Contact dynamics: batches of worlds of rigid bodies and their contacts, on CPU or CUDA. Link gonogo::sim.
//
// A world has one frame; heights are along z. Bodies are numbered from 0 in the order in which they were added, worlds
// in that of the batch. Numbers that do not exist throw InputError.
#pragma once
#include <gonogo/common.h>

#include <memory>

namespace gonogo::api {

/// Number of materials in a world: they are 0 to kMaterials - 1.
inline constexpr int kMaterials = 4;

/// How two materials touch.
struct ContactLaw {
  double friction = 0;           // sliding [-]
  double rolling_friction = 0;   // [-], times the sphere's radius
  double cohesion_pressure = 0;  // tensile strength on the area pi r^2 of the smaller sphere [Pa]
};

/// Position and motion of a body in the world's frame.
struct BodyState {
  Vec3 position{};  // of its centre of mass [m]
  Quat orientation{};
  Vec3 velocity{};          // [m/s]
  Vec3 angular_velocity{};  // [rad/s]
};

/// A box in which bodies move. A body that leaves it stops its world with a fault.
struct WorldBox {
  Vec3 origin{}, size{1, 1, 1};  // lower corner, edges [m]
  Vec3 gravity{0, 0, -9.80665};  // [m/s^2]
  bool periodic_x = false, periodic_y = false;
};

/// A triangulated height per node of a regular grid, for ground that bodies roll on.
struct HeightGrid {
  int nx = 0, ny = 0;            // nodes along x and y, at least 2
  double spacing = 0;            // [m]
  std::vector<double> height{};  // [ny][nx] over the grid's origin [m]
};

/// A world at its start. Copies are independent.
class World {
 public:
  struct Impl;
  explicit World(const WorldBox& box);
  explicit World(std::unique_ptr<Impl> impl);
  World(const World& other);
  World(World&&) noexcept;
  World& operator=(World other) noexcept;
  ~World();

  /// Add a solid body and return its number. `density` [kg/m^3]; 0: the body is fixed. `half`: half axes or half edges
  /// along the body's axes [m]. Throw InputError for sizes that are not above zero.
  int add_sphere(const BodyState& at, double radius, double density, int material = 0);
  int add_ellipsoid(const BodyState& at, const Vec3& half, double density, int material = 0);
  int add_box(const BodyState& at, const Vec3& half, double density, int material = 0);
  /// Add fixed ground: a level plane, heights around the middle of their grid at `centre`, or a closed mesh from a file
  /// (.stl, .obj; `scale`: metres per unit) with its origin at `origin`.
  int add_floor(double height, int material = 0);
  int add_heights(const Vec3& centre, const HeightGrid& grid, int material = 0);
  int add_mesh(const Vec3& origin, const std::filesystem::path& file, double scale = 1, int material = 0);

  /// Sets the law of a pair of materials, which may be equal.
  void set_law(int material_a, int material_b, const ContactLaw& law);
  int body_count() const;

  Impl& impl() { return *impl_; }
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Numbers of a step. Bed::step_settings() gives those that suit grains.
struct StepSettings {
  double step = 1e-3;            // [s]
  int iterations = 100;          // max of the solver in a substep
  double tolerance = 0;          // root-mean-square residual at which a world stops iterating [m/s]; 0: never
  int substeps = 1;              // of a step
  double envelope = 2e-3;        // contacts are found up to this gap [m]
  double recovery_speed = 0.1;   // overlaps are pushed out no faster than this [m/s]
  double cohesion_range = 5e-4;  // cohesion acts up to this gap [m]
  Device device = Device::cpu;
  int threads = 1;  // of the CPU; results do not depend on it
};

/// One world after its latest step.
struct StepReport {
  double time = 0;                            // [s]
  double kinetic_energy = 0;                  // [J]
  double motor_power = 0;                     // in the last substep [W]
  double rms_residual = 0, max_residual = 0;  // over contacts [m/s]
  int contacts = 0, iterations = 0;           // of the step, over all substeps
  std::string fault{};                        // why the world stopped, as one sentence; empty: it has not
};

/// A contact of the latest step.
struct Contact {
  int body_a = 0, body_b = 0;
  Vec3 normal{};   // unit, from b to a
  double gap = 0;  // at the start of the step, negative: overlap [m]
  Vec3 impulse{};  // on a in the last substep [N s]
};

/// State from which a world goes on with the same bits. Cheap to copy.
class Snapshot {
 public:
  struct Impl;
  explicit Snapshot(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// A batch of worlds that take their steps together. The same worlds and settings give the same bits on one device.
class Simulation {
 public:
  struct Impl;
  /// Throws InputError for shapes that the engine refuses, DeviceError for too little memory of the device.
  explicit Simulation(const std::vector<World>& worlds, const StepSettings& settings = {});
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  void step(int count = 1);
  int world_count() const;
  StepReport report(int world = 0) const;

  /// [body]
  std::vector<BodyState> bodies(int world = 0) const;
  BodyState body(int body, int world = 0) const;
  void set_body(int body, const BodyState& state, int world = 0);
  std::vector<Contact> contacts(int world = 0) const;
  /// Sum of the contact forces on a body in the last substep, world frame [N].
  Vec3 contact_force(int body, int world = 0) const;

  void set_gravity(const Vec3& gravity, int world = 0);  // [m/s^2]
  void set_law(int material_a, int material_b, const ContactLaw& law, int world = 0);
  /// Holds a speed [rad/s] with at most this torque [N m]. Motors come with vehicles.
  void set_motor(int motor, double speed, double max_torque, int world = 0);
  /// In the last substep [N m].
  double motor_torque(int motor, int world = 0) const;

  Snapshot snapshot(int world = 0) const;
  /// Throws InputError for the snapshot of a world with other bodies.
  void restore(const Snapshot& snapshot, int world = 0);
  /// Checkpoint files (HDF5), whole or absent. load() throws InputError for a file of another world or other settings.
  void save(const std::filesystem::path& file, int world = 0) const;
  void load(const std::filesystem::path& file, int world = 0);

  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// A run as files for ParaView: spheres.pvd, surfaces.pvd and contacts.pvd in a folder, which is created.
class VtkFrames {
 public:
  VtkFrames(const std::filesystem::path& folder, const World& world);
  VtkFrames(VtkFrames&&) noexcept;
  ~VtkFrames();
  /// Adds the present state of that world. Throws DeviceError when a file cannot be written.
  void write(const Simulation& simulation, int world = 0);
  int count() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names of the CUDA devices that this build can use.
std::vector<std::string> cuda_devices();

}  // namespace gonogo::api
