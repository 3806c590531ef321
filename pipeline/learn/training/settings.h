// The "learning" section of a study:
//
//   sampler         source of the negative phase: "block_gibbs" (default), "anneal", "tempering", "population",
//   "exact",
//                   "command", or "emulator" (a D-Wave 2X, see annealer_training.h)
//   gpu             "auto" (default): block_gibbs samples on a GPU if there is one and an update is large enough to
//   gain
//                   by it; "never"
//   gradients       "cpu" (default) or "cuda": where LibTorch computes; one core is faster for tens of units
//   command         of the sampler "command": list of program and arguments with {problem} {answer} {reads} {seed}
//   stand_in        sampler that takes over if "command" fails (default "block_gibbs"); log, model and report say so
//   hidden          number of hidden units
//   epochs          max passes over the trials
//   batch           trials of a minibatch (default 32, or a 32nd of the trials if that is more)
//   learning_rate   of the optimizer
//   weight_decay    strength of the Gaussian prior on weights [nat]
//   generative      share of the joint likelihood
//   discriminative  share of the conditional likelihood (default 1)
//   chains          number of persistent chains
//   sweeps          of every chain per update
//   folds           of the cross-validation
//   optimizer       "adam" (default) or "sgd"
//   momentum        of sgd
//   final_learning_rate  share of the learning rate at the last epoch (default 1)
//   centred         gradients in centred units (default no)
//   negative        how the chains of the negative phase start: "persistent" (default), "contrastive", "tempering" or
//                   "trajectory"; these two have "rungs" machines on a ladder. "code_words" (default from 500 trials)
//                   draws whole code words, and the machine is one of code words only
//   importance      power in [0, 1] of the trials' weights prior / proposal density (default 1)
//   calibrate       whether to sharpen or blunt all probabilities by a power that the held-out folds choose (default
//   no) unknown_inputs  "prior" (default): answers sum unknown variables out over the design's distribution, uniform
//   over
//                   the sampled box; "machine": over the machine's joint distribution
//   teacher         weight of the soft labels of a Gaussian process (default by the number of trials, see teacher.h;
//                   0: none)
//   bins            "range" (default) or "quantile"
//   with            datasets of other fidelities that `gonogo run` trains on too, shipped name or file (named_trials.h)
//   encoders        { "<variable>": { "code": "thermometer" | "one_hot" | "gray", "bits": n } }; default: the
//   contract's.
//                   "edges" in place of "bits" gives the inner edges of the bins [unit of the variable], increasing
//
// Other defaults are those of learning::TrainingSettings, and from 500 trials those of settings_for_trials().
// docs/learning.md shows the experiments behind them.
#pragma once
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "learning/training_settings.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/learn/training/annealer_training.h"

namespace gonogo::learn {

struct LearningSettings {
  std::string sampler = "block_gibbs";
  bool gpu = true;          // "auto"
  EmulatorChoice emulator;  // for the sampler "emulator"
  std::size_t folds = 5;
  learning::TrainingSettings training;  // training_settings() sets seed and minibatch
  std::set<std::string> given;          // keys of the section
  bool quantile_bins = false;
  bool calibrate = false;
  double importance = 1;                                  // see temper_weights() in training_data.h
  std::optional<double> teacher;                          // weight; none: by the number of trials
  bool uniform_inputs = true;                             // unknown_inputs is "prior"
  std::vector<std::string> command;                       // for the sampler "command"
  std::string stand_in = "block_gibbs";                   // for a sampler that fails
  std::map<std::string, campaign::EncoderSpec> encoders;  // by variable, if the study gives one
  std::map<std::string, std::vector<double>> edges;       // by variable, if its encoder gives edges [unit]
};

/// Reads the section; without one the defaults hold. Throws InputError for unknown keys, values out of range and
/// unknown variables.
LearningSettings read_learning_settings(const std::optional<Config>& section);

/// From kManyTrials trials on, keys that are not given get the defaults for a machine whose joint distribution is
/// right: code_words, 48 hidden units, generative 0.07, weight_decay 0.3, calibrate, 256 chains of one sweep an update,
/// and 7,000 updates with the learning rate falling to 0.05 of itself. Settings stay where the study chooses another
/// negative phase or another sampler.
inline constexpr std::size_t kManyTrials = 500;
LearningSettings settings_for_trials(LearningSettings settings, std::size_t trials);

/// settings_for_trials() as the trainer takes them. Unless the study gives `batch`, an epoch has at most 32
/// minibatches.
learning::TrainingSettings training_settings(const LearningSettings& settings, std::size_t trials, std::uint64_t seed);

Json to_json(const LearningSettings& settings);

}  // namespace gonogo::learn
