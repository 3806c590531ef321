// Speed of block Gibbs sampling of a restricted Boltzmann machine.
#pragma once
#include <cstddef>

namespace gonogo::lab {

struct GibbsBench {
  std::size_t visible = 168, hidden = 168;
  std::size_t chains = 65'536, sweeps = 1000;
  int repeats = 5;
  bool on_gpu = false;
  int threads = 1;
};

struct GibbsBenchResult {
  double seconds = 0;         // median of all sweeps
  double updates_per_ns = 0;  // units drawn, of both sides
  double mean_visible = 0;    // over units and chains at the end
};

/// Weights are normal deviates of standard deviation 0.1, biases of 0.5. Transfers to and from a GPU are not timed.
GibbsBenchResult bench_gibbs(const GibbsBench& request);

}  // namespace gonogo::lab
