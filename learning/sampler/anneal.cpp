// Simulated annealing of eight chains at once. beta rises from beta_start to beta_end over the first three quarters of
// the sweeps, with Metropolis' rule. The last quarter is heat-bath sweeps at beta_end. Rows follow exp(-beta_end E) as
// far as that quarter equilibrates. Draws depend on (seed, chain, sweep) alone, so bits do not depend on threads.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kRefresh = 64;  // sweeps after which the fields are summed anew

/// beta from start to end over the rise of the sweeps.
struct Schedule {
  double start = 0, end = 0;
  bool geometric = true;
  double at(double way) const { return geometric ? start * std::pow(end / start, way) : start + way * (end - start); }
};

/// Betas by the energies of the problem, with f_i = |h_i| + sum_j |J_ij| and m_i the least coefficient of spin i that
/// is not 0, at least 1e-3 of the largest f. At the first every flip is accepted with probability 1/2 or more: ln 2 /
/// (2 max f). At the last one spin in a hundred rows is turned against the least of its couplings: ln(100 n) / (2 min
/// m). The form is that of the betas that dwave-samplers chooses.
Schedule fitted(const SpinGraph& graph) {
  constexpr double kLeastPart = 1e-3, kRows = 100;
  double largest = 0, least = INFINITY;
  for (std::size_t i = 0; i < graph.size(); ++i) {
    double field = std::abs(graph.h[i]);
    if (field > 0) least = std::min(least, field);
    for (std::size_t k = graph.first[i]; k < graph.first[i + 1]; ++k) {
      field += std::abs(graph.J[k]);
      if (graph.J[k] != 0) least = std::min(least, std::abs(graph.J[k]));
    }
    largest = std::max(largest, field);
  }
  if (largest == 0) return {1, 1};  // every row has the same energy
  return {std::numbers::ln2 / (2 * largest),
          std::log(kRows * double(graph.size())) / (2 * std::max(least, kLeastPart * largest))};
}

/// The given betas; those that are 0 are fitted, the first one no higher than the last.
Schedule schedule_of(const SpinGraph& graph, const SamplerSettings& settings) {
  const Schedule fit = fitted(graph);
  const std::string& name = setting<std::string>(settings, "schedule");
  if (name != "geometric" && name != "linear")
    throw InputError("sampler anneal: schedule \"" + name + "\" does not exist; use geometric or linear");
  Schedule result{setting<double>(settings, "beta_start"), setting<double>(settings, "beta_end"), name == "geometric"};
  if (result.end == 0) result.end = std::max(fit.end, result.start);
  if (result.start == 0) result.start = std::min(fit.start, result.end);
  return result;
}

/// Rows of chains first ... first + 7, as far as the request goes.
template <class Real>
void anneal_lanes(const Schedule& beta, const SpinGraph& graph, const Problem& problem, const SampleRequest& request,
                  std::size_t first, SampleSet& rows) {
  const std::size_t rise = request.sweeps * 3 / 4;
  LaneRandom random(request.seed, first, graph.size());
  SpinLanes<Real> spins(graph);
  random.begin(0);
  spins.randomise(random);
  for (std::size_t sweep = 0; sweep < request.sweeps; ++sweep) {
    const double way = sweep >= rise ? 1 : double(sweep) / double(rise);
    random.begin(sweep + 1);
    if (sweep % kRefresh == kRefresh - 1) spins.refresh();
    spins.sweep(beta.at(way), sweep >= rise ? TurnRule::heat_bath : TurnRule::metropolis, random);
  }
  std::vector<std::int8_t> row(graph.size());
  for (std::size_t chain = first; chain < std::min(first + kLanes, request.reads); ++chain) {
    spins.read(int(chain - first), row);
    set_row(rows, chain, problem, row);
  }
}

SampleSet anneal(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const SpinGraph graph(to_ising(problem));
  const Schedule beta = schedule_of(graph, settings);
  const bool single = single_precision_holds(graph, std::max(beta.start, beta.end));
  SampleSet rows = empty_rows(problem, request.reads);
  rows.info["beta_start"] = beta.start;
  rows.info["beta_end"] = beta.end;
  rows.info["schedule"] = beta.geometric ? "geometric" : "linear";
  for_each_on_host((request.reads + kLanes - 1) / kLanes, 1, [&](std::size_t group) {
    if (single)
      anneal_lanes<float>(beta, graph, problem, request, group * kLanes, rows);
    else
      anneal_lanes<double>(beta, graph, problem, request, group * kLanes, rows);
  });
  return rows;
}

}  // namespace

extern const SamplerKind kAnneal = {
    .name = "anneal",
    .title = "Annealer",
    .about = "Simulated annealing from beta_start to beta_end [1 / energy].",
    .parameters = {{"beta_start", "--beta-start", "first inverse temperature; 0: fitted to the energies", 0.0, 0.0},
                   {"beta_end", "--beta", "rows follow exp(-beta E); 0: fitted, 1 for a model's problem", 0.0, 0.0},
                   {"schedule", "--schedule", "geometric or linear in beta", std::string("geometric")}},
    .sample = anneal};

}  // namespace gonogo::learning
