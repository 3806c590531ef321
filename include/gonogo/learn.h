// Models of outcomes: train them on a dataset, score them, ask them. Link gonogo::learn.
//
// A model is a restricted Boltzmann machine over the variables and outcomes of campaign.h.
#pragma once
#include <gonogo/campaign.h>

namespace gonogo::api {

struct TrainRequest {
  std::filesystem::path dataset{}, model{};     // dataset.h5 to read, model.h5 to write
  std::vector<std::filesystem::path> others{};  // datasets that add to the first, mostly of other fidelities
  std::string study{};                  // a file or shipped study with settings of learning; empty: the usual ones
  std::optional<std::uint64_t> seed{};  // none: the study's, or 1
  std::size_t hold_out = 0;             // trials that are kept for evaluate()
  // Model of the vehicle's family, a file or shipped name: own trials correct its forecast. Empty text: the one that
  // ships; none: own trials alone.
  std::optional<std::string> family{};
  // Trials of vehicles of the family that `dataset` drove, each driven by itself: they shift its odds of passing to
  // theirs.
  std::vector<std::filesystem::path> vehicles{};
  int members = 0;  // bootstrap members, written beside the model; their spread is what the trials leave open
};

/// Scores of P(go) as a forecast of whether trials pass.
struct Score {
  std::string of{};                      // "model", or a baseline such as "gaussian_process"
  Range brier{};                         // 95 % interval of the Brier score
  double brier_score = 0, log_loss = 0;  // [-], [nat]
  double accuracy = 0, calibration_error = 0;
};

struct TrainReport {
  std::size_t trials = 0, trained_on = 0, unknown = 0, held_out = 0, epochs = 0;
  std::vector<Score> scores{};  // cross-validated: the model, then baselines
  std::vector<std::filesystem::path> members{};
  std::string text{};  // for people
};

/// Trains and writes a model. The same dataset, settings and seed give the same bytes. The same call after an
/// interruption goes on. Throws InputError for a dataset without valid trials, and in a build without LibTorch.
TrainReport train(const TrainRequest& request);

/// A pass criterion.
struct Check {
  std::string what{};
  bool holds = false;
  double value = 0, limit = 0;
};

struct Evaluation {
  std::size_t trials = 0, trained_on = 0, unknown = 0;  // scored; left out
  std::vector<Score> scores{};                          // the model, then baselines
  std::vector<Check> checks{};
  std::string text{};  // for people
};

/// Scores a model (a file or a shipped name) on the trials of a dataset that it was not trained on. Throws InputError
/// as train().
Evaluation evaluate(const std::string& model, const std::filesystem::path& dataset);

struct OutcomeChance {
  std::string name{};
  double probability = 0, standard_error = 0;  // error above 0 only where unknown variables were sampled
};

/// Distribution of a variable that was not given, in its unit.
struct Unknown {
  std::string name{};
  double mean = 0, deviation = 0;
  Range interval{};  // of 90 %
};

struct Answer {
  double p_go = 0;                        // of go or slow_go, given a valid trial
  std::vector<OutcomeChance> outcomes{};  // in the order of outcomes()
  std::string outside{};                  // a variable outside the range of the trials; empty: none
  double novelty = 0;  // distance to the nearest trial over the usual one between trials: about 1 among trials
  std::vector<Unknown> unknown{};  // where Model::ask() was asked for them
};

struct RowRequest {
  std::size_t rows = 1000;
  Values known{};         // the others are drawn
  std::string outcome{};  // given; empty: drawn
  std::string sampler =
      "auto";  // "exact", "code_words", "tempering", "block_gibbs", "anneal", "population", "emulator"
  std::uint64_t seed = 1;
};

/// Rows drawn from a model.
struct SampledRows {
  std::vector<std::string> columns{};  // names of variables
  std::vector<double> values{};        // [row][column]
  std::vector<std::string> outcome{};  // [row]
  std::string sampler{};               // that drew them
  double effective_rows = 0;           // independent rows that they are worth; NaN where nothing was drawn
};

/// A trained model. Cheap to copy; calls from several threads are safe.
class Model {
 public:
  struct Impl;
  /// A file, a folder that holds model.h5, or the name of a shipped model or of its vehicle ("hmmwv").
  static Model read(const std::string& name_or_file);
  std::filesystem::path file() const;
  /// Ranges that the trials sampled, by variable.
  std::map<std::string, Range> sampled() const;
  double gravity() const;  // of the trials [m/s^2]

  /// P(go or slow_go). Variables that are not given are summed out. Throws InputError for values out of range.
  double p_go(const Values& known) const;
  /// The same of many points [point][variable], in the order of variables(); NaN: unknown. On all cores.
  std::vector<double> p_go(const std::vector<double>& points) const;
  /// `outcome`: the one that the trial had; empty: unknown. `infer`: also the variables that are not given.
  Answer ask(const Values& known, const std::string& outcome = "", bool infer = false) const;
  SampledRows sample(const RowRequest& request) const;

 private:
  explicit Model(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

}  // namespace gonogo::api
