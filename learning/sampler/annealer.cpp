#include <algorithm>

#include "base/cancel.h"
#include "base/error.h"
#include "learning/sampler/annealing.h"
#include "learning/sampler/spin_lanes.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kRefresh = 64;  // sweeps after which the fields are summed anew

/// Rows of chains first ... first + 7, as far as the request goes.
template <class Real>
void anneal_lanes(const SamplerSettings& settings, const SpinGraph& graph, const Problem& problem,
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
    spins.sweep(settings.beta_start + way * (settings.beta_end - settings.beta_start),
                sweep >= rise ? TurnRule::heat_bath : TurnRule::metropolis, random);
  }
  std::vector<std::int8_t> row(graph.size());
  for (std::size_t chain = first; chain < std::min(first + kLanes, request.reads); ++chain) {
    spins.read(int(chain - first), row);
    set_row(rows, chain, problem, row);
  }
}

}  // namespace

SampleSet Annealer::sample(const Problem& problem, const SampleRequest& request) const {
  const SpinGraph graph(to_ising(problem));
  const bool single = single_precision_holds(graph, std::max(settings_.beta_start, settings_.beta_end));
  SampleSet rows = empty_rows(problem, request.reads);
#pragma omp parallel for schedule(dynamic)
  for (std::size_t first = 0; first < request.reads; first += kLanes) {
    if (cancel_requested()) continue;
    if (single)
      anneal_lanes<float>(settings_, graph, problem, request, first, rows);
    else
      anneal_lanes<double>(settings_, graph, problem, request, first, rows);
  }
  stop_if_cancelled();
  return rows;
}

}  // namespace gonogo::learning
