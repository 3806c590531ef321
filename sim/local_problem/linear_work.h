// Work of the linear systems inside a solver of contact problems.
#pragma once
#include <cstddef>

namespace gonogo::sim {

struct LinearWork {
  long solves = 0, inner_iterations = 0;
  double setup_ms = 0, solve_ms = 0;       // ordering and factors; iterations
  std::size_t bytes = 0;                   // of the largest factors
  double multiply_adds = 0;                // of one factorisation; 0 where they are not counted
  std::ptrdiff_t half = 0, full_half = 0;  // half-bandwidth kept, and after reordering
  int partitions = 0;
  std::ptrdiff_t rank = 0;  // largest of a tensor train
  long builds = 0;          // of its inverse; fewer than Newton's matrices where one served several
  double dropped = 0;       // largest share of a matrix's Frobenius norm outside of the band
};

}  // namespace gonogo::sim
