// Block Gibbs sampling of bipartite problems: one sweep draws the right side given the left, then the left given the
// right. Random numbers depend on (seed, chain, sweep, unit) alone, so bits depend neither on threads nor on the other
// chains. On a GPU rows differ, and large machines are refused: chains/gpu_chains.h.
#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "learning/encoding/encoder.h"
#include "learning/sampler/chains/bipartite.h"
#include "learning/sampler/chains/chain_random.h"
#include "learning/sampler/chains/gpu_chains.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

/// Rows of bits, the left side of each first; see Bipartite.
struct BlockRows {
  const Bipartite& sides;
  std::vector<Bit> bit;

  std::size_t units() const { return sides.left.size() + sides.right.size(); }
  std::span<Bit> left(std::size_t chain) { return std::span(bit).subspan(chain * units(), sides.left.size()); }
  std::span<Bit> right(std::size_t chain) {
    return std::span(bit).subspan(chain * units() + sides.left.size(), sides.right.size());
  }

  void take(std::size_t chain, std::span<const std::int8_t> row) {
    for (std::size_t i = 0; i < sides.left.size(); ++i) left(chain)[i] = row[sides.left[i]] > 0;
    for (std::size_t j = 0; j < sides.right.size(); ++j) right(chain)[j] = row[sides.right[j]] > 0;
  }
  void give(std::size_t chain, std::span<std::int8_t> row, bool spin) {
    const auto value = [&](Bit on) { return std::int8_t(on ? 1 : spin ? -1 : 0); };
    for (std::size_t i = 0; i < sides.left.size(); ++i) row[sides.left[i]] = value(left(chain)[i]);
    for (std::size_t j = 0; j < sides.right.size(); ++j) row[sides.right[j]] = value(right(chain)[j]);
  }
};

void run_chain(const SampleRequest& request, std::size_t chain, BlockRows& rows) {
  const Bipartite& sides = rows.sides;
  const std::span<Bit> left = rows.left(chain), right = rows.right(chain);
  std::vector<double> left_field(left.size()), right_field(right.size());
  ChainRandom random(request.seed, chain, left.size() + right.size());
  if (!request.start) {
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
}

void run_on_cpu(const SampleRequest& request, BlockRows& rows) {
  for_each_on_host(request.reads, 1, [&](std::size_t chain) { run_chain(request, chain, rows); });
}

/// Between two looks at whether the user wants to stop.
constexpr std::uint64_t kSweepsAtOnce = 10'000;

void run_on_gpu(const SampleRequest& request, BlockRows& rows) {
  GpuChains chains(rows.sides, request.reads, request.seed);
  request.start ? chains.set_rows(rows.bit) : chains.scatter();
  for (std::uint64_t done = 0; done < request.sweeps;) {
    const std::uint64_t count = std::min<std::uint64_t>(kSweepsAtOnce, request.sweeps - done);
    chains.sweep(request.first_sweep + done, count);
    done += count;
    stop_if_cancelled();
  }
  rows.bit = chains.rows();
}

/// Chains start from fair bits unless the request has rows. Throws InputError for a problem that is not bipartite.
SampleSet sample_blocks(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const Problem qubo = to_qubo(problem);
  const auto sides = split_in_two(qubo);
  if (!sides)
    throw InputError(
        "sampler block_gibbs: the problem is not bipartite (three or another odd number of variables are "
        "coupled in a ring); use anneal, tempering or population, or exact when it is small");
  const std::size_t n = problem.variable_count();
  SampleSet result = empty_rows(problem, request.reads);
  BlockRows rows{*sides, std::vector<Bit>(request.reads * n)};
  if (request.start) {
    if (request.start->row_count() != request.reads || request.start->labels != problem.labels)
      throw InputError("sampler block_gibbs: the rows to start from do not fit the problem and the number of reads");
    for (std::size_t chain = 0; chain < request.reads; ++chain) rows.take(chain, request.start->row(chain));
  }
  setting<bool>(settings, "on_gpu") ? run_on_gpu(request, rows) : run_on_cpu(request, rows);
  for_each_on_host(request.reads, 64, [&](std::size_t chain) {
    const auto row = std::span(result.values).subspan(chain * n, n);
    rows.give(chain, row, problem.vartype == Vartype::spin);
    result.energies[chain] = energy(problem, row);
  });
  return result;
}

}  // namespace

extern const SamplerKind kBlockGibbs = {
    .name = "block_gibbs",
    .title = "BlockGibbs",
    .about = "Block Gibbs sampling of bipartite problems, such as those of models without clamped hidden units.",
    .parameters = {{"on_gpu", "--gpu", "on a GPU, with weights of 16 bits", false}},
    .any_problem = false,
    .sample = sample_blocks};

}  // namespace gonogo::learning
