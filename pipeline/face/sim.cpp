#include <gonogo/sim.h>

#include <algorithm>
#include <utility>

#include "base/progress.h"
#include "pipeline/face/inside.h"
#include "sim/io/checkpoint.h"
#include "sim/io/vtk_series.h"
#include "sim/shape/meshes.h"

namespace gonogo::api {
namespace {

sim::BodyState state_of(const BodyState& s) {
  const Quat& q = s.orientation;
  return {double_of(s.position),
          {Real(q.w), Real(q.x), Real(q.y), Real(q.z)},
          real_of(s.velocity),
          real_of(s.angular_velocity)};
}

BodyState state_of(const sim::BodyState& s) {
  const gonogo::Quat& q = s.orientation;
  return {vec3_of(s.position), {q.w, q.x, q.y, q.z}, vec3_of(s.velocity), vec3_of(s.angular_velocity)};
}

void check_material(int material) {
  if (material < 0 || material >= kMaterials)
    throw gonogo::InputError("material " + std::to_string(material) + ": there are 0 to " +
                             std::to_string(kMaterials - 1));
}

/// Adds a body of one shape. `share` of the squares of its half axes makes its moments: 1/3 of a box, 1/5 of an
/// ellipsoid.
int add_solid(sim::SceneWorld& world, const BodyState& at, sim::Shape shape, double mass, const Vec3& half,
              double share) {
  check_material(shape.material);
  if (!(half.x > 0 && half.y > 0 && half.z > 0) || !(mass >= 0))
    throw gonogo::InputError("body " + std::to_string(world.body.size()) +
                             ": its sizes must be above zero and its density not below zero");
  const auto moment = [&](double a, double b) { return Real(mass * share * (a * a + b * b)); };
  const gonogo::Vec3 inertia{moment(half.y, half.z), moment(half.x, half.z), moment(half.x, half.y)};
  shape.body = world.add_body(state_of(at), mass > 0 ? sim::solid(Real(mass), inertia) : sim::fixed_body());
  world.add_shape(shape);
  return shape.body;
}

int add_fixed(sim::SceneWorld& world, const Vec3& at, sim::Shape shape) {
  check_material(shape.material);
  shape.body = world.add_body(state_of(BodyState{.position = at}), sim::fixed_body());
  world.add_shape(shape);
  return shape.body;
}

sim::Shape shape_of(sim::ShapeType type, int material, const gonogo::Vec3& size = {}) {
  sim::Shape shape;
  shape.type = type;
  shape.material = material;
  shape.size = size;
  return shape;
}

sim::StepSettings settings_of(const StepSettings& s) {
  sim::StepSettings result;
  result.step = Real(s.step);
  result.iterations = s.iterations;
  result.tolerance = Real(s.tolerance);
  result.substeps = s.substeps;
  result.envelope = Real(s.envelope);
  result.recovery_speed = Real(s.recovery_speed);
  result.cohesion_range = Real(s.cohesion_range);
  return result;
}

}  // namespace

struct Snapshot::Impl {
  sim::Snapshot state;
};

World::World(const WorldBox& box) : impl_(std::make_unique<Impl>()) {
  sim::SceneWorld& world = impl_->scene;
  world.origin = double_of(box.origin);
  world.size = double_of(box.size);
  world.gravity = real_of(box.gravity);
  world.periodic_x = box.periodic_x;
  world.periodic_y = box.periodic_y;
}
World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(const World& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World other) noexcept {
  impl_ = std::move(other.impl_);
  return *this;
}
World::~World() = default;

int World::add_sphere(const BodyState& at, double radius, double density, int material) {
  return add_ellipsoid(at, {radius, radius, radius}, density, material);
}

int World::add_ellipsoid(const BodyState& at, const Vec3& half, double density, int material) {
  const bool sphere = half.x == half.y && half.y == half.z;
  const double mass = density * 4 / 3 * kPi * half.x * half.y * half.z;
  return guarded([&] {
    const sim::Shape shape = sphere ? shape_of(sim::ShapeType::sphere, material, {Real(half.x), 0, 0})
                                    : shape_of(sim::ShapeType::ellipsoid, material, real_of(half));
    return add_solid(impl_->scene, at, shape, mass, half, 1.0 / 5);
  });
}

int World::add_box(const BodyState& at, const Vec3& half, double density, int material) {
  const double mass = density * 8 * half.x * half.y * half.z;
  return guarded([&] {
    return add_solid(impl_->scene, at, shape_of(sim::ShapeType::box, material, real_of(half)), mass, half, 1.0 / 3);
  });
}

int World::add_floor(double height, int material) {
  const Vec3d &o = impl_->scene.origin, &size = impl_->scene.size;
  return guarded([&] {
    return add_fixed(impl_->scene, {o.x + size.x / 2, o.y + size.y / 2, height},
                     shape_of(sim::ShapeType::plane, material));
  });
}

int World::add_heights(const Vec3& centre, const HeightGrid& grid, int material) {
  return guarded([&] {
    sim::Heightfield field;
    field.name = "heights";
    field.nx = grid.nx;
    field.ny = grid.ny;
    field.spacing_x = field.spacing_y = Real(grid.spacing);
    field.height.assign(grid.height.begin(), grid.height.end());
    sim::Shape shape = shape_of(sim::ShapeType::heightfield, material);
    shape.surface = impl_->scene.add_heightfield(std::move(field));
    return add_fixed(impl_->scene, centre, shape);
  });
}

int World::add_mesh(const Vec3& origin, const std::filesystem::path& file, double scale, int material) {
  return guarded([&] {
    sim::Shape shape = shape_of(sim::ShapeType::mesh, material);
    shape.surface = impl_->scene.add_mesh(sim::read_mesh(file, scale));
    return add_fixed(impl_->scene, origin, shape);
  });
}

void World::set_law(int material_a, int material_b, const ContactLaw& law) {
  guarded([&] {
    check_material(material_a);
    check_material(material_b);
    impl_->scene.set_law(material_a, material_b, law_of(law));
  });
}

int World::body_count() const { return int(impl_->scene.body.size()); }

Simulation::Simulation(const std::vector<World>& worlds, const StepSettings& settings)
    : impl_(std::make_unique<Impl>()) {
  guarded([&] {
    if (worlds.empty()) throw gonogo::InputError("simulation: at least one world is needed");
    for (const World& world : worlds) impl_->world.push_back(world.impl().scene);
    impl_->engine =
        sim::make_simulation(backend_of(settings.device), impl_->world, settings_of(settings), settings.threads);
  });
}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

void Simulation::step(int count) {
  constexpr int kGroup = 10;  // steps between two looks for Ctrl-C
  guarded([&] {
    if (count < 0) throw gonogo::InputError("step: " + std::to_string(count) + " steps; zero or more are needed");
    for (int done = 0; done < count; done += kGroup) {
      stop_if_cancelled();
      impl_->engine->advance(std::min(kGroup, count - done));
    }
  });
}

int Simulation::world_count() const { return int(impl_->world.size()); }

StepReport Simulation::report(int world) const {
  return guarded([&] {
    const sim::StepReport r = impl_->at(world).report(world);
    return StepReport{.time = r.time,
                      .kinetic_energy = r.kinetic_energy,
                      .motor_power = r.motor_power,
                      .rms_residual = r.rms_residual,
                      .max_residual = r.max_residual,
                      .contacts = int(r.contact_count),
                      .iterations = int(r.iterations),
                      .fault = r.flags ? sim::description(r.fault, impl_->engine->settings().step) : ""};
  });
}

std::vector<BodyState> Simulation::bodies(int world) const {
  return guarded([&] {
    std::vector<BodyState> result;
    for (const sim::BodyState& s : impl_->at(world).bodies(world)) result.push_back(state_of(s));
    return result;
  });
}
BodyState Simulation::body(int body, int world) const {
  return guarded([&] { return state_of(impl_->with_body(world, body).body(world, body)); });
}
void Simulation::set_body(int body, const BodyState& state, int world) {
  guarded([&] { impl_->with_body(world, body).set_body(world, body, state_of(state)); });
}

std::vector<Contact> Simulation::contacts(int world) const {
  return guarded([&] {
    const auto contacts = impl_->at(world).contacts(world);
    const auto impulses = impl_->at(world).impulses(world);
    std::vector<Contact> result;
    for (std::size_t k = 0; k < contacts.size(); ++k)
      result.push_back({contacts[k].body_a, contacts[k].body_b, vec3_of(contacts[k].normal), contacts[k].gap,
                        vec3_of(impulses[k].linear)});
    return result;
  });
}
Vec3 Simulation::contact_force(int body, int world) const {
  return guarded([&] { return vec3_of(impl_->with_body(world, body).contact_force(world, body)); });
}

void Simulation::set_gravity(const Vec3& gravity, int world) {
  guarded([&] { impl_->at(world).set_gravity(world, real_of(gravity)); });
}
void Simulation::set_law(int material_a, int material_b, const ContactLaw& law, int world) {
  guarded([&] {
    check_material(material_a);
    check_material(material_b);
    impl_->at(world).set_law(world, material_a, material_b, law_of(law));
  });
}
void Simulation::set_motor(int motor, double speed, double max_torque, int world) {
  guarded([&] { impl_->with_motor(world, motor).set_motor(world, motor, Real(speed), Real(max_torque)); });
}
double Simulation::motor_torque(int motor, int world) const {
  return guarded([&] { return impl_->with_motor(world, motor).motor_torque(world, motor); });
}

Snapshot Simulation::snapshot(int world) const {
  return guarded(
      [&] { return Snapshot(std::make_shared<Snapshot::Impl>(Snapshot::Impl{impl_->at(world).snapshot(world)})); });
}
void Simulation::restore(const Snapshot& snapshot, int world) {
  guarded([&] { impl_->at(world).restore(world, snapshot.impl().state); });
}
void Simulation::save(const std::filesystem::path& file, int world) const {
  guarded([&] {
    sim::Simulation& engine = impl_->at(world);
    sim::save_checkpoint(file, engine.snapshot(world),
                         sim::scene_hash(impl_->world[std::size_t(world)], engine.settings()));
  });
}
void Simulation::load(const std::filesystem::path& file, int world) {
  guarded([&] {
    sim::Simulation& engine = impl_->at(world);
    engine.restore(world,
                   sim::load_checkpoint(file, sim::scene_hash(impl_->world[std::size_t(world)], engine.settings())));
  });
}

struct VtkFrames::Impl {
  sim::VtkSeries series;
};
VtkFrames::VtkFrames(const std::filesystem::path& folder, const World& world)
    : impl_(guarded([&] { return std::make_unique<Impl>(Impl{sim::VtkSeries(folder, world.impl().scene)}); })) {}
VtkFrames::VtkFrames(VtkFrames&&) noexcept = default;
VtkFrames::~VtkFrames() = default;
void VtkFrames::write(const Simulation& simulation, int world) {
  guarded([&] { impl_->series.write(sim::capture_world(simulation.impl().at(world), world)); });
}
int VtkFrames::count() const { return impl_->series.frame_count(); }

std::vector<std::string> cuda_devices() { return sim::cuda_device_names(); }

}  // namespace gonogo::api
