// Contacts on polyhedral cones: in the plane the cone is exact; in space the error falls with the number of facets.

#include "sim/local_problem/methods/solve.h"
#include "sim/local_problem/read.h"
#include "tests/sim/local_problem/random_problem.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::sim;

namespace {

const std::vector<LocalSolver> kFamily = {local_solver("lemke"), local_solver("pgs"), local_solver("fb_newton"),
                                          local_solver("qp")};

LocalProblem from_file(const std::string& name) { return read_problem(GONOGO_SOURCE_DIR "/tests/data/fclib/" + name); }

}  // namespace

TEST_CASE("in the plane the polygon is the cone: the whole family agrees with the interior point") {
  for (unsigned seed = 1; seed <= 20; ++seed)
    for (const Target target : {Target::ccp, Target::coulomb}) {
      const LocalProblem p = random_problem(seed, 2, 4, 10, 1.5, 0.4);
      const LocalSolution reference = solve(p, {local_solver("pdip"), target, 1e-11, 0});
      for (const LocalSolver solver : kFamily) {
        const LocalSolution x = solve(p, {solver, target, 1e-10, 0});
        INFO("seed " << seed << " target " << int(target) << " " << solver_name(solver));
        CHECK(x.lcp_error < 1e-9);
        CHECK(x.error < 1e-8);
        if (target == Target::coulomb) continue;  // Coulomb's law may have several solutions
        for (std::size_t i = 0; i < x.r.size(); ++i) CHECK(x.r[i] == Approx(reference.r[i]).margin(1e-6));
      }
    }
}

TEST_CASE("in space the error falls with the number of facets, by all methods to the same impulses") {
  for (const Target target : {Target::ccp, Target::coulomb}) {
    const LocalProblem p = random_problem(3, 3, 5, 20, 1.5, 0.4);
    std::vector<double> error;
    for (const int facets : {4, 8, 16, 32, 64}) {
      LocalSolveSettings settings{local_solver("lemke"), target, 1e-10, 0};
      settings.facets = facets;
      const LocalSolution lemke = solve(p, settings);
      INFO("facets " << facets << " target " << int(target));
      CHECK(lemke.lcp_error < 1e-9);
      error.push_back(lemke.error);
      for (const LocalSolver solver : {local_solver("fb_newton"), local_solver("qp")}) {
        settings.solver = solver;
        const LocalSolution x = solve(p, settings);
        INFO(solver_name(solver) << " lcp error " << x.lcp_error);
        CHECK(x.lcp_error < 1e-8);
        if (target == Target::ccp)
          for (std::size_t i = 0; i < x.r.size(); ++i) CHECK(x.r[i] == Approx(lemke.r[i]).margin(1e-5));
      }
    }
    CHECK(error[0] > 3 * error[2]);
    CHECK(error[4] < 0.1 * error[0]);
    CHECK(error[4] < 0.02);
    CHECK(error[4] > 1e-8);  // a polygon is not the cone
  }
}

TEST_CASE("problems by others: impulses on many facets approach those of the round cone") {
  const LocalProblem p = from_file("NESpheres_10_1.dat");
  const LocalSolution round = solve(p, {local_solver("pdip"), Target::ccp, 1e-8, 0});
  for (const int facets : {4, 8, 16, 32, 64}) {
    LocalSolveSettings settings{local_solver("lemke"), Target::ccp, 1e-10, 0};
    settings.facets = facets;
    const LocalSolution x = solve(p, settings);
    CHECK(x.lcp_error < 1e-9);
    const std::vector<double> u = velocity(p, x.r), u_round = velocity(p, round.r);
    double difference = 0, size = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      difference += (u[i] - u_round[i]) * (u[i] - u_round[i]);
      size += u_round[i] * u_round[i];
    }
    INFO("facets " << facets);
    CHECK(std::sqrt(difference / size) < 2.0 / facets);
  }
}

TEST_CASE("the family refuses what it cannot do, and says so") {
  const LocalProblem rocks = from_file("RockPile_tob1.dat");
  const LocalSolution large = solve(rocks, {local_solver("lemke"), Target::coulomb, 1e-8, 0});
  CHECK(large.refusal.find("lemke refuses 4630 unknowns, more than 2000") == 0);
  CHECK(claimed_error(large) > 1e300);
  const LocalSolution skew = solve(from_file("Rover1040.dat"), {local_solver("qp"), Target::coulomb, 1e-8, 0});
  CHECK(skew.refusal.find("not symmetric") != std::string::npos);
  LocalSolveSettings odd;
  odd.facets = 7;
  refused([&] { solve(rocks, odd); }, "facets = 7; an even number from 4 to 256");
}
