#include "pipeline/lab/bench/step_scenes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "pipeline/lab/scenes/scene.h"

namespace gonogo::lab {
namespace {

constexpr double kStep = 1e-3, kFriction = 0.5;
/// Contacts are found up to this gap. Wider ones cannot close in a step of these scenes, and their bias, gap / step,
/// would dwarf the other speeds by which an error is measured.
constexpr double kEnvelope = 3e-4;  // [m]
constexpr Index kLastSteps = 50;    // at kStep, after the scene has settled

/// A world not yet settled, and what is done to it.
struct Start {
  sim::SceneWorld world;
  double settle_time = 0;                                        // [s]
  double diameter = 1;                                           // of the spheres [m]
  double drive_time = 0;                                         // [s], after `drive`
  std::vector<std::pair<sim::BodyIndex, sim::BodyState>> drive;  // velocities to prescribe once settled
};

constexpr int kWalls = 1;  // group of planes, which never meet each other

double between(std::uint64_t draw, double low, double high) { return low + (high - low) * random_unit(1, 0, draw); }

Real density_of(double mass, double radius) { return Real(mass / (4.0 / 3 * kPi * radius * radius * radius)); }

/// Fixed walls around [low, high] in x and y, a floor at z = 0, and room above. A body each, so that bodies name
/// contacts.
void add_box(sim::SceneWorld& world, const Vec3d& low, const Vec3d& high, double margin) {
  const auto wall = [&](const Vec3d& at, const Quat& turn) {
    add_plane(world, world.add_body({}, sim::fixed_body()), at, turn);
  };
  wall({}, {});
  wall({low.x, 0, 0}, towards(0, 1));
  wall({high.x, 0, 0}, towards(0, -1));
  wall({0, low.y, 0}, towards(1, 1));
  wall({0, high.y, 0}, towards(1, -1));
  for (sim::Shape& s : world.shape)
    if (s.type == sim::ShapeType::plane) s.group = kWalls;
  world.origin = low - Vec3d{margin, margin, margin};
  world.size = high - low + Vec3d{2 * margin, 2 * margin, 2 * margin};
  world.set_law(0, 0, {Real(kFriction), 0, 0});
}

Start filling(int bodies) {
  constexpr double kRadius = 0.4, kWiggle = 0.1;
  constexpr int kLayers = 10;
  const int n = std::max(1, int(std::lround(std::sqrt(bodies / double(kLayers)))));
  const double half = 0.5 * n + kRadius - 0.5;
  Start s{.world = {}, .settle_time = 1.2, .diameter = 2 * kRadius, .drive = {}};
  std::uint64_t draw = 0;
  for (int z = 0; z < kLayers; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double dx = between(draw++, -kWiggle, kWiggle), dy = between(draw++, -kWiggle, kWiggle);
        s.world.add_sphere({x + 0.5 - 0.5 * n + dx, y + 0.5 - 0.5 * n + dy, z + 0.5}, Real(kRadius),
                           density_of(1, kRadius), 0);
      }
  const Real lid_mass = Real(kLayers) * Real(n) * Real(n);
  const sim::BodyIndex lid = s.world.add_body({{0, 0, kLayers + 0.5}, {}, {}, {}}, {{0, 0, 1 / lid_mass}, {}});
  add_plane(s.world, lid, {}, {0, 1, 0, 0});
  add_box(s.world, {-half - 0.1, -half - 0.1, 0}, {half + 0.1, half + 0.1, kLayers + 2.0}, 1);
  return s;
}

/// Columns of a lattice of this pitch in length x width, as high as `count` spheres need.
void add_lattice(Start& s, int count, double length, double width, double smallest, double largest, double density) {
  const double pitch = 2.02 * largest;
  const int nx = std::max(1, int(length / pitch)), ny = std::max(1, int(width / pitch));
  for (int k = 0; k < count; ++k) {
    const int x = k % nx, y = k / nx % ny, z = k / (nx * ny);
    const std::uint64_t draw = 3 * std::uint64_t(k);
    const double aside = 0.01 * largest;
    s.world.add_sphere({(x + 0.5) * length / nx + between(draw, -aside, aside),
                        (y + 0.5) * width / ny + between(draw + 1, -aside, aside), (z + 0.5) * pitch},
                       Real(between(draw + 2, smallest, largest)), Real(density), 0);
  }
}

Start drafting(int bodies) {
  constexpr double kSmallest = 0.008, kLargest = 0.016, kSpeed = 0.2;
  const double scale = std::cbrt(bodies / 20000.0), length = scale, width = 0.6 * scale;
  Start s{.world = {}, .settle_time = 1.0, .diameter = kSmallest + kLargest, .drive_time = 0.25, .drive = {}};
  const double thick = std::max(0.01 * scale, 0.004), x = 0.75 * length;
  add_lattice(s, bodies, length, width, kSmallest, kLargest, 2600);
  // No sphere starts inside the blade.
  const sim::BodyState state{{x, width / 2, 0.35 * scale}, {}, {}, {}};
  for (sim::BodyState& b : s.world.body)
    if (std::fabs(b.position.x - x) < thick + 1.2 * kLargest) b.position.z += 2 * scale + 10 * kLargest;
  sim::Shape blade;
  blade.type = sim::ShapeType::box;
  blade.body = s.world.add_body(state, sim::fixed_body());
  blade.size = {Real(thick / 2), Real(width / 2), Real(0.1 * scale)};
  s.world.add_shape(blade);
  sim::BodyState driven = state;
  driven.velocity = {Real(-kSpeed), 0, 0};
  s.drive = {{blade.body, driven}};
  add_box(s.world, {0, 0, 0}, {length, width, 6 * scale + 40 * kLargest}, 0.1);
  return s;
}

Start stack(int bodies) {
  constexpr double kRadius = 0.1;
  Start s{.world = {}, .diameter = 2 * kRadius, .drive = {}};
  for (int k = 0; k < bodies; ++k)
    s.world.add_sphere({0, 0, (2 * k + 1) * kRadius}, Real(kRadius), density_of(k + 1 == bodies ? 10 : 1, kRadius), 0);
  add_box(s.world, {-1, -1, 0}, {1, 1, 2 * kRadius * bodies + 1}, 1);
  return s;
}

Start wheel(int bodies) {
  constexpr double kRadius = 0.02, kDensity = 2600;
  const double side = std::max(2.0, std::cbrt(bodies / 8.0)), pitch = 2.05 * kRadius;
  const double length = 4 * side * pitch, width = 2 * side * pitch, radius = 0.8 * side * pitch;
  Start s{.world = {}, .settle_time = 0.4, .diameter = 2 * kRadius, .drive_time = 0.3, .drive = {}};
  add_lattice(s, bodies, length, width, 0.9 * kRadius, 1.1 * kRadius, kDensity);
  const double top = s.world.body.back().position.z + 2 * kRadius;
  const double mass = 0.1 * bodies * kDensity * 4.0 / 3 * kPi * kRadius * kRadius * kRadius;
  const sim::BodyState state{{length / 3, width / 2, top + radius}, {}, {}, {}};
  sim::Shape tyre;
  tyre.type = sim::ShapeType::wheel;
  tyre.body = s.world.add_body(state, {{Real(1 / mass), 0, Real(1 / mass)}, {}});
  tyre.size = {Real(radius), Real(0.4 * side * pitch), 0};
  s.world.add_shape(tyre);
  sim::BodyState driven = state;
  driven.angular_velocity = {0, Real(0.5 * std::sqrt(kGravity / radius)), 0};
  s.drive = {{tyre.body, driven}};
  add_box(s.world, {0, 0, 0}, {length, width, top + 4 * radius}, 0.2);
  return s;
}

sim::StepSettings settings_of(const Start& start, double step, int iterations, double envelope) {
  sim::StepSettings s;
  s.step = Real(step);
  s.iterations = iterations;
  s.envelope = Real(envelope);
  s.recovery_speed = Real(std::sqrt(kGravity * start.diameter) / 10);
  return s;
}

/// Throws Cancelled between steps when the user asked to stop.
void advance(sim::Simulation& simulation, Index steps) {
  constexpr Index kAtOnce = 10;
  for (Index done = 0; done < steps; done += kAtOnce) {
    stop_if_cancelled();
    simulation.advance(std::min(kAtOnce, steps - done));
  }
}

void require_sound(sim::Simulation& simulation, const std::string& name) {
  if (const sim::StepReport report = simulation.report(0); report.flags != 0)
    throw DeviceError(name + ": " + sim::description(report.fault, simulation.settings().step));
}

void settle(Start& start, const std::string& name, int threads, sim::Backend backend) {
  constexpr double kCoarse = 2e-3;
  const auto run = [&](double time) {
    if (!(time > 0)) return;
    const auto simulation =
        sim::make_simulation(backend, {start.world}, settings_of(start, kCoarse, 50, 0.05 * start.diameter), threads);
    advance(*simulation, Index(std::ceil(time / kCoarse)));
    require_sound(*simulation, name);
    start.world.body = simulation->bodies(0);
  };
  run(start.settle_time);
  for (const auto& [body, state] : start.drive) {
    start.world.body[body].velocity = state.velocity;
    start.world.body[body].angular_velocity = state.angular_velocity;
  }
  run(start.drive_time);
}

int moving_bodies(const sim::SceneWorld& world) {
  return int(std::count_if(world.mass.begin(), world.mass.end(), [](const auto& m) { return !sim::is_fixed(m); }));
}

struct StepSceneRow {
  const char* name;
  Start (*start)(int bodies);
  int most_bodies;
};
constexpr StepSceneRow kStepScenes[] = {{"filling", filling, 1'000'000},
                                        {"drafting", drafting, 1'000'000},
                                        {"stack", stack, 1000},
                                        {"wheel", wheel, 1'000'000}};

}  // namespace

std::vector<std::string> step_scene_names() {
  std::vector<std::string> names;
  for (const StepSceneRow& row : kStepScenes) names.push_back(row.name);
  return names;
}

StepScene step_scene(const std::string& name) {
  for (std::size_t k = 0; k < std::size(kStepScenes); ++k)
    if (kStepScenes[k].name == name) return StepScene(k);
  throw InputError("scene \"" + name + "\" is unknown; possible are " + join_words(step_scene_names()));
}

std::string step_scene_name(StepScene scene) { return kStepScenes[int(scene)].name; }

SceneStep settled_step(StepScene scene, int bodies, int threads, sim::Backend backend) {
  const auto& [word, start_of, most] = kStepScenes[int(scene)];
  if (bodies < 1 || bodies > most)
    throw InputError(std::string(word) + ": bodies = " + std::to_string(bodies) + "; 1 to " + std::to_string(most) +
                     " are possible");
  Start start = start_of(bodies);
  const std::string name = std::string(word) + " " + std::to_string(moving_bodies(start.world));
  settle(start, name, threads, backend);
  SceneStep step{
      .name = name, .bodies = moving_bodies(start.world), .settings = settings_of(start, kStep, 100, kEnvelope)};
  const auto simulation = sim::make_simulation(backend, {start.world}, step.settings, threads);
  advance(*simulation, kLastSteps);
  require_sound(*simulation, name);
  step.earlier = simulation->contacts(0);
  step.earlier_impulse = simulation->impulses(0);
  start.world.body = simulation->bodies(0);
  step.world = std::move(start.world);
  const auto anew = sim::make_simulation(backend, {step.world}, step.settings, threads);  // its order holds
  anew->advance(1);
  step.contacts = anew->contacts(0);
  return step;
}

sim::StepProblem step_problem(const SceneStep& step, std::size_t most_whole) {
  return {step.name, step.world, step.world.body, step.contacts, step.settings.step, most_whole};
}

std::vector<double> warm_start(const SceneStep& step, const sim::StepProblem& problem) {
  std::map<std::pair<sim::BodyIndex, sim::BodyIndex>, sim::Impulse> known;  // on the first of the two bodies
  for (std::size_t k = 0; k < step.earlier.size(); ++k) {
    const sim::Impulse& p = step.earlier_impulse[k];
    known[{step.earlier[k].body_a, step.earlier[k].body_b}] = p;
    known[{step.earlier[k].body_b, step.earlier[k].body_a}] = {-p.linear, 0, -p.angular, 0};
  }
  std::vector<sim::Impulse> of_step;
  for (const sim::Contact& c : step.contacts) {
    const auto at = known.find({c.body_a, c.body_b});
    of_step.push_back(at == known.end() ? sim::Impulse{} : at->second);
  }
  return problem.impulses(step.contacts, of_step);
}

}  // namespace gonogo::lab
