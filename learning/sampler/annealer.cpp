#include "base/cancel.h"
#include "base/error.h"
#include "learning/sampler/annealing.h"
#include "learning/sampler/spins.h"

namespace gonogo::learning {

SampleSet Annealer::sample(const Problem& problem, const SampleRequest& request) const {
  const SpinGraph graph(to_ising(problem));
  SampleSet rows = empty_rows(problem, request.reads);
  const std::size_t rise = request.sweeps * 3 / 4;
#pragma omp parallel for schedule(static)
  for (std::size_t chain = 0; chain < request.reads; ++chain) {
    if (cancel_requested()) continue;
    ChainRandom random(request.seed, chain, graph.size());
    Spins spins(graph);
    random.begin(0);
    spins.randomise(random);
    for (std::size_t sweep = 0; sweep < request.sweeps; ++sweep) {
      const double way = sweep >= rise ? 1 : double(sweep) / double(rise);
      random.begin(sweep + 1);
      spins.sweep(settings_.beta_start + way * (settings_.beta_end - settings_.beta_start), random);
    }
    set_row(rows, chain, problem, spins.values());
  }
  stop_if_cancelled();
  return rows;
}

}  // namespace gonogo::learning
