// The matrix-free solver against a dense one, and the bound on its step sizes that it relies on.
#include <Eigen/Eigenvalues>

#include "sim/scene/scene.h"
#include "tests/sim/dense_problem.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

enum class Kind { grains, box_and_compound, wheel_on_rails, slender_rods };
constexpr const char* kNames[] = {"grains", "box and compound", "wheel on rails", "slender rods"};
constexpr Kind kKinds[] = {Kind::grains, Kind::box_and_compound, Kind::wheel_on_rails, Kind::slender_rods};

PairLaw random_law(Draw& draw) {
  return {Real(draw.below(4) ? draw.between(0.1, 1) : 0), Real(draw.below(2) ? draw.between(0.01, 0.3) : 0),
          Real(draw.below(2) ? draw.between(100, 3000) : 0)};
}

constexpr double kRadius = 0.02;

void add_grains(SceneWorld& w, Draw& draw, int nx, int ny, int nz, double mass_spread, bool fixed_grains) {
  for (int x = 0; x < nx; ++x)
    for (int y = 0; y < ny; ++y)
      for (int z = 0; z < nz; ++z) {
        const Vec3d at = Vec3d{2.0 * x, 2.0 * y, 2.0 * z + 1} * kRadius + draw.direction() * 5e-4;
        const BodyIndex b =
            w.add_sphere(at, Real(kRadius), density_for(0.05 * draw.magnitude(1, mass_spread), kRadius), draw.below(2));
        if (draw.below(8) == 0 && fixed_grains) w.mass[b] = fixed_body();
        if (w.mass[b].inverse_mass.x == 0) continue;
        w.body[b].velocity = static_cast<Vec3>(draw.direction() * 0.3);
        w.body[b].angular_velocity = static_cast<Vec3>(draw.direction() * 3.0);
      }
}

/// Two spheres rigidly joined by their centre of mass, above the grains.
void add_compound(SceneWorld& w, Draw& draw) {
  const BodyIndex b =
      w.add_body({{0.03, 0.02, 3.0 * kRadius}, about_y(draw.between(-0.2, 0.2)), {0, 0, Real(-0.2)}, {}},
                 solid(0.3f, {2e-4f, 4e-4f, 3e-4f}));
  for (const double side : {-1.0, 1.0}) {
    Shape s;
    s.body = b;
    s.material = 1;
    s.size.x = Real(kRadius);
    s.offset_B = {Real(side * kRadius), 0, 0};
    w.add_shape(s);
  }
}

/// Heavier along the rail than up and down, fixed sideways, turned by a motor.
void add_wheel(SceneWorld& w, Draw& draw) {
  Shape s;
  s.type = ShapeType::wheel;
  s.size = {0.15f, 0.05f, 0.02f};
  s.lug_count = 12;
  s.lug_thickness = 0.02f;
  BodyMass m = solid(Real(draw.magnitude(0.5, 5)), {1, 0.05f, 1});
  m.inverse_mass.x *= 0.2f;
  m.inverse_mass.y = 0;
  m.inverse_inertia_B.x = m.inverse_inertia_B.z = 0;
  s.body =
      w.add_body({{0.06, 0.04, 2 * kRadius + 0.162}, about_y(draw.between(0, 1)), {Real(0.2), 0, Real(-0.2)}, {}}, m);
  w.add_shape(s);
  const double speed = draw.between(-5, 5), limit = draw.magnitude(0.1, 30);
  w.motor.push_back(speed_motor(w, s.body, kWorld, {0, 1, 0}, speed, limit));
}

/// Capsules that turn a thousand times more easily about their axes than across: one leans on its tip, one lies across
/// the grains.
void add_rods(SceneWorld& w, Draw& draw) {
  const double radius = 0.01, half = 0.2, mass = draw.magnitude(0.1, 10);
  Shape s;
  s.type = ShapeType::capsule;
  s.size = {Real(radius), Real(half), 0};
  const double lean = draw.between(0.2, 1.4);
  const Vec3d leaning{-0.3, -0.1, half * std::sin(lean) + radius}, lying{0.04, 0.04, 4 * kRadius + radius};
  for (const auto& [at, q] :
       {std::pair{leaning, about_x(lean)}, std::pair{lying, about_x(draw.between(-0.02, 0.02))}}) {
    const Real across = Real(mass * half * half / 3), along = Real(mass * radius * radius / 2);
    s.body = w.add_body({at, q, {Real(0.5), 0, 0}, {0, 0, Real(0.3)}}, solid(Real(mass), {across, along, across}));
    w.add_shape(s);
  }
}

/// With fixed grains a wheel on rails may be caught beyond help: then there are no admissible velocities.
SceneWorld random_scene(Kind kind, std::uint64_t seed, bool fixed_grains) {
  Draw draw(500 + seed);
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b <= a; ++b) w.set_law(a, b, random_law(draw));
  add_plane(w);
  if (kind == Kind::grains) add_grains(w, draw, 3, 2, 2, 100, fixed_grains);
  if (kind == Kind::box_and_compound) {
    add_box(w, {{-3.0 * kRadius, 0.02, 0.0395}, about_x(draw.between(-0.02, 0.02)), {Real(0.2), 0, 0}, {}},
            {0.04f, 0.03f, 0.04f}, draw.magnitude(0.1, 10), 1);
    add_grains(w, draw, 3, 2, 1, 10, fixed_grains);
    add_compound(w, draw);
  }
  if (kind == Kind::wheel_on_rails) {
    add_grains(w, draw, 4, 3, 1, 10, fixed_grains);
    add_wheel(w, draw);
  }
  if (kind == Kind::slender_rods) {
    add_grains(w, draw, 3, 3, 2, 10, fixed_grains);
    add_rods(w, draw);
  }
  return w;
}

StepSettings cohesive_settings(Index iterations, Iteration iteration = Iteration::apgd) {
  StepSettings s = settings_with(iterations);
  s.iteration = iteration;
  s.cohesion_range = 1e-3f;
  return s;
}

struct Comparison {
  double error = 0;  // largest difference of a velocity at a body's surface [m/s]
  double oracle_residual = 0, engine_residual = 0;
  double kick = 0;  // largest velocity change that one contact alone gives a body [m/s]
  std::size_t contacts = 0;
};

Comparison compare(Backend backend, const SceneWorld& w, const StepSettings& settings) {
  const auto simulation = simulate(backend, w, settings);
  simulation->advance(1);
  const DenseProblem problem = dense_problem(w, w.body, simulation->contacts(0), simulation->settings().step);
  const DenseSolution oracle = solve(problem, 1e-10, 40000);
  Comparison c;
  c.contacts = simulation->contacts(0).size();
  c.oracle_residual = oracle.residual;
  c.engine_residual = simulation->report(0).max_residual;
  for (Eigen::Index row = 0; row < oracle.impulse.size(); ++row) {
    const Eigen::VectorXd change = problem.inverse_mass * problem.direction.col(row) * oracle.impulse(row);
    c.kick = std::max(c.kick, change.lpNorm<Eigen::Infinity>());
  }
  const auto after = simulation->bodies(0);
  for (std::size_t b = 0; b < after.size(); ++b) {
    const Vec3 &v = after[b].velocity, &s = after[b].angular_velocity;
    const Eigen::Vector3d linear = oracle.velocity.segment<3>(Eigen::Index(6 * b)) - Eigen::Vector3d(v.x, v.y, v.z);
    const Eigen::Vector3d spin = oracle.velocity.segment<3>(Eigen::Index(6 * b + 3)) - Eigen::Vector3d(s.x, s.y, s.z);
    c.error = std::max({c.error, linear.norm(), spin.norm() * kRadius});
  }
  return c;
}

/// `tolerance`: of a velocity, in parts of the largest kick.
void check_velocities(Backend backend, Kind kind, const StepSettings& settings, const char* solver, double tolerance) {
  double worst = 0;
  std::size_t min_count = 1000, max_count = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Comparison c = compare(backend, random_scene(kind, seed, kind != Kind::wheel_on_rails), settings);
    INFO(name_of(backend) << ", " << solver << ", " << kNames[int(kind)] << ", seed " << seed << ": " << c.contacts
                          << " contacts, velocity error " << c.error << " m/s, largest kick " << c.kick
                          << " m/s, residual of the oracle " << c.oracle_residual << ", of the engine "
                          << c.engine_residual << " m/s");
    REQUIRE(c.oracle_residual < 1e-9);
    // A body's velocity is a sum of kicks that cancel: each is rounded to 6e-8, and stacked contacts amplify that
    // some tens of times.
    CHECK(c.error < tolerance * c.kick);
    worst = std::max(worst, c.error);
    min_count = std::min(min_count, c.contacts);
    max_count = std::max(max_count, c.contacts);
  }
  WARN(name_of(backend) << ", " << solver << ", " << kNames[int(kind)] << ": largest velocity error " << worst
                        << " m/s over 8 scenes of " << min_count << " to " << max_count << " contacts");
  CHECK(min_count >= 10);
}

}  // namespace

TEST_CASE("the velocities of every solver agree with a dense solution in double") {
  const std::pair<const char*, StepSettings> methods[] = {
      {"apgd", cohesive_settings(2000)},
      {"gauss_seidel", cohesive_settings(2000, Iteration::gauss_seidel)},
      {"bb", cohesive_settings(6000, Iteration::bb)},
      {"jacobi", cohesive_settings(20000, Iteration::jacobi)},
      {"jacobi_scan", cohesive_settings(20000, Iteration::jacobi_scan)}};
  for (const Backend backend : backends())
    for (const auto& [name, settings] : methods)
      for (const Kind kind : kKinds) {
        // A grain wedged between fixed ones is pushed by thousands of m/s; only momentum settles that in so many
        // iterations.
        const bool wedged = kind == Kind::grains && settings.iteration != Iteration::apgd;
        check_velocities(backend, kind, settings, name, wedged ? 5e-5 : 5e-6);
      }
}

TEST_CASE("mass splitting bounds the Hessian: the largest eigenvalue of S^1/2 N S^1/2 is at most one") {
  for (const Kind kind : kKinds) {
    double largest = 0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const SceneWorld w = random_scene(kind, 100 + seed, true);
      const auto simulation = simulate(Backend::cpu, w, cohesive_settings(1));
      simulation->advance(1);
      const auto contacts = simulation->contacts(0);
      DenseProblem problem = dense_problem(w, w.body, contacts, simulation->settings().step);
      // Without rolling resistance the solver has no rolling rows.
      for (std::size_t c = 0; c < contacts.size(); ++c)
        if (contacts[c].rho == 0) problem.step.segment<2>(Eigen::Index(5 * c + 3)).setZero();
      const Eigen::VectorXd root = problem.step.cwiseSqrt();
      const Eigen::MatrixXd scaled = root.asDiagonal() * problem.hessian() * root.asDiagonal();
      const double value =
          Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
      INFO(kNames[int(kind)] << ", seed " << seed << ", " << contacts.size() << " contacts: " << value);
      // Single precision of the steps and arms; a contact counts as central when its arm is within 1e-3 rad of the
      // normal, which costs at most 1e-6 of the angular part.
      CHECK(value <= 1 + 2e-6);
      largest = std::max(largest, value);
    }
    WARN(kNames[int(kind)] << ": largest eigenvalue over 40 scenes " << largest);
    CHECK(largest > 0.3);  // a bound that is far from tight would only cost iterations
  }
}
