// Simulated annealing of eight chains at once. beta rises linearly from beta_start to beta_end over the first three
// quarters of the sweeps, with Metropolis' rule. The last quarter is heat-bath sweeps at beta_end. Rows follow
// exp(-beta_end E) as far as that quarter equilibrates. Draws depend on (seed, chain, sweep) alone, so bits do not
// depend on threads.
#include <algorithm>

#include "base/progress.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kRefresh = 64;  // sweeps after which the fields are summed anew

/// Rows of chains first ... first + 7, as far as the request goes.
template <class Real>
void anneal_lanes(double beta_start, double beta_end, const SpinGraph& graph, const Problem& problem,
                  const SampleRequest& request, std::size_t first, SampleSet& rows) {
  const std::size_t rise = request.sweeps * 3 / 4;
  LaneRandom random(request.seed, first, graph.size());
  SpinLanes<Real> spins(graph);
  random.begin(0);
  spins.randomise(random);
  for (std::size_t sweep = 0; sweep < request.sweeps; ++sweep) {
    const double way = sweep >= rise ? 1 : double(sweep) / double(rise);
    random.begin(sweep + 1);
    if (sweep % kRefresh == kRefresh - 1) spins.refresh();
    spins.sweep(beta_start + way * (beta_end - beta_start), sweep >= rise ? TurnRule::heat_bath : TurnRule::metropolis,
                random);
  }
  std::vector<std::int8_t> row(graph.size());
  for (std::size_t chain = first; chain < std::min(first + kLanes, request.reads); ++chain) {
    spins.read(int(chain - first), row);
    set_row(rows, chain, problem, row);
  }
}

SampleSet anneal(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const auto beta_start = setting<double>(settings, "beta_start"), beta_end = setting<double>(settings, "beta_end");
  const SpinGraph graph(to_ising(problem));
  const bool single = single_precision_holds(graph, std::max(beta_start, beta_end));
  SampleSet rows = empty_rows(problem, request.reads);
#pragma omp parallel for schedule(dynamic)
  for (std::size_t first = 0; first < request.reads; first += kLanes) {
    if (cancel_requested()) continue;
    if (single)
      anneal_lanes<float>(beta_start, beta_end, graph, problem, request, first, rows);
    else
      anneal_lanes<double>(beta_start, beta_end, graph, problem, request, first, rows);
  }
  stop_if_cancelled();
  return rows;
}

}  // namespace

extern const SamplerKind kAnneal = {.name = "anneal",
                                    .title = "Annealer",
                                    .about = "Simulated annealing from beta_start to beta_end [1 / energy].",
                                    .parameters = {{"beta_start", "--beta-start", "first inverse temperature", 0.1},
                                                   {"beta_end", "--beta", "rows follow exp(-beta E)", 1.0}},
                                    .sample = anneal};

}  // namespace gonogo::learning
