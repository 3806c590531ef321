// The "learning" section of a study:
//
//   sampler         source of the negative phase: "block_gibbs" (default), "anneal", "tempering", "population",
//                   "exact", "command", or "emulator" (a D-Wave 2X, see EmulatorChoice)
//   gpu             "auto" (default): block_gibbs samples on a GPU if there is one and an update is large enough to
//                   gain by it; "never"
//   gradients       "cpu" (default) or "cuda": where LibTorch computes; one core is faster for tens of units
//   command         of the sampler "command": list of program and arguments with {problem} {answer} {reads} {seed}
//   stand_in        sampler that takes over if "command" fails (default "block_gibbs"); log, model and report say so
//   hidden          number of hidden units
//   epochs          max passes over the trials
//   batch           trials of a minibatch (default 32, from 200 trials on 64, or a 32nd of the trials if that is more)
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
//                   "trajectory"; these two have "rungs" machines on a ladder. "code_words" (default for trials)
//                   draws whole code words, and the machine is one of code words only
//   importance      power in [0, 1] of the trials' weights prior / proposal density (default 1)
//   calibrate       whether to sharpen or blunt all probabilities by a power that the held-out folds choose
//                   (default no)
//   unknown_inputs  "prior" (default): answers sum unknown variables out over the design's distribution, uniform over
//                   the sampled box; "machine": over the machine's joint distribution
//   teacher         weight of the soft labels of the teacher (training/teacher.h; default 10, from 200 trials on 30;
//                   0: none)
//   bins            "range" (default) or "quantile"
//   with            datasets of other fidelities that `gonogo run` trains on, too: named_trials()
//   encoders        { "<variable>": { "code": "thermometer" | "one_hot" | "gray" | "binary", "bits": n } }; default:
//                   the contract's. "edges" in place of "bits" gives the inner edges of the bins [unit of the
//                   variable], increasing
//   emulator        of the sampler "emulator": the fields of EmulatorChoice
//
// Other defaults are those of learning::TrainingSettings, and those of settings_for_trials().
// docs/learning.md shows the experiments behind them.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "learning/training.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::outcome {

/// An emulated annealer to train with.
struct EmulatorChoice {
  std::string graph = "chimera:12";  // or "pegasus:16", "zephyr:12", ...
  double temperature = 0.2;          // of the device, in units of the fields h
  double dead_share = 0.02;          // share of dead qubits
  std::uint64_t dead_seed = 1;       // that draws the dead qubits
  /// What sets the scale after each epoch: "pseudo_likelihood", "histogram", "offset_model" or "none".
  std::string thermometer = "pseudo_likelihood";
  double chain_coupling = 0.6;   // |J| inside chains
  std::size_t gauges = 4;        // of every request
  std::size_t sweeps = 600;      // of the device's anneal
  std::size_t reads = 250;       // of a temperature reading
  std::size_t post_sweeps = 10;  // of block Gibbs on the host, from the device's rows
};
/// Reads the section; without one the defaults hold. Throws InputError for unknown keys and values out of range.
EmulatorChoice read_emulator_choice(const std::optional<Config>& section);
Json to_json(const EmulatorChoice& choice);

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
  std::size_t taught_points = 2048;                       // that the teacher labels
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
/// right: code_words, 48 hidden units, generative 0.3, weight_decay 0.3, calibrate, 256 chains of one sweep an update,
/// minibatches of 64, 3,500 updates with the learning rate falling to 0.05 of itself, and a teacher of weight 30 at
/// 16,384 points. Settings stay where the study chooses another negative phase or another sampler. `others`: trials of
/// other fidelities, or of the vehicle's family, that the teacher learns, too. They count as own ones do, since a small
/// machine cannot follow what the teacher knows by them. Beside the forecast of a
/// family, train_model() multiplies the teacher's weight by all trials over own ones.
inline constexpr std::size_t kManyTrials = 200;
LearningSettings settings_for_trials(LearningSettings settings, std::size_t trials, std::size_t others);

/// settings_for_trials() as the trainer takes them. Unless the study gives `batch`, an epoch has at most 32
/// minibatches.
learning::TrainingSettings training_settings(const LearningSettings& settings, std::size_t trials, std::size_t others,
                                             std::uint64_t seed);

Json to_json(const LearningSettings& settings);

/// Trials that a study learns from beside its own: the files of "with" in the order of the list; none without the
/// section or the key. Each is the name of a shipped folder data/<name>, or a file, relative to the study. Throws
/// InputError for a file that is not there, for an unknown name, with the nearest one, and for a dataset named twice.
std::vector<std::filesystem::path> named_trials(const std::optional<Config>& section);

/// The shipped dataset with this content hash; empty where none has it.
std::filesystem::path shipped_trials(const std::string& hash);

}  // namespace gonogo::outcome
