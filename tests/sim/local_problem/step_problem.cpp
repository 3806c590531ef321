// The problem of an engine's step against a dense oracle that reads the engine's contacts by itself.
#include "sim/local_problem/step_problem.h"

#include "sim/local_problem/methods/solve.h"
#include "tests/sim/dense_problem.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Grains that fall into each other, a box among them, and a lid that slides up and down.
SceneWorld pile(std::uint64_t seed, double rolling) {
  constexpr double kRadius = 0.02;
  Draw draw(seed);
  SceneWorld w = open_world({0.5f, Real(rolling), 0});
  add_plane(w);
  for (int k = 0; k < 12; ++k) {
    const Vec3d at = (grid_place(k, 3, 2) * 2.0 + Vec3d{0, 0, 1}) * kRadius + draw.direction() * 5e-4;
    const BodyIndex b = w.add_sphere(at, Real(kRadius), density_for(0.05 * draw.magnitude(1, 10), kRadius), 0);
    w.body[b].velocity = static_cast<Vec3>(draw.direction() * 0.3);
    w.body[b].angular_velocity = static_cast<Vec3>(draw.direction() * 3.0);
  }
  add_box(w, {{-0.06, 0.02, 0.0395}, about_x(draw.between(-0.02, 0.02)), {Real(0.2), 0, 0}, {}}, {0.04f, 0.03f, 0.04f},
          0.5);
  const BodyIndex lid = add_plane(w, {0, 0, 4 * kRadius + 4e-4}, {0, 1, 0, 0});
  w.mass[lid].inverse_mass.z = 2;
  w.shape.front().group = w.shape.back().group = 1;  // floor and lid
  return w;
}

struct Step {
  SceneWorld world;
  std::vector<Contact> contacts;
  std::vector<Impulse> impulses;
  double length;
};

Step first_step(const SceneWorld& world) {
  const auto simulation = simulate(Backend::cpu, world, settings_with(4000));
  simulation->advance(1);
  return {world, simulation->contacts(0), simulation->impulses(0), simulation->settings().step};
}

StepProblem problem_of(const Step& s) { return {"step", s.world, s.world.body, s.contacts, s.length}; }

/// Of the freedoms that can change, from velocities of the oracle.
StepMotion motion_of(const SceneWorld& world, const DenseProblem& p, const Eigen::VectorXd& velocity) {
  StepMotion out;
  for (std::size_t b = 0; b < world.body.size(); ++b) {
    const Eigen::Index at = Eigen::Index(6 * b);
    const Eigen::Vector3d v = velocity.segment<3>(at), w = velocity.segment<3>(at + 3);
    const Eigen::Vector3d inverse = p.inverse_mass.block<3, 3>(at, at).diagonal();
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      if (inverse[k] > 0) momentum[k] = v[k] / inverse[k];
    out.momentum += Vec3d{momentum[0], momentum[1], momentum[2]};
    out.kinetic_energy += momentum.dot(v) / 2;
    const Eigen::Matrix3d turn = p.inverse_mass.block<3, 3>(at + 3, at + 3);
    if (turn.norm() > 0) out.kinetic_energy += w.dot(turn.inverse() * w) / 2;
  }
  return out;
}

}  // namespace

TEST_CASE("the problem of a step gives the motion that a dense oracle finds from the same contacts") {
  for (const double rolling : {0.0, 0.2})
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const Step s = first_step(pile(seed, rolling));
      const StepProblem problem = problem_of(s);
      CHECK(problem.local().dimension == (rolling > 0 ? 5 : 3));
      const DenseProblem dense = dense_problem(s.world, s.world.body, s.contacts, s.length);
      const DenseSolution oracle = test::solve(dense, 1e-10, 40000);
      REQUIRE(oracle.residual < 1e-9);
      const StepMotion expected = motion_of(s.world, dense, oracle.velocity);
      // Systems over bodies lose digits where impulses are not unique.
      for (const auto& [solver, error] : {std::pair{local_solver("pdip"), 1e-9},
                                          {local_solver("pdip_bodies"), 1e-6},
                                          {local_solver("anderson"), 1e-9}}) {
        const LocalSolution x = sim::solve(problem.local(), {solver, Target::ccp, error, 0});
        INFO(solver_name(solver) << " seed " << seed << " rolling " << rolling << " error " << x.error);
        CHECK(x.error <= error);
        const StepMotion found = problem.motion(x.r);
        CHECK(found.kinetic_energy == Approx(expected.kinetic_energy).epsilon(1e-4));
        CHECK(length(found.momentum - expected.momentum) < 1e-4 * length(expected.momentum));
      }
      // The engine's own impulses, in float.
      CHECK(siconos_error(problem.local(), problem.impulses(s.contacts, s.impulses), Target::ccp) < 1e-4);
    }
}

TEST_CASE("systems over bodies solve exact friction as those over contacts do") {
  const Step s = first_step(pile(7, 0));
  const StepProblem problem = problem_of(s);
  const LocalProblem& p = problem.local();
  const LocalSolution x = sim::solve(p, {local_solver("pdip_bodies"), Target::coulomb, 1e-8, 0});
  const LocalSolution reference = sim::solve(p, {local_solver("pdip"), Target::coulomb, 1e-8, 0});
  CHECK(x.error <= 1e-8);
  CHECK(reference.error <= 1e-8);
  const StepMotion a = problem.motion(x.r), b = problem.motion(reference.r);
  CHECK(a.kinetic_energy == Approx(b.kinetic_energy).epsilon(1e-4));
  CHECK(length(a.momentum - b.momentum) < 1e-4 * length(b.momentum));
}

TEST_CASE("without W, products by bodies and the solvers that need no more agree with those on W") {
  for (const double rolling : {0.0, 0.2}) {
    const Step s = first_step(pile(5, rolling));
    const StepProblem with = problem_of(s), without = {"step", s.world, s.world.body, s.contacts, s.length, 0};
    const LocalProblem &p = with.local(), &by_bodies = without.local();
    REQUIRE(p.is_whole);
    REQUIRE(!by_bodies.is_whole);
    CHECK(by_bodies.w.column.size() == by_bodies.mu.size());
    std::vector<double> r(p.q.size());
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = std::sin(double(k + 1));
    const std::vector<double> u = velocity(p, r), also = velocity(by_bodies, r);
    double largest = 0;
    for (const double value : u) largest = std::max(largest, std::fabs(value));
    for (std::size_t k = 0; k < u.size(); ++k) CHECK(std::fabs(also[k] - u[k]) < 1e-12 * largest);
    for (const LocalSolver solver :
         {local_solver("nsgs"), local_solver("apgd"), local_solver("anderson"), local_solver("jacobi"),
          local_solver("gauss_seidel"), local_solver("nesterov"), local_solver("pdip_bodies"), local_solver("pdip")}) {
      const LocalSolveSettings settings{solver, Target::ccp, 1e-5, 5000};
      const LocalSolution x = sim::solve(p, settings), y = sim::solve(by_bodies, settings);
      INFO(solver_name(solver) << " rolling " << rolling << " iterations " << x.iterations << ", " << y.iterations);
      CHECK(y.refusal.empty());
      CHECK(y.error <= std::max(1e-5, 1.01 * x.error));
      CHECK(std::abs(x.iterations - y.iterations) <= 10 + x.iterations / 10);
      CHECK(siconos_error(p, y.r, Target::ccp) == Approx(y.error).epsilon(1e-6));
      CHECK(without.motion(y.r).kinetic_energy == Approx(with.motion(x.r).kinetic_energy).epsilon(1e-3));
    }
    for (const LocalSolver solver :
         {local_solver("pdip_blocks"), local_solver("ppa"), local_solver("admm"), local_solver("minres")})
      CHECK(sim::solve(by_bodies, {solver, Target::ccp, 1e-5, 0}).refusal.find("without its matrix W") !=
            std::string::npos);
  }
}

TEST_CASE("interior points set a lid of many contacts apart, with and without W, and find the motion of gradients") {
  SceneWorld w = open_world({0.5f, 0, 0});
  add_plane(w);
  constexpr double kRadius = 0.02;
  Draw draw(11);
  for (int k = 0; k < 162; ++k) {
    const Vec3d at = (grid_place(k, 9, 9) * 2.0 + Vec3d{0, 0, 1}) * kRadius + draw.direction() * 2e-4;
    const BodyIndex b = w.add_sphere(at, Real(kRadius), density_for(0.05, kRadius), 0);
    w.body[b].velocity = static_cast<Vec3>(draw.direction() * 0.3);
  }
  const BodyIndex lid = add_plane(w, {0, 0, 4 * kRadius + 1e-4}, {0, 1, 0, 0});
  w.mass[lid].inverse_mass.z = 0.2f;
  w.shape.front().group = w.shape.back().group = 1;  // floor and lid
  const Step s = first_step(w);
  const StepProblem with = problem_of(s), without = {"step", s.world, s.world.body, s.contacts, s.length, 0};
  Index lid_contacts = 0;
  for (const Contact& c : s.contacts) lid_contacts += c.body_a == lid || c.body_b == lid;
  REQUIRE(lid_contacts > 48);
  const LocalSolution reference = sim::solve(with.local(), {local_solver("apgd"), Target::ccp, 1e-8, 0});
  REQUIRE(reference.error <= 1e-8);
  const StepMotion expected = with.motion(reference.r);
  for (const StepProblem* problem : {&with, &without})
    for (const auto& [solver, error] : {std::pair{local_solver("pdip"), 1e-7}, {local_solver("pdip_bodies"), 1e-5}}) {
      const LocalSolution x = sim::solve(problem->local(), {solver, Target::ccp, error, 0});
      INFO(solver_name(solver) << " whole " << problem->local().is_whole << " iterations " << x.iterations);
      CHECK(x.error <= error);
      CHECK(x.iterations <= 30);
      const StepMotion found = problem->motion(x.r);
      CHECK(found.kinetic_energy == Approx(expected.kinetic_energy).epsilon(1e-4));
      CHECK(length(found.momentum - expected.momentum) < 1e-4 * length(expected.momentum));
    }
}

TEST_CASE("a start of the right impulses is taken by those that can and refused by the others") {
  const Step s = first_step(pile(3, 0));
  const StepProblem problem = problem_of(s);
  LocalSolveSettings settings{local_solver("pdip"), Target::ccp, 1e-9, 0};
  settings.start = sim::solve(problem.local(), settings).r;
  for (const LocalSolver solver : {local_solver("nsgs"), local_solver("apgd"), local_solver("anderson")}) {
    settings.solver = solver;
    CHECK(takes_start(solver));
    CHECK(sim::solve(problem.local(), settings).iterations == 0);
  }
  settings.solver = local_solver("pdip");
  refused([&] { sim::solve(problem.local(), settings); }, "pdip takes no start");
  settings.solver = local_solver("nsgs");
  settings.start.pop_back();
  refused([&] { sim::solve(problem.local(), settings); }, "start has");
}

TEST_CASE("a step problem refuses what it does not know, and systems over bodies a problem without them") {
  SceneWorld apart = open_world({0.5f, 0, 0});
  add_plane(apart);
  apart.add_sphere({0, 0, 1}, 0.1f, 1000, 0);
  const Step none = first_step(apart);
  refused([&] { problem_of(none); }, "step: the step has no contact");
  SceneWorld sticky = pile(1, 0);
  sticky.set_law(0, 0, {0.5f, 0, 1000});
  const Step cohesive = first_step(sticky);
  refused([&] { problem_of(cohesive); }, "has no cohesion");
  const LocalProblem alone = make_problem("alone", 3, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}}, {-1, 0, 0}, {0.5});
  CHECK(sim::solve(alone, {local_solver("pdip_bodies"), Target::ccp, 1e-8, 0}).refusal.find("bodies are not known") !=
        std::string::npos);
}
