// What every training run of a machine shares: where it begins, its minibatches and epochs, and when it reports.
#pragma once
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/model/posterior.h"
#include "learning/model/weights.h"
#include "learning/training.h"

namespace gonogo::learning {

struct TrainingResult {
  RbmWeights weights;
  std::vector<EpochLog> log;
};

/// Called at every report epoch with the present machine. Returns false to stop.
using EpochHook = std::function<bool(std::size_t epoch, const RbmWeights& weights)>;

/// Number or total weight of rows with each unit on, and with its variable known: [unit]. Units of the outcome come
/// last.
struct UnitCounts {
  std::vector<double> on, known;
};
UnitCounts count_units(const VisibleLayout& layout, const TrainingTable& table, bool weighed = false);

/// Small random weights. Visible biases give every variable and the outcome nearly the marginal that the rows have,
/// half a row added to each unit, word or outcome, so that what never happened starts rare but possible. A machine of
/// code words has the marginals of the words; any other, those of single units.
RbmWeights initial_weights(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings);

/// Throws InputError for a table that is empty or does not match the layout.
void check_table(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings);

/// The learning rate falls in equal steps from epoch to epoch to its final share.
double learning_rate(const TrainingSettings& settings, std::size_t epoch);

/// Rows of the minibatches of an epoch.
std::vector<std::vector<std::size_t>> minibatches(std::size_t count, const TrainingSettings& settings,
                                                  std::size_t epoch);

/// Weighted mean over rows of -log P(y_n | x_n).
double conditional_loss(const Posterior& posterior, const TrainingTable& table);

/// Calls run.epoch() for every epoch, and the hook after those that report.
template <class Run>
TrainingResult run_epochs(Run& run, const VisibleLayout& layout, const TrainingTable& table,
                          const TrainingSettings& settings, const EpochHook& hook) {
  TrainingResult result;
  for (std::size_t epoch = 1; epoch <= settings.epochs; ++epoch) {
    stop_if_cancelled();
    run.epoch(epoch);
    if (epoch % settings.report_every != 0 && epoch != settings.epochs) continue;
    const RbmWeights now = run.weights();
    const double loss = layout.outcome_count() > 0 ? conditional_loss(Posterior(layout, now), table) : NAN;
    result.log.push_back({double(epoch), loss, NAN});
    if (hook && !hook(epoch, now)) break;
  }
  result.weights = run.weights();
  return result;
}

}  // namespace gonogo::learning
