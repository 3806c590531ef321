#include "learning/sampler/block_gibbs.h"

#include "base/cancel.h"
#include "base/error.h"
#include "learning/encoding/encoder.h"
#include "learning/sampler/bipartite.h"
#include "learning/sampler/chain_random.h"

namespace gonogo::learning {
namespace {

void run_chain(const Bipartite& sides, const SampleRequest& request, std::size_t chain, std::span<std::int8_t> row) {
  std::vector<Bit> left(sides.left.size()), right(sides.right.size());
  std::vector<double> left_field(left.size()), right_field(right.size());
  ChainRandom random(request.seed, chain, left.size() + right.size());
  if (request.start) {
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = row[sides.left[i]] > 0;
    for (std::size_t j = 0; j < right.size(); ++j) right[j] = row[sides.right[j]] > 0;
  } else {
    random.begin(0);
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = random(right.size() + i) < 0.5;
    for (std::size_t j = 0; j < right.size(); ++j) right[j] = random(j) < 0.5;
  }
  for (std::uint64_t sweep = 0; sweep < request.sweeps; ++sweep) {
    random.begin(request.first_sweep + sweep + 1);
    side_field(left, sides.weight, sides.bias_right, right_field);
    draw_bits(right_field, random, 0, right);
    side_field(right, sides.weight_transpose, sides.bias_left, left_field);
    draw_bits(left_field, random, right.size(), left);
  }
  for (std::size_t i = 0; i < left.size(); ++i) row[sides.left[i]] = std::int8_t(left[i]);
  for (std::size_t j = 0; j < right.size(); ++j) row[sides.right[j]] = std::int8_t(right[j]);
}

}  // namespace

SampleSet BlockGibbs::sample(const Problem& problem, const SampleRequest& request) const {
  const Problem qubo = to_qubo(problem);
  const auto sides = split_in_two(qubo);
  if (!sides)
    throw InputError(
        "sampler block_gibbs: the problem is not bipartite (three or another odd number of variables are "
        "coupled in a ring); use the sampler exact when it is small");
  const std::size_t n = problem.variable_count();
  const bool spin = problem.vartype == Vartype::spin;
  SampleSet result;
  result.vartype = problem.vartype;
  result.labels = problem.labels;
  result.values.resize(request.reads * n);
  result.energies.resize(request.reads);
  result.occurrences.assign(request.reads, 1);
  if (request.start) {
    if (request.start->row_count() != request.reads || request.start->labels != problem.labels)
      throw InputError("sampler block_gibbs: the rows to start from do not fit the problem and the number of reads");
    result.values = request.start->values;
  }
#pragma omp parallel for schedule(static)
  for (std::size_t chain = 0; chain < request.reads; ++chain) {
    if (cancel_requested()) continue;
    const auto row = std::span(result.values).subspan(chain * n, n);
    run_chain(*sides, request, chain, row);
    if (spin)
      for (std::int8_t& value : row) value = value > 0 ? 1 : -1;
    result.energies[chain] = energy(problem, row);
  }
  stop_if_cancelled();
  return result;
}

}  // namespace gonogo::learning
