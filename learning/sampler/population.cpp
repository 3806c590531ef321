// Population annealing from beta 0 to beta_end in equal steps. At each step the population is resampled with weights
// exp(-dbeta E) and swept (Hukushima, Iba, AIP Conf. Proc. 690, 200 (2003); Machta, arXiv:1006.3268). The population
// has at least 1,000 members. info.log_z estimates log Z.
#include <algorithm>
#include <cmath>

#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kMinMembers = 1000;          // members: fewer would bias the weights
constexpr std::uint64_t kResampling = UINT64_MAX;  // stream of the resampling draws

/// Systematic resampling with weights exp(-step E). Returns the log of the mean weight.
double resample(std::vector<Spins>& population, double step, double draw) {
  std::vector<double> log_weight;
  for (const Spins& member : population) log_weight.push_back(-step * member.energy());
  const double highest = *std::max_element(log_weight.begin(), log_weight.end());
  double sum = 0;
  for (double w : log_weight) sum += std::exp(w - highest);
  std::vector<Spins> next;
  next.reserve(population.size());
  double passed = 0;
  for (std::size_t k = 0; k < population.size(); ++k) {
    passed += std::exp(log_weight[k] - highest) / sum * double(population.size());
    while (next.size() < population.size() && double(next.size()) + draw < passed) next.push_back(population[k]);
  }
  while (next.size() < population.size()) next.push_back(population.back());  // rounding of the last sum
  population = std::move(next);
  return highest + std::log(sum / double(population.size()));
}

SampleSet anneal_population(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const auto beta_end = setting<double>(settings, "beta_end");
  const auto steps = std::size_t(setting<std::int64_t>(settings, "temperatures"));
  const Problem ising = to_ising(problem);
  const SpinGraph graph(ising);
  const std::size_t members = std::max(request.reads, kMinMembers);
  const std::size_t sweeps = std::max<std::size_t>(1, request.sweeps / steps);
  std::vector<Spins> population(members, Spins(graph));
  double log_z = double(graph.size()) * std::log(2.0) - beta_end * ising.offset;
  for (std::size_t step = 0; step <= steps; ++step) {
    const double beta = beta_end * double(step) / double(steps);
    if (step > 0) log_z += resample(population, beta_end / double(steps), random_unit(request.seed, kResampling, step));
    for_each_on_host(members, 4, [&](std::size_t k) {
      ChainRandom random(request.seed, k, graph.size());
      random.begin(0);
      if (step == 0) population[k].randomise(random);
      for (std::size_t sweep = 0; step > 0 && sweep < sweeps; ++sweep) {
        random.begin(1 + (step - 1) * sweeps + sweep);
        population[k].sweep(beta, random);
      }
    });
  }
  SampleSet rows = empty_rows(problem, request.reads);
  for (std::size_t r = 0; r < request.reads; ++r)
    set_row(rows, r, problem, population[r * members / request.reads].values());
  rows.info["log_z"] = log_z;
  return rows;
}

}  // namespace

extern const SamplerKind kPopulation = {
    .name = "population",
    .title = "Population",
    .about = "Population annealing over `temperatures` steps up to beta_end [1 / energy].",
    .parameters = {{"beta_end", "--beta", "rows follow exp(-beta E)", 1.0},
                   {"temperatures", "--temperatures", "steps", std::int64_t(30), 1}},
    .sample = anneal_population};

}  // namespace gonogo::learning
