// A contact problem as an annealing problem: the quadratic program over polyhedral cones (sim/local_problem/
// bounded_program.h) with each multiplier a binary number,
//
//   x_j = range (b_j0 + 2 b_j1 + 4 b_j2 + ...) / (2^bits - 1)
//
// so that energies are scale (1/2 x M x + q x). An annealer answers with bits; more bits come closer to the exact
// solution, and cost variables and dynamic range of the couplings.
#pragma once
#include "learning/qubo/problem.h"
#include "learning/sampler/sampler.h"
#include "sim/local_problem/methods/bounded_program.h"

namespace gonogo::lab {

struct ContactEncoding {
  int bits = 3;      // of a multiplier, 1 .. 16
  double range = 0;  // largest value of a multiplier; 0: the smallest power of 2 above the exact ones
  double scale = 0;  // energy of the file per unit of the objective; 0: 20 for the depth of the exact minimum
};

struct ContactQubo {
  learning::Problem problem;  // BINARY, variables x0_0, x0_1, ...: multiplier and bit, low bit first
  sim::BoundedProgram program;
  ContactEncoding encoding;  // with the range and scale that were used

  /// Multipliers of a row of {0, 1}.
  std::vector<double> decode(std::span<const std::int8_t> row) const;
};

/// Throws InputError for an encoding out of range, and as bounded_program() does.
ContactQubo contact_qubo(const sim::LocalProblem& problem, int facets, const ContactEncoding& encoding);

/// What the best row of an answer is worth.
struct ContactAnswer {
  double energy_gap = 0;     // (objective - exact minimum) / |exact minimum|; 0 is the exact solution
  double impulse_error = 0;  // |r - r_exact| / |r_exact|
  double ccp_error = 0;      // sim::siconos_error of the impulses for the round cone: also the facets' share
  double hit_share = 0;      // of the reads within 1e-9 |minimum| of the best one
  std::vector<double> r;     // impulses, in the units of the contact problem
};
ContactAnswer judge(const ContactQubo& qubo, const sim::LocalProblem& problem, const learning::SampleSet& answer);

}  // namespace gonogo::lab
