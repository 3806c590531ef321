#include "pipeline/lab/bench/sampler_bench.h"

#include <omp.h>

#include <numeric>

#include "base/math/random.h"
#include "learning/model/weights.h"
#include "learning/sampler/chains/gpu_chains.h"
#include "learning/sampler/sampler.h"
#include "pipeline/lab/scenes/scene.h"

namespace gonogo::lab {
namespace {

learning::Problem random_machine(std::size_t visible, std::size_t hidden) {
  learning::RbmWeights machine = learning::RbmWeights::zeros(visible, hidden);
  for (std::size_t k = 0; k < machine.weight.size(); ++k) machine.weight[k] = 0.1 * random_normal(1, 0, k);
  for (std::size_t k = 0; k < visible; ++k) machine.visible_bias[k] = 0.5 * random_normal(1, 1, k);
  for (std::size_t k = 0; k < hidden; ++k) machine.hidden_bias[k] = 0.5 * random_normal(1, 2, k);
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < visible; ++k) labels.push_back("v" + std::to_string(k));
  return learning::to_qubo(machine, labels);
}

double share_on(const std::vector<learning::GpuChains::Bit>& bits, std::size_t left, std::size_t units) {
  double sum = 0;
  for (std::size_t i = 0; i < bits.size(); ++i)
    if (i % units < left) sum += bits[i];
  return sum * double(units) / (double(bits.size()) * double(left));
}

void time_gpu(const learning::Problem& problem, const GibbsBench& request, GibbsBenchResult& result) {
  const learning::Bipartite sides = learning::split_in_two(problem).value();
  learning::GpuChains chains(sides, request.chains, 1);
  chains.scatter();
  chains.sweep(0, request.sweeps);
  std::vector<double> times;
  for (int k = 0; k < request.repeats; ++k) {
    const double start = seconds();
    chains.sweep(std::uint64_t(k + 1) * request.sweeps, request.sweeps);
    times.push_back(seconds() - start);
  }
  result.seconds = median(times);
  result.mean_visible = share_on(chains.rows(), sides.left.size(), sides.left.size() + sides.right.size());
}

void time_cpu(const learning::Problem& problem, const GibbsBench& request, GibbsBenchResult& result) {
  omp_set_num_threads(request.threads);
  std::vector<double> times;
  for (int k = 0; k < request.repeats; ++k) {
    const double start = seconds();
    const auto rows = learning::make_sampler("block_gibbs")
                          ->sample(problem, {.reads = request.chains, .seed = 1, .sweeps = request.sweeps});
    times.push_back(seconds() - start);
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r)
      sum += std::accumulate(rows.row(r).begin(), rows.row(r).begin() + std::ptrdiff_t(request.visible), 0.0);
    result.mean_visible = sum / double(request.chains * request.visible);
  }
  result.seconds = median(times);
}

}  // namespace

GibbsBenchResult bench_gibbs(const GibbsBench& request) {
  const learning::Problem problem = random_machine(request.visible, request.hidden);
  GibbsBenchResult result;
  request.on_gpu ? time_gpu(problem, request, result) : time_cpu(problem, request, result);
  const double updates = double(request.visible + request.hidden) * double(request.chains) * double(request.sweeps);
  result.updates_per_ns = updates / result.seconds * 1e-9;
  return result;
}

}  // namespace gonogo::lab
