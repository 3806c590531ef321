// Training of restricted Boltzmann machines on LibTorch: hybrid of discriminative and generative likelihood
// (Larochelle & Bengio 2008, section 4), per row n of the table with weight w_n (mean 1):
//
//   L = - mean w_n log P(y_n | x_n) - g mean w_n log P(v_n, y_n) + s / (2 N) (|W|^2 + |b|^2)
//
// The first term is exact by free energy over the outcomes. The second's gradient needs rows drawn from the machine,
// which come from a Sampler whose chains persist from update to update (Tieleman 2008). x_n is the smooth code, v_n the
// code word. Unknown variables of a row are summed out over their code words. In centred units the gradient is that of
// W, A, B in E = -A.(v - mu) - B.(h - lambda) - (v - mu)' W (h - lambda), with mu the mean of the rows and lambda a
// sliding mean of the hidden units given rows, so that training a row or its complement is the same. Same seed, same
// bits for any number of threads. No type of LibTorch appears in this header.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/model/posterior.h"
#include "learning/model/weights.h"
#include "learning/sampler/sampler.h"
#include "learning/table.h"
#include "learning/training_settings.h"

namespace gonogo::learning {

struct TrainingResult {
  RbmWeights weights;
  std::vector<EpochLog> log;
};

/// Whether this LibTorch works out gradients on a GPU here.
bool gradients_on_gpu();

/// Called at every report epoch with the machine so far; return false to stop.
using EpochHook = std::function<bool(std::size_t epoch, const RbmWeights& weights)>;

/// Trains on all rows, from small random weights or from `start`. A layout without outcomes gives a density of the
/// variables (discriminative 0, outcomes 0 in the table). Throws InputError for an empty table or one that does not
/// fit.
TrainingResult train_rbm(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                         const Sampler& sampler, const EpochHook& hook = {}, const RbmWeights* start = nullptr);

/// L at fixed negative-phase rows and its gradient by automatic differentiation; for tests against finite differences.
struct Objective {
  double value = 0;
  RbmWeights gradient;
};
Objective training_objective(const RbmWeights& weights, const VisibleLayout& layout, const TrainingTable& table,
                             const TrainingSettings& settings, const SampleSet& negative);

/// Mean over rows of -log P(y_n | x_n), weighted.
double conditional_loss(const Posterior& posterior, const TrainingTable& table);

/// k-fold cross-validation with early stopping. `watch` sees every fold's machine at its report epochs.
struct CrossValidation {
  std::size_t best_epoch = 0;       // with the least held-out loss, the folds taken together
  std::vector<EpochLog> log;        // one entry per report epoch, mean over folds
  std::vector<double> probability;  // [row x outcome]: of each row by the machine that did not see it, at best_epoch
};
CrossValidation cross_validate(const VisibleLayout& layout, const TrainingTable& table,
                               const TrainingSettings& settings, const Sampler& sampler, std::size_t fold_count,
                               const std::function<void(std::size_t folds_done)>& progress = {},
                               const EpochHook& watch = {});

}  // namespace gonogo::learning
