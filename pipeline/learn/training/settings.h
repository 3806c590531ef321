// The "learning" section of a study:
//
//   sampler        "block_gibbs" (default), "anneal", "tempering", "population", "exact", "command" or "emulator" (a
//                  D-Wave 2X, see annealer_training.h): where the negative phase comes from
//   gpu            "auto" (default): block_gibbs samples on a GPU where one answers and an update is large enough to
//                  gain by it; "never"
//   gradients      "cpu" (default) or "cuda": where LibTorch computes; a machine of tens of units is quicker on one
//   core command        of the sampler "command": list of program and arguments with {problem} {answer} {reads} {seed}
//   stand_in       sampler that takes over when "command" fails (default "block_gibbs"); log, model and report say so
//   hidden         hidden units                                     epochs         most passes over the trials
//   batch          trials of a minibatch (default 32, or a 32nd of the trials where that is more)
//   learning_rate  of Adam
//   weight_decay   strength of the Gaussian prior on weights [nat]  generative     share of the joint likelihood
//   chains, sweeps persistent chains and their sweeps per update    folds          of the cross-validation
//   optimizer      "adam" (default) or "sgd"                        momentum       of sgd
//   final_learning_rate  share of the learning rate at the last epoch (default 1)
//   discriminative share of the conditional likelihood (default 1)
//   centred        gradients in centred units (default no)
//   negative       "persistent" (default), "contrastive", "tempering" or "trajectory": how the chains of the negative
//                  phase start; the last two have "rungs" machines on a ladder
//   importance     power in [0, 1] to which trials' weights prior / proposal density are raised (default 1)
//   calibrate      whether a power that the held-out folds choose sharpens or blunts all probabilities (default no)
//   unknown_inputs "prior" (default): answers sum unknown variables out over the design's distribution, uniform over
//                  the sampled box; "machine": over the machine's own joint distribution
//   bins           "range" (default) or "quantile"
//   encoders       { "<variable>": { "code": "thermometer" | "one_hot" | "gray", "bits": n } }; in place of "bits"
//                  "edges", the inner edges of the bins [unit of the variable], increasing; default: the contract's
//
// Defaults are those of learning::TrainingSettings; docs/learning.md shows the experiments behind them.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "learning/training_settings.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/learn/training/annealer_training.h"

namespace gonogo::learn {

struct LearningSettings {
  std::string sampler = "block_gibbs";
  bool gpu = true;          // where it gains
  EmulatorChoice emulator;  // of the sampler "emulator"
  std::size_t folds = 5;
  learning::TrainingSettings training;  // seed and minibatch are set when training: training_settings()
  bool batch_given = false;
  bool quantile_bins = false;
  bool calibrate = false;
  double importance = 1;                                  // see temper_weights() in training_data.h
  bool uniform_inputs = true;                             // of answers with unknown variables; false: the machine's own
  std::vector<std::string> command;                       // of the sampler "command"
  std::string stand_in = "block_gibbs";                   // for a sampler that cannot be reached
  std::map<std::string, campaign::EncoderSpec> encoders;  // by variable, where the study overrides the contract
  std::map<std::string, std::vector<double>> edges;       // of bins, for those of `encoders` that give them [unit]
};

/// Without a section: the defaults. Throws InputError for unknown keys, values out of range and unknown variables.
LearningSettings read_learning_settings(const std::optional<Config>& section);

/// Those of a training on so many trials: an epoch has 32 minibatches at most where the study names no size.
learning::TrainingSettings training_settings(const LearningSettings& settings, std::size_t trials, std::uint64_t seed);

Json to_json(const LearningSettings& settings);

}  // namespace gonogo::learn
