// Parallel tempering over inverse temperatures from beta_start to beta_end in a geometric series. Neighbours exchange
// states after every sweep (Hukushima, Nemoto, J. Phys. Soc. Jpn. 65, 1604 (1996)). Every temperature has two replicas,
// so that a run gives two reads. On sparse graphs the two also exchange a cluster of spins in which they differ, which
// keeps the sum of their energies (Zhu, Ochoa, Katzgraber, arXiv:1501.05630). On dense graphs a cluster is the whole
// graph, and there is no such move.
#include <cmath>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

constexpr double kDenseDegree = 10;  // mean neighbours from which on clusters percolate

/// One run: two sets of replicas at the same temperatures. state[set][temperature].
class TemperingRun {
 public:
  TemperingRun(const SpinGraph& graph, const std::vector<double>& beta, bool clusters, std::uint64_t seed,
               std::uint64_t run)
      : graph_(graph),
        beta_(beta),
        clusters_(clusters),
        random_(seed, run, std::max(graph.size(), 4 * beta.size() + 8)) {
    for (std::size_t set = 0; set < 2; ++set) {
      state_[set].assign(beta.size(), Spins(graph));
      for (std::size_t t = 0; t < beta.size(); ++t) {
        random_.begin(set * beta.size() + t);
        state_[set][t].randomise(random_);
      }
    }
  }

  void sweep(std::uint64_t number) {
    const std::uint64_t row = (number + 1) * (2 * beta_.size() + 1);
    for (std::size_t set = 0; set < 2; ++set)
      for (std::size_t t = 0; t < beta_.size(); ++t) {
        random_.begin(row + set * beta_.size() + t);
        state_[set][t].sweep(beta_[t], random_);
      }
    random_.begin(row + 2 * beta_.size());
    for (std::size_t t = 0; clusters_ && t < beta_.size(); ++t) move_cluster(t, random_(t));
    for (std::size_t set = 0; set < 2; ++set) exchange(set, number);
  }
  std::span<const std::int8_t> cold(std::size_t set) const { return state_[set].back().values(); }

 private:
  /// Neighbouring temperatures change places with probability min(1, exp(dbeta dE)); odd and even pairs take turns.
  void exchange(std::size_t set, std::uint64_t number) {
    auto& states = state_[set];
    for (std::size_t t = number % 2; t + 1 < beta_.size(); t += 2) {
      const double gain = (beta_[t + 1] - beta_[t]) * (states[t + 1].energy() - states[t].energy());
      if (random_((1 + set) * beta_.size() + t) < std::exp(std::min(gain, 0.0))) std::swap(states[t], states[t + 1]);
    }
  }

  /// The spins connected to a random one of those in which the two replicas differ change places.
  void move_cluster(std::size_t t, double draw) {
    Spins &x = state_[0][t], &y = state_[1][t];
    std::vector<std::uint32_t> differ;
    for (std::uint32_t i = 0; i < graph_.size(); ++i)
      if (x.values()[i] != y.values()[i]) differ.push_back(i);
    if (differ.empty()) return;
    std::vector<std::uint32_t> cluster = {differ[std::size_t(draw * double(differ.size()))]};
    std::vector<char> seen(graph_.size(), 0);
    seen[cluster[0]] = 1;
    for (std::size_t k = 0; k < cluster.size(); ++k)
      for (std::uint32_t e = graph_.first[cluster[k]]; e < graph_.first[cluster[k] + 1]; ++e) {
        const std::uint32_t next = graph_.neighbour[e];
        if (seen[next] || x.values()[next] == y.values()[next]) continue;
        seen[next] = 1;
        cluster.push_back(next);
      }
    for (std::uint32_t i : cluster) {
      x.flip(i);
      y.flip(i);
    }
  }

  const SpinGraph& graph_;
  const std::vector<double>& beta_;
  bool clusters_;
  ChainRandom random_;
  std::vector<Spins> state_[2];
};

SampleSet temper(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const auto beta_start = setting<double>(settings, "beta_start"), beta_end = setting<double>(settings, "beta_end");
  const auto count = std::size_t(setting<std::int64_t>(settings, "replicas"));
  const SpinGraph graph(to_ising(problem));
  if (!(beta_start > 0) || !(beta_end > beta_start))
    throw InputError("sampler tempering: needs 0 < beta_start < beta_end");
  std::vector<double> beta;
  for (std::size_t t = 0; t < count; ++t)
    beta.push_back(beta_end * std::pow(beta_start / beta_end, double(count - 1 - t) / double(count - 1)));
  const bool sparse = double(graph.neighbour.size()) < kDenseDegree * double(graph.size());
  SampleSet rows = empty_rows(problem, request.reads);
  for_each_on_host((request.reads + 1) / 2, 1, [&](std::size_t number) {
    TemperingRun run(graph, beta, sparse, request.seed, number);
    for (std::size_t sweep = 0; sweep < request.sweeps; ++sweep) run.sweep(sweep);
    for (std::size_t set = 0; set < 2 && 2 * number + set < request.reads; ++set)
      set_row(rows, 2 * number + set, problem, run.cold(set));
  });
  return rows;
}

}  // namespace

extern const SamplerKind kTempering = {
    .name = "tempering",
    .title = "Tempering",
    .about = "Parallel tempering over `replicas` temperatures between beta_start and beta_end [1 / energy].",
    .parameters = {{"beta_start", "--beta-start", "first inverse temperature", 0.1},
                   {"beta_end", "--beta", "rows follow exp(-beta E)", 1.0},
                   {"replicas", "--replicas", "temperatures", std::int64_t(10), 2}},
    .sample = temper};

}  // namespace gonogo::learning
