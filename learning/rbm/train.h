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
#include "learning/rbm/words/word_training.h"
#include "learning/sampler/sampler.h"
#include "learning/training.h"

namespace gonogo::learning {

/// Whether LibTorch can compute gradients on a GPU here.
bool gradients_on_gpu();

/// Whether no machine of a training needs the sampler. Each then takes one thread, and several may be trained at a
/// time.
bool trains_by_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                     const Sampler& sampler);

/// Trains on all rows, from small random weights or from `start`. A layout without outcomes gives a density of the
/// variables (with discriminative 0, and outcomes 0 in the table). With a teacher every update also takes as many of
/// its points as the minibatch has rows. Throws InputError for a table that is empty or does
/// not match the layout.
TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook = {}, const RbmWeights* start = nullptr,
                         const Teaching* teaching = nullptr);

/// L at fixed negative-phase rows, and its gradient by automatic differentiation, for tests with finite differences.
struct Objective {
  double value = 0;
  RbmWeights gradient;
};
Objective training_objective(const RbmWeights& weights, const VisibleLayout& layout, const TrainingTable& table,
                             const TrainingSettings& settings, const SampleSet& negative,
                             const Teaching* teaching = nullptr);

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
