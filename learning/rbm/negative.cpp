#include "learning/rbm/negative.h"

#include "base/error.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kChains = 2;        // stream of random numbers
constexpr double kRareExchange = 0.5;       // trajectory: below this acceptance a new rung is kept
constexpr double kAcceptanceMemory = 0.95;  // of the running mean

torch::Tensor bits_tensor(const LadderChains& ladder, std::size_t visible) {
  torch::Tensor result = torch::empty({std::int64_t(ladder.chains()), std::int64_t(visible)}, torch::kFloat64);
  double* out = result.data_ptr<double>();
  for (std::size_t chain = 0; chain < ladder.chains(); ++chain)
    for (Bit bit : ladder.top(chain)) *out++ = bit;
  return result;
}

/// Rows to start chains from: the data, and hidden units that the first half sweep draws anew.
SampleSet start_rows(const torch::Tensor& data, const Problem& problem) {
  const torch::Tensor flat = data.cpu().contiguous();
  const double* in = flat.data_ptr<double>();
  const std::size_t rows = std::size_t(data.size(0)), visible = std::size_t(data.size(1));
  SampleSet start;
  start.labels = problem.labels;
  start.values.assign(rows * problem.variable_count(), 0);
  start.energies.assign(rows, 0.0);
  start.occurrences.assign(rows, 1);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t i = 0; i < visible; ++i) start.values[r * problem.variable_count() + i] = *in++ > 0.5;
  return start;
}

}  // namespace

torch::Tensor rows_tensor(const SampleSet& samples, std::size_t visible) {
  const std::size_t rows = samples.row_count();
  torch::Tensor result = torch::empty({std::int64_t(rows), std::int64_t(visible)}, torch::kFloat64);
  double* out = result.data_ptr<double>();
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t i = 0; i < visible; ++i) *out++ = samples.row(r)[i];
  return result;
}

NegativePhase::NegativePhase(const VisibleLayout& layout, const TrainingSettings& settings, const Sampler& sampler,
                             std::vector<double> base)
    : layout_(layout), labels_(layout.unit_labels()), settings_(settings), sampler_(sampler), base_(std::move(base)) {
  if (settings.negative == NegativePhaseKind::persistent) return;
  if (sampler.name() != "block_gibbs")
    throw InputError("training: a negative phase that is not persistent needs the sampler block_gibbs, not " +
                     sampler.name());
  if (settings.negative == NegativePhaseKind::contrastive) return;
  if (settings.negative == NegativePhaseKind::code_words) {
    words_.emplace(word_chains(settings));
    return;
  }
  if (settings.rungs < 2 || settings.rungs > LadderChains::kMaxRungs)
    throw InputError("training: rungs must lie between 2 and 64");
  ladder_.emplace(settings.chains, layout.unit_count(), settings.hidden, random_bits(settings.seed, kChains, 0));
}

torch::Tensor NegativePhase::draw(const RbmWeights& weights, const torch::Tensor& data) {
  if (words_) return from_words(weights);
  return ladder_ ? from_ladder(weights) : from_sampler(weights, data);
}

torch::Tensor NegativePhase::from_words(const RbmWeights& weights) {
  const WordMachine machine(layout_, weights);
  words_->run(machine, settings_.sweeps);
  torch::Tensor result =
      torch::empty({std::int64_t(words_->chains()), std::int64_t(weights.visible_count)}, torch::kFloat64);
  double* out = result.data_ptr<double>();
  std::vector<Bit> units(weights.visible_count, 0);
  for (std::size_t chain = 0; chain < words_->chains(); ++chain) {
    machine.write_units(words_->row(chain), units);
    for (Bit bit : units) *out++ = bit;
  }
  return result;
}

torch::Tensor NegativePhase::from_sampler(const RbmWeights& weights, const torch::Tensor& data) {
  const Problem problem = to_qubo(weights, labels_);
  SampleRequest request{
      .reads = settings_.chains, .seed = random_bits(settings_.seed, kChains, update_++), .sweeps = settings_.sweeps};
  if (settings_.negative == NegativePhaseKind::contrastive) {
    rows_ = start_rows(data, problem);
    request.reads = rows_.row_count();
  }
  if (rows_.row_count() > 0) request.start = &rows_;
  rows_ = sampler_.sample(problem, request);
  return rows_tensor(rows_, weights.visible_count);
}

torch::Tensor NegativePhase::from_ladder(const RbmWeights& weights) {
  std::vector<RbmWeights> ladder;
  if (settings_.negative == NegativePhaseKind::tempering) {
    for (std::size_t r = 0; r < settings_.rungs; ++r)
      ladder.push_back(interpolated(weights, base_, double(r) / double(settings_.rungs - 1)));
  } else {
    if (kept_.empty()) kept_.push_back(interpolated(weights, base_, 0));
    ladder = kept_;
    ladder.push_back(weights);
  }
  ladder_->run(ladder, settings_.sweeps);
  acceptance_ = kAcceptanceMemory * acceptance_ + (1 - kAcceptanceMemory) * ladder_->acceptance().back();
  return bits_tensor(*ladder_, weights.visible_count);
}

void NegativePhase::end_epoch(const RbmWeights& weights) {
  if (settings_.negative != NegativePhaseKind::trajectory || acceptance_ > kRareExchange) return;
  if (kept_.size() + 1 >= settings_.rungs) return;
  kept_.push_back(weights);
  acceptance_ = 1;
}

}  // namespace gonogo::learning
