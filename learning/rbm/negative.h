// Negative phase: rows of the machine for the second term of the objective (train.h). Only inside learning/rbm.
#pragma once
#include <optional>

#include "learning/machine/ladder.h"
#include "learning/machine/word_machine.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {

/// Visible rows as a tensor of 0 and 1: [row x visible].
torch::Tensor rows_tensor(const SampleSet& samples, std::size_t visible);

class NegativePhase {
 public:
  /// Throws InputError when the settings need own chains and the sampler is not block_gibbs. `layout`, `settings`
  /// and `sampler` must outlive the object. base: biases of the machine at the foot of a ladder of temperatures.
  NegativePhase(const VisibleLayout& layout, const TrainingSettings& settings, const Sampler& sampler,
                std::vector<double> base);
  /// Rows of the machine `weights`. data: the minibatch, [row x visible] of {0, 1}.
  torch::Tensor draw(const RbmWeights& weights, const torch::Tensor& data);
  /// trajectory: keeps the machine as a new rung when exchanges with the last kept one are rare.
  void end_epoch(const RbmWeights& weights);
  std::size_t rungs() const { return ladder_ ? ladder_->rungs() : 1; }

 private:
  torch::Tensor from_sampler(const RbmWeights& weights, const torch::Tensor& data);
  torch::Tensor from_ladder(const RbmWeights& weights);
  torch::Tensor from_words(const RbmWeights& weights);

  const VisibleLayout& layout_;
  std::vector<std::string> labels_;
  const TrainingSettings& settings_;
  const Sampler& sampler_;
  std::vector<double> base_;
  SampleSet rows_;
  std::optional<LadderChains> ladder_;
  std::optional<WordChains> words_;
  std::vector<RbmWeights> kept_;  // trajectory: earlier machines, oldest first
  double acceptance_ = 1;         // running mean, between the last kept machine and the present one
  std::uint64_t update_ = 0;
};

}  // namespace gonogo::learning
