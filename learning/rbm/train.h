// Training of restricted Boltzmann machines on LibTorch: hybrid of discriminative and generative likelihood
// (Larochelle & Bengio 2008, section 4), per row n of the table with weight w_n (mean 1):
//
//   L = - mean w_n log P(y_n | x_n) - g mean w_n log P(v_n, y_n) + s / (2 N) (|D W|^2 + |b|^2)
//
// D W is what a step from a bin to the next adds to the fields of the hidden units: W itself for a thermometer code. So
// codes with fewer units have the same prior as a function of the value.
//
// The first term is exact by free energy over the outcomes. The gradient of the second needs rows of the machine, from
// a Sampler whose chains persist between updates (Tieleman 2008). x_n is the smooth code, v_n the code word. Unknown
// variables of a row are summed over their code words.
//
// In centred units the parameters are W, A, B of E = -A.(v - mu) - B.(h - lambda) - (v - mu)' W (h - lambda). mu is the
// mean of the rows and lambda a running mean of the hidden units given rows. Training a row is then the same as
// training its complement.
//
// The bits depend on the seed, not on threads. This header has no type of LibTorch.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/model/posterior.h"
#include "learning/model/weights.h"
#include "learning/sampler/sampler.h"
#include "learning/training.h"

namespace gonogo::learning {

/// Soft labels that a machine is trained on beside its trials. A teacher, which does better with few trials, says P(1 |
/// x) at points without a trial (Hinton, Vinyals, Dean, "Distilling the knowledge in a neural network", 2015). The
/// objective gains, with class c of {0, 1} of every outcome,
///
///   - t mean_k sum_c q_k(c) log P(c | x_k),   P(c | x) = sum of P(y | x) over the outcomes y of class c
///
/// so that only the class is taught. Which outcome of a class it is stays with the trials.
///
/// A few trials say little of the joint distribution. So with a joint share r the rows of the second term's data are
/// 1 - r of the trials and r of the points inside the box of the trials, there the mean of sum_c q_k(c) log P(x_k, c).
struct Teaching {
  double weight = 0;                // t; 0: no teaching
  std::vector<double> points;       // [point x variable count], all known
  std::vector<double> probability;  // [point]: P(1 | x) by the teacher, in [0, 1]
  std::vector<int> label;           // [outcome]: its class, 0 or 1
  /// r in [0, 1]; above 0 only where points are drawn from the distribution of the trials
  double joint_share = 0;
  std::size_t joint_every = 1;  // points 0, joint_every, 2 joint_every ... are, and they alone share
};

struct TrainingResult {
  RbmWeights weights;
  std::vector<EpochLog> log;
};

/// Whether LibTorch can compute gradients on a GPU here.
bool gradients_on_gpu();

/// Whether no machine of a training needs the sampler. Each then takes one thread, and several may be trained at a
/// time.
bool trains_by_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                     const Sampler& sampler);

/// Called at every report epoch with the present machine. Returns false to stop.
using EpochHook = std::function<bool(std::size_t epoch, const RbmWeights& weights)>;

/// Trains on all rows, from small random weights or from `start`. A layout without outcomes gives a density of the
/// variables (with discriminative 0, and outcomes 0 in the table). With a teacher every update also takes as many of
/// its points as the minibatch has rows. Throws InputError for a table that is empty or does
/// not match the layout.
TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook = {}, const RbmWeights* start = nullptr,
                         const Teaching* teaching = nullptr);

/// The same machine with other biases of the inputs, by which the words of every variable are as frequent among its own
/// rows as in the table, or in the box of the trials as far as `teaching` shares in the joint distribution. These
/// biases have no part in P(y | x), and training leaves them behind the weights. Robbins-Monro steps on rows of
/// tempered chains; deterministic.
RbmWeights balanced_inputs(const VisibleLayout& layout, const TrainingTable& table, RbmWeights weights,
                           std::uint64_t seed, const Teaching* teaching = nullptr);

/// L at fixed negative-phase rows, and its gradient by automatic differentiation, for tests with finite differences.
struct Objective {
  double value = 0;
  RbmWeights gradient;
};
Objective training_objective(const RbmWeights& weights, const VisibleLayout& layout, const TrainingTable& table,
                             const TrainingSettings& settings, const SampleSet& negative,
                             const Teaching* teaching = nullptr);

/// Weighted mean over rows of -log P(y_n | x_n).
double conditional_loss(const Posterior& posterior, const TrainingTable& table);

/// What the training of one fold gave.
struct FoldResult {
  std::vector<EpochLog> log;        // one entry per report epoch; held_out_loss NaN
  std::vector<double> probability;  // [report epoch x held-out row x outcome]
};
/// Finished folds of an earlier run. `find` returns none for a fold that is to be trained. `keep` gets every fold that
/// was trained. Both may be empty.
struct FoldStore {
  std::function<std::optional<FoldResult>(std::size_t fold)> find;
  std::function<void(std::size_t fold, const FoldResult& result)> keep;
};

/// The teaching of the machine that does not see a fold; it may be empty or give none.
using FoldTeaching = std::function<std::shared_ptr<const Teaching>(std::size_t fold)>;

/// What a cross-validation calls, one function at a time except `beside`. Each may be empty.
struct FoldCalls {
  std::function<void(std::size_t folds_done)> progress{};
  EpochHook watch{};  // with every fold's machine at its report epochs
  FoldStore store{};
  FoldTeaching teaching{};
  std::function<void()> beside{};  // run once, as if it trained one more fold
};

/// k-fold cross-validation with early stopping.
struct CrossValidation {
  std::size_t best_epoch = 0;       // epoch of the smallest held-out loss over all folds
  std::vector<EpochLog> log;        // one entry per report epoch, mean over folds
  std::vector<double> probability;  // [row x outcome]: by the machine without the row's fold, at best_epoch
};
CrossValidation cross_validate(const VisibleLayout& layout, const TrainingTable& table,
                               const TrainingSettings& settings, const Sampler& sampler, std::size_t fold_count,
                               const FoldCalls& calls = {});

}  // namespace gonogo::learning
