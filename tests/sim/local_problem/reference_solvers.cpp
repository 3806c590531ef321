// Methods as published, the minimal-residual method and Krylov interior points, against the interior point method.

#include "sim/local_problem/methods/solve.h"
#include "sim/local_problem/read.h"
#include "tests/sim/local_problem/random_problem.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::sim;

namespace {

LocalProblem from_file(const std::string& name) { return read_problem(GONOGO_SOURCE_DIR "/tests/data/fclib/" + name); }

}  // namespace

TEST_CASE("one step of the published fixed point is what its formula says") {
  // W = 4, eta = 3 / 12: omega 0.5, r = 0, u = q = (-2, 3, 4): next = P_K(0.125 (2, -3, -4)); lambda 0.5 halves it.
  const LocalProblem p = make_problem("one", 3, {{0, 0, 4}, {1, 1, 4}, {2, 2, 4}}, {-2, 3, 4}, {0.5});
  const double n = (0.25 + 0.5 * 0.625) / 1.25, t = 0.5 * n;
  for (const LocalSolver solver : {local_solver("jacobi"), local_solver("gauss_seidel")}) {
    LocalSolveSettings settings{solver, Target::ccp, 1e-12, 1};
    settings.omega = 0.5;
    settings.lambda = 0.5;
    const LocalSolution x = solve(p, settings);
    CHECK(x.r[0] == Approx(n / 2).epsilon(1e-14));
    CHECK(x.r[1] == Approx(-t * 0.6 / 2).epsilon(1e-14));
    CHECK(x.r[2] == Approx(-t * 0.8 / 2).epsilon(1e-14));
  }
}

TEST_CASE("published methods and the minimal-residual method find the interior point's impulses") {
  for (const int dimension : {2, 3, 5})
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const int contacts = 4;
      const LocalProblem p =
          random_problem(seed, dimension, contacts, dimension * contacts + 6, 1, 0.5);  // W regular: one solution
      const LocalSolution reference = solve(p, {local_solver("pdip"), Target::ccp, 1e-12, 0});
      for (const auto& [solver, error] : {std::pair{local_solver("gauss_seidel"), 1e-9},
                                          {local_solver("minres"), 1e-9},
                                          {local_solver("pdip_spike"), 1e-8},
                                          {local_solver("nesterov"), 1e-7},
                                          {local_solver("pdip_krylov"), 1e-4}}) {
        const LocalSolution x = solve(p, {solver, Target::ccp, error, 0});
        INFO("dimension " << dimension << " seed " << seed << " " << solver_name(solver) << " error " << x.error);
        CHECK(x.error <= error);
        if (error < 1e-7)
          for (std::size_t i = 0; i < x.r.size(); ++i) CHECK(x.r[i] == Approx(reference.r[i]).margin(1e-5));
      }
      const LocalSolution jacobi = solve(p, {local_solver("jacobi"), Target::ccp, 1e-6, 0});
      CHECK(jacobi.error <= 1e-6);
    }
}

TEST_CASE("the minimal-residual method needs fewer products with W than gradients do") {
  const LocalProblem p = from_file("BoxesStack1-i100000-32.hdf5.dat");
  const LocalSolution minres = solve(p, {local_solver("minres"), Target::ccp, 1e-8, 0});
  const LocalSolution gradients = solve(p, {local_solver("apgd"), Target::ccp, 1e-8, 0});  // a product each
  CHECK(minres.error <= 1e-8);
  CHECK(gradients.error <= 1e-8);
  INFO(minres.linear.inner_iterations << " products, " << gradients.iterations << " gradients");
  CHECK(minres.linear.inner_iterations < gradients.iterations);
}

TEST_CASE("the interior point by preconditioned Krylov says what its linear systems took") {
  for (const Target target : {Target::ccp, Target::coulomb}) {
    const LocalProblem p = from_file("NESpheres_10_1.dat");
    const LocalSolution with = solve(p, {local_solver("pdip_spike"), target, 1e-7, 0});
    const LocalSolution without = solve(p, {local_solver("pdip_krylov"), target, 1e-7, 0});
    CHECK(with.error <= 1e-7);
    CHECK(with.linear.solves == 2 * with.iterations);
    CHECK(with.linear.bytes > 0);
    CHECK(with.linear.partitions >= 1);
    CHECK(without.linear.bytes == 0);
    CHECK(2 * with.linear.inner_iterations < without.linear.inner_iterations);
  }
}

TEST_CASE("methods of the relaxation refuse exact friction, and relaxation out of range is refused") {
  const LocalProblem p = from_file("Rover1040.dat");
  for (const LocalSolver solver :
       {local_solver("jacobi"), local_solver("gauss_seidel"), local_solver("nesterov"), local_solver("minres")}) {
    const LocalSolution x = solve(p, {solver, Target::coulomb, 1e-8, 0});
    CHECK(x.refusal.find("refuses coulomb") != std::string::npos);
    CHECK(claimed_error(x) > 1e300);
  }
  LocalSolveSettings settings{local_solver("jacobi"), Target::ccp, 1e-8, 0};
  settings.omega = 2.5;
  refused([&] { solve(p, settings); }, "omega = 2.5");
}
