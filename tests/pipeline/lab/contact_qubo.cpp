// A contact problem as an annealing problem: energies against the quadratic program, samplers against enumeration.
#include "pipeline/lab/contact_qubo.h"

#include <random>

#include "sim/local_problem/read.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::lab;

namespace {

/// One contact that slides: r_n = (2 + 0.5 |q_t|) / (1 + 0.25) / 4 on the round cone.
sim::LocalProblem sliding() {
  return sim::make_problem("sliding", 3, {{0, 0, 4}, {1, 1, 4}, {2, 2, 4}}, {-2, 3, 1}, {0.5});
}

sim::LocalProblem three_contacts() {
  return sim::read_problem(GONOGO_SOURCE_DIR "/tests/data/fclib/FC3D_Example1.dat");
}

/// The lowest energy of all rows.
double enumerated(const learning::Problem& problem) {
  const std::size_t n = problem.variable_count();
  std::vector<std::int8_t> row(n);
  double lowest = 1e300;
  for (std::uint64_t code = 0; code < std::uint64_t(1) << n; ++code) {
    for (std::size_t i = 0; i < n; ++i) row[i] = std::int8_t(code >> i & 1);
    lowest = std::min(lowest, learning::energy(problem, row));
  }
  return lowest;
}

}  // namespace

TEST_CASE("energies of the annealing problem are the scaled objective of the decoded multipliers") {
  const ContactQubo qubo = contact_qubo(three_contacts(), 4, {.bits = 3});
  learning::check_problem(qubo.problem, "contact");
  REQUIRE(qubo.problem.variable_count() == 3 * 4 * 3);
  std::mt19937 generator(1);
  for (int k = 0; k < 200; ++k) {
    std::vector<std::int8_t> row;
    for (std::size_t i = 0; i < qubo.problem.variable_count(); ++i) row.push_back(std::int8_t(generator() & 1));
    CHECK(learning::energy(qubo.problem, row) ==
          Approx(qubo.encoding.scale * qubo.program.objective(qubo.decode(row))).margin(1e-9));
  }
}

TEST_CASE("the exact minimum is that of the polygon's program, and bits come closer to it") {
  const sim::LocalProblem problem = sliding();
  double before = 1e300;
  for (const int bits : {1, 2, 3, 4}) {
    const ContactQubo qubo = contact_qubo(problem, 4, {.bits = bits, .range = 1});
    const double lowest = enumerated(qubo.problem) / qubo.encoding.scale;
    CHECK(lowest >= qubo.program.minimum - 1e-12);
    CHECK(lowest <= before + 1e-12);
    const double resolution = 1 / (std::exp2(bits) - 1);  // half of it per multiplier, at the curvature of M
    double curvature = 0;
    for (const double m : qubo.program.m) curvature += std::abs(m);
    CHECK(lowest - qubo.program.minimum <= 0.5 * curvature * resolution * resolution / 4);
    before = lowest;
  }
}

TEST_CASE("samplers find the best row that enumeration knows, and its impulses near the exact ones") {
  const sim::LocalProblem problem = sliding();
  const ContactQubo qubo = contact_qubo(problem, 4, {.bits = 4});
  const double lowest = enumerated(qubo.problem);
  for (const char* name : {"anneal", "tempering", "exact"}) {
    const auto answer = learning::make_sampler(name)->sample(qubo.problem, {.reads = 300, .seed = 5, .sweeps = 500});
    INFO(name);
    CHECK(*std::min_element(answer.energies.begin(), answer.energies.end()) == Approx(lowest).margin(1e-9));
    const ContactAnswer judged = judge(qubo, problem, answer);
    CHECK(judged.energy_gap == Approx(lowest / qubo.encoding.scale / -qubo.program.minimum + 1).margin(1e-9));
    CHECK(judged.energy_gap >= 0);
    CHECK(judged.impulse_error < 0.1);
    CHECK(judged.hit_share > 0);
  }
}

TEST_CASE("what cannot be encoded is refused") {
  refused([] { contact_qubo(sliding(), 4, {.bits = 0}); }, "bits = 0; a number from 1 to 16");
  refused([] { contact_qubo(sliding(), 4, {.range = -1}); }, "range = -1");
  refused([] { contact_qubo(sim::read_problem(GONOGO_SOURCE_DIR "/tests/data/fclib/RockPile_tob1.dat"), 4, {}); },
          "1852 unknowns; at most 400");
  refused([] { contact_qubo(sim::read_problem(GONOGO_SOURCE_DIR "/tests/data/fclib/Rover1040.dat"), 4, {}); },
          "W is not symmetric");
}
