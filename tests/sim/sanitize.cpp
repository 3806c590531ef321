// Everything that the engine does, in a batch of four tiny worlds and a few steps, short enough to run under
// compute-sanitizer's memcheck, racecheck and initcheck (scripts/gpu_check.sh does) or a host sanitizer.
#include <cstring>
#include <set>

#include "sim/scene/check_scene.h"
#include "sim/scene/scene.h"
#include "sim/shape/meshes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

constexpr Index kSteps = 4;

SceneWorld empty_world(const PairLaw& law) {
  SceneWorld w;
  w.origin = {-2, -2, -1};
  w.size = {4, 4, 3};
  w.set_law(0, 0, law);
  return w;
}

void add_solid(SceneWorld& w, ShapeType type, const Vec3d& at, const Quat& q, int group = 0) {
  Shape s;
  s.type = type;
  s.size = type == ShapeType::wheel ? Vec3{0.15f, 0.05f, 0.02f} : Vec3{0.08f, 0.12f, 0.1f};
  s.lug_count = type == ShapeType::wheel ? 8 : 0;
  s.lug_thickness = 0.02f;
  s.group = group;
  if (type == ShapeType::mesh) s.surface = w.add_mesh(box_mesh({0.1f, 0.1f, 0.1f}, 2));
  s.body = w.add_body({at, q, {Real(0.2), 0, Real(-0.1)}, {0, Real(0.5), 0}}, solid(3, {0.02f, 0.03f, 0.025f}));
  w.add_shape(s);
}

/// Grains of two sizes with every law of friction, cohesion and fixed ones among them, periodic.
SceneWorld grains() {
  Draw draw(1);
  SceneWorld w = empty_world({Real(0.5), Real(0.1), Real(500)});
  w.origin = {0, 0, -0.2};
  w.size = {0.32, 0.32, 2};
  w.periodic_x = w.periodic_y = true;
  w.law[0][0].spinning_friction = 0.1f;
  add_plane(w);
  for (int k = 0; k < 48; ++k) {
    const Vec3d at = scale(grid_place(k, 4, 4), {0.08, 0.08, 0.078}) + Vec3d{0, 0, 0.04};
    const BodyIndex b = w.add_sphere(at + draw.direction() * 1e-3, Real(k % 5 ? 0.04 : 0.03), 2600, 0);
    if (k % 7 == 0) w.mass[b] = fixed_body();
  }
  return w;
}

/// Every shape on rough ground that is a heightfield, a grain on the mesh and one on the wheel; a mesh on a plane.
SceneWorld on_heightfield() {
  Draw draw(2);
  SceneWorld w = empty_world({Real(0.6), 0, 0});
  Heightfield f;
  f.name = "rough";
  f.nx = f.ny = 8;
  f.spacing_x = f.spacing_y = 0.4f;
  for (int k = 0; k < 64; ++k) f.height.push_back(Real(draw.between(-0.01, 0.01)));
  Shape ground;
  ground.type = ShapeType::heightfield;
  ground.surface = w.add_heightfield(f);
  ground.body = w.add_body({}, fixed_body());
  w.add_shape(ground);
  add_plane(w, {0, 0, -0.6});
  add_solid(w, ShapeType::cylinder, {-0.5, 0, 0.08}, {});
  add_solid(w, ShapeType::box, {0, 0, 0.1}, {});
  add_solid(w, ShapeType::wheel, {0.5, 0, 0.17}, {});
  add_solid(w, ShapeType::mesh, {1, 0, 0.09}, {});
  add_solid(w, ShapeType::mesh, {-1.8, 0, -0.5}, {});  // beyond the grid, on the plane
  w.add_sphere({1, 0, 0.23}, 0.04f, 2600, 0);
  w.add_sphere({0.5, 0, 0.38}, 0.04f, 2600, 0);
  add_solid(w, ShapeType::capsule, {1.17, 0, 0.1}, {});
  add_solid(w, ShapeType::capsule, {-1, 0, 0.08}, {});
  return w;
}

/// Solids on and beside each other on a plane; contacts are springs.
SceneWorld solids() {
  SceneWorld w = empty_world({Real(0.5), 0, 0});
  w.law[0][0].stiffness = 1e5f;
  w.law[0][0].damping = 50;
  add_plane(w);
  const ShapeType types[] = {ShapeType::capsule, ShapeType::cylinder, ShapeType::box};
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b <= a; ++b) {
      const double x = 0.6 * a - 0.6, y = 0.6 * b - 0.6, low = types[a] == ShapeType::box ? 0.1 : 0.08;
      add_solid(w, types[a], {x, y, low}, {});
      add_solid(w, types[b], {x, y, 2 * low + (types[b] == ShapeType::box ? 0.1 : 0.08)}, about_x(0.2));
    }
  for (int a = 0; a < 3; ++a) {
    add_solid(w, ShapeType::wheel, {0.6 * a - 0.6, 1.2, 0.17}, {}, 1);
    add_solid(w, types[a], {0.6 * a - 0.355, 1.2, 0.17}, {}, 2);
  }
  for (const double x : {-0.6, -0.26}) add_solid(w, ShapeType::wheel, {x, 1.7, 0.17}, {});
  const ShapeType on_mesh[] = {ShapeType::cylinder, ShapeType::box, ShapeType::wheel, ShapeType::mesh};
  for (int a = 0; a < 4; ++a) {
    const double x = 0.5 * a - 0.9, above = on_mesh[a] == ShapeType::cylinder ? 0.28 : a == 2 ? 0.37 : 0.3;
    add_solid(w, ShapeType::mesh, {x, -1.3, 0.1}, {});
    add_solid(w, on_mesh[a], {x + 0.02, -1.3, above}, about_x(0.01));
  }
  return w;
}

Controller controller(ControllerType type, Index motor, BodyIndex body) {
  Controller c;
  c.type = type;
  c.motor = motor;
  c.body = body;
  c.command = {{0, 0}, {0.01, type == ControllerType::throttle ? 0.5 : 1}};
  c.limit = {{0, 20}, {30, 10}};
  c.proportional = 5;
  c.integral = 10;
  c.top_speed = 20;
  return c;
}

/// Five bodies that hang from each other by joints of every type; the last one.
BodyIndex add_chain(SceneWorld& w, BodyIndex ground) {
  BodyIndex last = ground;
  for (int k = 0; k < 5; ++k) {
    const Vec3d here{-1.5 + 0.2 * k, 1.5, 1}, next = here + Vec3d{0.2, 0, 0};
    const BodyIndex link = w.add_body({here + Vec3d{0.1, 0, 0}, {}, {}, {}}, solid(1, {0.01f, 0.02f, 0.03f}));
    if (k == 0) w.joint.push_back(universal(w, link, last, here, {0, 1, 0}, {0, 0, 1}));
    if (k == 1) w.joint.push_back(spherical(w, link, last, here));
    if (k == 2) w.joint.push_back(fixed(w, link, last, here));
    if (k == 3) w.joint.push_back(distance(w, link, last, here, here - Vec3d{0.1, 0, 0}));
    if (k == 4) w.joint.push_back(revolute(w, link, last, here, {0, 1, 0}));
    if (k == 4) {
      w.spring.push_back(spring_about(w.joint.back(), 0.1, 5, 0.1));
      w.motor.push_back(torque_motor(w.joint.back(), 0.2));
    }
    w.spring.push_back(spring_between(w, link, ground, next, next + Vec3d{0, 0, 0.5}, 200, 5));
    last = link;
  }
  return last;
}

/// A cart on four wheels and a chain of all joints: springs, motors, controllers, forces and monitors.
SceneWorld machine() {
  SceneWorld w = empty_world({Real(0.8), Real(0.01), 0});
  const BodyIndex ground = add_plane(w);
  const BodyIndex frame = add_box(w, {{0, 0, 0.5}, {}, {}, {}}, {0.4f, 0.2f, 0.05f}, 30);
  w.shape.back().group = 1;
  for (int k = 0; k < 4; ++k) {
    const Vec3d at{k / 2 ? 0.4 : -0.4, k % 2 ? 0.35 : -0.35, 0.15};
    const BodyIndex hub = w.add_body({at, {}, {}, {}}, solid(2, {0.02f, 0.02f, 0.02f}));
    const BodyIndex wheel = w.add_body({at, {}, {}, {}}, solid(4, {0.05f, 0.08f, 0.05f}));
    Shape s;
    s.type = ShapeType::cylinder;
    s.size = {0.15f, 0.05f, 0};
    s.body = wheel;
    s.group = 1;
    w.add_shape(s);
    w.joint.push_back(prismatic(w, hub, frame, at, {0, 0, 1}));
    w.spring.push_back(spring_along(w.joint.back(), 0, 8000, 200));
    w.joint.push_back(revolute(w, wheel, hub, at, {0, 1, 0}));
    w.motor.push_back(speed_motor(w.joint.back(), 3, 15));
    w.controller.push_back(controller(ControllerType(k), k, frame));
  }
  const BodyIndex last = add_chain(w, ground);
  w.spring.back().table = force_table({{-0.1, -50}, {0, 0}, {0.1, 20}});
  w.force = {aerodynamic_drag(frame, 1.2, 1, 0.5, {0, 0, 0.1f}), tow_load(last, ReferenceFrame::body, {1, 0, 0}, 3)};
  Monitor m;
  m.body = frame;
  m.motor = 1;
  m.time_limit = 1;
  m.immobile_window = 0.004;
  m.immobile_speed = 1e-6;
  w.monitor.push_back(m);
  return w;
}

Scene four_worlds() { return {grains(), on_heightfield(), solids(), machine()}; }

StepSettings settings_with(Iteration iteration, Target target, Index substeps) {
  StepSettings s;
  s.iteration = iteration;
  s.target = target;
  s.substeps = substeps;
  s.iterations = 12;
  s.tolerance = 1e-5f;
  return s;
}

using Bodies = std::vector<std::vector<BodyState>>;

bool same_bits(const Bodies& a, const Bodies& b) {
  for (std::size_t w = 0; w < a.size(); ++w)
    for (std::size_t i = 0; i < a[w].size(); ++i)
      if (std::memcmp(&a[w][i].position, &b[w][i].position, sizeof(Vec3d)) != 0 ||
          std::memcmp(&a[w][i].velocity, &b[w][i].velocity, sizeof(Vec3)) != 0)
        return false;
  return true;
}

double furthest_apart(const Bodies& a, const Bodies& b) {
  double max = 0;
  for (std::size_t w = 0; w < a.size(); ++w)
    for (std::size_t i = 0; i < a[w].size(); ++i) max = std::max(max, length(a[w][i].position - b[w][i].position));
  return max;
}

/// Steps, and everything that may be asked for or changed between them; where all bodies are at the end.
Bodies exercised(Backend backend, const StepSettings& settings) {
  const Scene scene = four_worlds();
  const auto simulation = make_simulation(backend, scene, settings, 1, flatten(scene[0], 0, settings).size());
  simulation->advance(kSteps);
  const Snapshot saved = simulation->snapshot(3);
  double asked = 0;
  for (Index j = 0; j < Index(scene[3].joint.size()); ++j) asked += length(simulation->joint_load(3, j).force);
  for (Index s = 0; s < Index(scene[3].spring.size()); ++s) asked += length(simulation->spring_load(3, s).force);
  asked += simulation->motor_torque(3, 4) + length(simulation->contact_force(2, 0));
  for (const MonitorSample& s : simulation->samples(3, 0, 0, simulation->monitor(3, 0).sample_count)) asked += s.work;
  CHECK(std::isfinite(asked));
  simulation->set_motor(3, 4, Real(-0.1), 1);
  simulation->set_law(2, 0, 0, {Real(0.3), 0, 0});
  simulation->set_gravity(1, {Real(0.5), 0, Real(-9.5)});
  BodyState lifted = simulation->body(0, 48);
  lifted.position.z += 0.1;
  simulation->set_body(0, 48, lifted);
  simulation->advance(1);
  simulation->replace(1, grains());  // fewer bodies and no heightfield in the place of a larger world
  simulation->restore(3, saved);
  simulation->advance(kSteps);
  Bodies end;
  for (WorldIndex w = 0; w < 4; ++w) {
    end.push_back(simulation->bodies(w));
    const StepReport report = simulation->report(w);
    INFO(name_of(backend) << ", world " << w);
    CHECK(report.flags == 0);
    CHECK(report.contact_count > 0);
  }
  return end;
}

/// Pairs of types that touch in the latest step of a world whose bodies have one shape each.
void add_touching(Simulation& simulation, WorldIndex w, const SceneWorld& world,
                  std::set<std::pair<ShapeType, ShapeType>>& found) {
  std::vector<ShapeType> type(world.body.size(), ShapeType::none);
  for (const Shape& s : world.shape) type[std::size_t(s.body)] = s.type;
  for (const Contact& c : simulation.contacts(w))
    found.insert(std::minmax(type[std::size_t(c.body_a)], type[std::size_t(c.body_b)]));
}

}  // namespace

TEST_CASE("the tiny worlds hold a contact of every kind of pair") {
  for (const Backend backend : backends()) {
    const Scene scene = four_worlds();
    const auto simulation = make_simulation(backend, scene, {}, 1);
    simulation->advance(1);
    std::set<std::pair<ShapeType, ShapeType>> found;
    for (WorldIndex w = 0; w < 3; ++w) add_touching(*simulation, w, scene[std::size_t(w)], found);
    using enum ShapeType;
    for (const auto& [a, b] :
         std::initializer_list<std::pair<ShapeType, ShapeType>>{{sphere, sphere},       {sphere, plane},
                                                                {sphere, wheel},        {sphere, mesh},
                                                                {capsule, capsule},     {capsule, cylinder},
                                                                {capsule, box},         {capsule, wheel},
                                                                {capsule, mesh},        {capsule, plane},
                                                                {cylinder, cylinder},   {cylinder, box},
                                                                {cylinder, wheel},      {cylinder, mesh},
                                                                {cylinder, plane},      {box, box},
                                                                {box, wheel},           {box, mesh},
                                                                {box, plane},           {wheel, wheel},
                                                                {wheel, mesh},          {wheel, plane},
                                                                {mesh, mesh},           {mesh, plane},
                                                                {capsule, heightfield}, {cylinder, heightfield},
                                                                {box, heightfield},     {wheel, heightfield},
                                                                {mesh, heightfield}}) {
      INFO(name_of(backend) << ": " << name_of(a) << " and " << name_of(b));
      CHECK(found.count({a, b}) == 1);
    }
  }
}

TEST_CASE("all that the engine does gives the same bits again, and on the GPU what the CPU gives") {
  struct Case {
    Iteration iteration;
    Target target;
    Index substeps;
  };
  for (const Case& c : {Case{Iteration::apgd, Target::ccp, 1}, Case{Iteration::apgd, Target::coulomb, 2},
                        Case{Iteration::jacobi, Target::ccp, 1}, Case{Iteration::gauss_seidel, Target::coulomb, 2},
                        Case{Iteration::bb, Target::coulomb, 2}, Case{Iteration::jacobi_scan, Target::coulomb, 2}}) {
    const StepSettings settings = settings_with(c.iteration, c.target, c.substeps);
    const Bodies on_cpu = exercised(Backend::cpu, settings);
    for (const Backend backend : backends()) {
      const Bodies here = exercised(backend, settings);
      CHECK(same_bits(here, exercised(backend, settings)));
      // Sums in another order: rounding may restart the momentum of an unconverged solve an update earlier or later.
      CHECK(agrees(std::string("tiny worlds, ") + name_of(backend) + " against CPU: largest distance [m]", 0,
                   furthest_apart(here, on_cpu), 1e-4));
    }
  }
}

TEST_CASE("two short steps of the tiny worlds by every solver") {  // few enough for racecheck
  for (const Backend backend : backends())
    for (const Iteration iteration :
         {Iteration::apgd, Iteration::jacobi, Iteration::gauss_seidel, Iteration::bb, Iteration::jacobi_scan}) {
      StepSettings settings = settings_with(iteration, Target::coulomb, 2);
      settings.iterations = 3;
      settings.tolerance = 0;
      const auto simulation = make_simulation(backend, four_worlds(), settings, 1);
      simulation->advance(2);
      for (WorldIndex w = 0; w < 4; ++w) {
        CHECK(simulation->report(w).iterations == 6);
        CHECK(simulation->report(w).flags == 0);
      }
    }
}

TEST_CASE("a step that finds more contacts than there is room for is taken again") {
  for (const Backend backend : backends()) {
    SceneWorld crowd = empty_world({Real(0.5), 0, 0});
    for (int k = 0; k < 216; ++k) crowd.add_sphere(grid_place(k, 6, 6) * 0.05, 0.025f, 1000, 0);
    StepSettings settings = settings_with(Iteration::apgd, Target::ccp, 1);
    settings.envelope = 0.03f;
    const auto simulation = simulate(backend, crowd, settings);
    simulation->advance(3);
    CHECK(simulation->report(0).contact_count > 1024);
    CHECK(simulation->report(0).time == Approx(3e-3));
    CHECK(simulation->report(0).flags == 0);
  }
}
