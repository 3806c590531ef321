#include "pipeline/outcome/training/train_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "base/version.h"
#include "learning/rbm/train.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/joint_scores.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

namespace fs = std::filesystem;

/// Trials and settings that a model and its members are trained with.
struct Inputs {
  LearningSettings settings;
  std::string data_hash;  // of the dataset's file
  double gravity = 0;     // of the trials [m/s^2]
  TrainingData data;
  learning::TrainingTable held_out;
  learning::TrainingSettings training;
  OtherTrials others;
  TeacherShare teacher;
};

Inputs read_inputs(const TrainRequest& request) {
  Inputs in;
  in.settings = trainable_settings(request.learning);
  const campaign::Dataset dataset = campaign::read_dataset(request.dataset);
  in.gravity = campaign::settings_of(dataset.provenance, request.dataset.string()).gravity;
  in.data = make_training_data(dataset.records, request.design);
  widen_to_own_ranges(in.data, dataset.provenance, request.dataset.string());
  temper_weights(in.data, in.settings.importance);
  if (request.hold_out > 0) in.held_out = hold_out(in.data, request.hold_out, request.seed);
  if (!request.groups.empty()) keep_groups(in.data, request.groups);
  in.others = read_other_trials(dataset.provenance, request.dataset.string(), request.others);
  if (request.forecast) add_forecast(in.others, request.forecast);
  const std::size_t rows = in.data.table.row_count(), others = in.others.count();
  in.settings = settings_for_trials(std::move(in.settings), rows, others);
  // The teacher then knows as much as all these trials, and weighs as much.
  if (request.forecast && !in.settings.given.count("teacher") && in.settings.teacher)
    *in.settings.teacher *= double(rows + others) / double(rows);
  in.training = training_settings(in.settings, rows, others, request.seed);
  in.data_hash = file_hash(request.dataset);
  in.teacher = teacher_share(in.settings);
  return in;
}

/// As many folds as asked for, or as there are groups of trials where they are fewer.
std::size_t usable_folds(const learning::TrainingTable& table, std::size_t asked) {
  std::vector<std::uint64_t> groups(table.group);
  std::sort(groups.begin(), groups.end());
  return std::min(asked, std::size_t(std::unique(groups.begin(), groups.end()) - groups.begin()));
}

/// Progress in epochs over all machines: those of the folds, some at a time, then the last one. The time of their
/// teachers, who learn before, is counted apart. Calls must not overlap.
class TrainingProgress {
 public:
  /// `next` is called before each update; it may be empty.
  TrainingProgress(std::size_t folds, const learning::TrainingSettings& settings, learning::EpochHook next)
      : folds_(folds),
        epochs_(settings.epochs),
        report_every_(settings.report_every),
        last_epochs_(epochs_),
        next_(std::move(next)),
        progress_("train", "epochs", (folds + 1) * epochs_) {}

  /// Hook of learning::train_rbm() and of learning::cross_validate().
  learning::EpochHook watch() {
    return [this](std::size_t epoch, const learning::RbmWeights& weights) {
      const bool go_on = !next_ || next_(epoch, weights);
      const std::size_t since = epoch % report_every_ == 0 ? report_every_ : epoch % report_every_;
      done_ += double(since) * double(epochs_) / double(last_epochs_);
      update();
      return go_on;
    };
  }
  /// A machine comes from an earlier run. Its epochs do not count in the rate.
  void reuse_machine() {
    reused_ += epochs_;
    done_ += double(epochs_);
  }
  void machine_done(std::size_t done) {
    machines_done_ = done;
    update();
  }
  /// The machine in progress is the last one and trains for `epochs`. It counts as much as a fold.
  void last_machine(std::size_t epochs) { last_epochs_ = epochs; }

  /// fit(), all teachers, the largest of so many trials.
  template <class Fit>
  void teach(std::size_t trials, const Fit& fit) {
    constexpr std::size_t kSlow = 1000;  // trials whose Gaussian process takes more than a second or two
    const auto start = std::chrono::steady_clock::now();
    if (trials >= kSlow) progress_.announce("teachers learn up to " + std::to_string(trials) + " trials");
    fit();
    progress_.count_other_work(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 0);
  }

 private:
  void update() {
    const std::size_t machine = std::min(machines_done_, folds_) + 1;
    progress_.update(std::size_t(done_ + 0.5),
                     "machine " + std::to_string(machine) + " of " + std::to_string(folds_ + 1), reused_);
  }

  std::size_t folds_, epochs_, report_every_;
  std::size_t machines_done_ = 0, last_epochs_, reused_ = 0;
  double done_ = 0;  // epochs
  learning::EpochHook next_;
  Progress progress_;
};

/// Answers of a Gaussian process that was fitted without a fold.
struct ProcessAnswers {
  std::vector<double> held_out;  // P(go) of the fold's trials
  std::vector<double> taught;    // P(go) of the taught points; empty where nothing is taught
};

/// Finished parts of a run, kept in <model>.unfinished until the whole run is done. A run that is started again with
/// the same inputs takes them from there.
class KeptWork {
 public:
  /// `key`: hash of everything that the parts depend on. Parts with another key are removed.
  KeptWork(const fs::path& model, std::string key) : folder_(model.string() + ".unfinished"), key_(std::move(key)) {
    if (!fs::is_directory(folder_)) return;
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().filename().string().rfind(key_ + ".", 0) != 0) fs::remove(entry.path());
  }

  /// A finished fold of the cross-validation. None: it was not kept, or its file is damaged.
  std::optional<learning::FoldResult> fold(std::size_t fold) const {
    return read<learning::FoldResult>(
        "fold" + std::to_string(fold) + ".h5", "the fold is trained again", [](const Hdf5Reader& in) {
          learning::FoldResult result;
          result.probability = in.array<double>("probability");
          const auto epoch = in.array<double>("epoch"), loss = in.array<double>("training_loss", Shape{epoch.size()});
          for (std::size_t r = 0; r < epoch.size(); ++r) result.log.push_back({epoch[r], loss[r], NAN});
          return result;
        });
  }
  void keep_fold(std::size_t fold, const learning::FoldResult& result) const {
    std::vector<double> epoch, loss;
    for (const learning::EpochLog& entry : result.log) {
      epoch.push_back(entry.epoch);
      loss.push_back(entry.training_loss);
    }
    write("fold" + std::to_string(fold) + ".h5",
          {{"probability", &result.probability}, {"epoch", &epoch}, {"training_loss", &loss}});
  }

  /// The answers of a fold's Gaussian process, likewise.
  std::optional<ProcessAnswers> process(std::size_t fold) const {
    return read<ProcessAnswers>("process" + std::to_string(fold) + ".h5", "the Gaussian process is fitted again",
                                [](const Hdf5Reader& in) {
                                  return ProcessAnswers{in.array<double>("held_out"), in.array<double>("taught")};
                                });
  }
  void keep_process(std::size_t fold, const ProcessAnswers& answers) const {
    write("process" + std::to_string(fold) + ".h5", {{"held_out", &answers.held_out}, {"taught", &answers.taught}});
  }

  /// Whether `file` is a member that this run finished, with the bytes it had then.
  bool has_member(const fs::path& file) const {
    const fs::path record = part(file.filename().string() + ".hash");
    return fs::exists(record) && fs::exists(file) && read_file(record) == file_hash(file);
  }
  void keep_member(const fs::path& file) const {
    write_file_atomically(part(file.filename().string() + ".hash"), file_hash(file));
  }

  /// To be called once the run's files are written.
  void remove() const { fs::remove_all(folder_); }

 private:
  fs::path part(const std::string& name) const { return folder_ / (key_ + "." + name); }

  template <class Part, class Read>
  std::optional<Part> read(const std::string& name, const char* remedy, const Read& read) const {
    if (!fs::exists(part(name))) return std::nullopt;
    try {
      return read(Hdf5Reader(part(name)));
    } catch (const InputError& damaged) {
      log_line("train", std::string(damaged.what()) + "; " + remedy);
      return std::nullopt;
    }
  }
  void write(const std::string& name,
             const std::vector<std::pair<const char*, const std::vector<double>*>>& arrays) const {
    Hdf5Writer out;
    for (const auto& [array, values] : arrays) out.array(array, *values);
    create_folder(folder_);
    out.save(part(name));
  }

  fs::path folder_;
  std::string key_;
};

/// The teachers of all machines. Every fold has one that has not seen it, and that process's forecasts of the fold's
/// trials score it as a baseline. The last one, number fold_count, has seen all.
class Teachers {
 public:
  Teachers(const Inputs& in, const std::vector<std::size_t>& fold, std::size_t fold_count, const TaughtPoints& points,
           const KeptWork& kept)
      : in_(in), fold_(fold), points_(points), kept_(kept), answers_(fold_count + 1) {}

  /// Fits those of the folds that were not kept, as many at a time as there are cores.
  void fit_folds() {
    std::mutex keeping;  // HDF5 has one thread
    for (std::size_t machine = 0; machine < answers_.size(); ++machine) answers_[machine] = kept_.process(machine);
    std::vector<std::pair<std::size_t, bool>> tasks;  // machine, whether it teaches; what takes longer first
    for (const bool teaches : {true, false})
      for (std::size_t machine = 0; machine < last(); ++machine)
        if (!answers_[machine]) tasks.emplace_back(machine, teaches);
    std::vector<ProcessAnswers> found(last());
    std::vector<int> left(last(), 2);
    for_each_on_host(tasks.size(), 1, [&](std::size_t k) {
      const auto [machine, teaches] = tasks[k];
      if (teaches)
        found[machine].taught = taught(machine);
      else
        found[machine].held_out = forecasts(machine);
      const std::lock_guard lock(keeping);
      if (--left[machine] > 0) return;
      kept_.keep_process(machine, found[machine]);
      answers_[machine] = std::move(found[machine]);
    });
  }
  /// Fits the last one if it was not kept. It may run beside other work of a training, and is kept by keep_last().
  void fit_last() {
    if (!answers_[last()])
      answers_[last()] = ProcessAnswers{{}, in_.teacher.weight > 0 ? of_all()(points_.values) : std::vector<double>()};
  }
  /// The last one, which is fitted where its answers were kept. Not to be called beside fit_last().
  const Teacher& of_all() {
    if (!of_all_) {
      const Rows rows = rows_of(last());
      of_all_.emplace(rows.seen, rows.others);
    }
    return *of_all_;
  }
  void keep_last() const { kept_.keep_process(last(), *answers_[last()]); }

  /// What a machine is taught; none without a weight.
  std::shared_ptr<const learning::Teaching> of(std::size_t machine) const {
    return in_.teacher.weight > 0 ? teaching(in_.teacher, points_, answers_[machine]->taught) : nullptr;
  }
  /// P(go) of every trial by the process that has not seen the trial's fold [row].
  std::vector<double> held_out() const {
    std::vector<std::size_t> next(answers_.size(), 0);
    std::vector<double> result;
    for (std::size_t f : fold_) result.push_back(answers_[f]->held_out[next[f]++]);
    return result;
  }

 private:
  struct Rows {
    learning::TrainingTable seen, unseen;
    OtherTrials others;
  };
  std::size_t last() const { return answers_.size() - 1; }
  Rows rows_of(std::size_t machine) const {
    std::vector<std::size_t> training, held_out;
    for (std::size_t n = 0; n < fold_.size(); ++n) (fold_[n] == machine ? held_out : training).push_back(n);
    const learning::TrainingTable& table = in_.data.table;
    Rows rows{table.subset(training), table.subset(held_out), in_.others};
    if (!held_out.empty()) rows.others = in_.others.away_from(rows.unseen);
    return rows;
  }
  std::vector<double> taught(std::size_t machine) const {
    if (in_.teacher.weight == 0) return {};
    const Rows rows = rows_of(machine);
    return Teacher(rows.seen, rows.others)(points_.values);
  }
  std::vector<double> forecasts(std::size_t fold) const {
    const Rows rows = rows_of(fold);
    return process_baseline(rows.seen, rows.others, rows.unseen.variables);
  }

  const Inputs& in_;
  const std::vector<std::size_t>& fold_;
  const TaughtPoints& points_;
  const KeptWork& kept_;
  std::vector<std::optional<ProcessAnswers>> answers_;  // [machine]
  std::optional<Teacher> of_all_;
};

/// Folds of a stand-in are not kept: the run that continues would not know of it.
learning::FoldStore fold_store(const KeptWork& kept, TrainingProgress& progress, const TrainingSampler& source) {
  return {.find =
              [&](std::size_t fold) {
                std::optional<learning::FoldResult> found = kept.fold(fold);
                if (found) progress.reuse_machine();
                return found;
              },
          .keep =
              [&](std::size_t fold, const learning::FoldResult& result) {
                if (!source.stood_in()) kept.keep_fold(fold, result);
              }};
}

/// The power that calibrates held-out rows best. Leaves out the rows of fold `without`.
double fitted_power(const TrainingData& data, const std::vector<double>& probability,
                    const std::vector<std::size_t>& fold, std::size_t without) {
  const std::size_t outcomes = probability.size() / fold.size();
  std::vector<double> rows, weight;
  std::vector<std::size_t> outcome;
  for (std::size_t n = 0; n < fold.size(); ++n) {
    if (fold[n] == without) continue;
    rows.insert(rows.end(), probability.begin() + std::ptrdiff_t(n * outcomes),
                probability.begin() + std::ptrdiff_t((n + 1) * outcomes));
    outcome.push_back(data.table.outcome[n]);
    weight.push_back(data.table.weight[n]);
  }
  return learning::fit_power(rows, outcome, weight);
}

/// Sharpens every fold's forecasts by the power that the other folds choose, and returns the power that all choose.
double calibrate(const TrainingData& data, learning::CrossValidation& folds, const std::vector<std::size_t>& fold,
                 std::size_t fold_count) {
  const std::vector<double> before = folds.probability;
  const std::size_t outcomes = before.size() / fold.size();
  std::vector<double> power(fold_count + 1);  // without each fold, then of all
  for_each_on_host(power.size(), 1, [&](std::size_t f) { power[f] = fitted_power(data, before, fold, f); });
  for (std::size_t n = 0; n < fold.size(); ++n)
    learning::sharpen(std::span(folds.probability).subspan(n * outcomes, outcomes), power[fold[n]]);
  return power.back();
}

TrialCounts count_trials(const TrainingData& data, const learning::TrainingTable& held_out) {
  TrialCounts counts{.trials = data.trials,
                     .trained_on = data.table.row_count(),
                     .unknown = data.failed,
                     .held_out = held_out.row_count(),
                     .outcomes = {}};
  for (std::size_t y = 0; y < campaign::contract().outcomes.size(); ++y)
    counts.outcomes.emplace_back(campaign::contract().outcomes[y].name, data.outcome_count[y]);
  return counts;
}

FailureRate failure_rate(const TrainingData& data, const learning::TrainingTable& held_out) {
  learning::TrainingTable all = data.table;
  for (const std::vector<double>* rows : {&held_out.variables, &data.failed_variables})
    all.variables.insert(all.variables.end(), rows->begin(), rows->end());
  std::vector<int> failed(data.trials - data.failed, 0);
  failed.resize(data.trials, 1);
  all.outcome.resize(data.trials, 0);
  all.weight.assign(data.trials, 1.0);
  all.group.resize(data.trials, 0);
  const std::vector<double> certain(data.trials, double(data.failed) / double(data.trials));
  const learning::ReliabilityBin overall = learning::reliability(certain, failed, 1).front();
  FailureRate rate{.overall = {certain.front(), overall.low, overall.high}, .modelled = {}};
  if (data.failed == 0) return rate;
  const learning::LogisticModel model = learning::fit_logistic(all, failed);
  FailureRate::Modelled& modelled = rate.modelled.emplace();
  for (std::size_t n = 0; n < all.row_count(); ++n) modelled.highest = std::max(modelled.highest, model(all.row(n)));
  for (std::size_t v = 0; v < all.variable_count; ++v)
    modelled.weights.emplace_back(campaign::contract().variables[v].name, model.weight[v]);
  return rate;
}

/// Scores of P(go) on rows that each forecaster did not train on. beside: as of cross_validate_baselines().
Scores cross_validation_scores(const TrainingData& data, const learning::CrossValidation& folds,
                               const std::vector<std::size_t>& fold, std::size_t fold_count, std::uint64_t seed,
                               const Teachers& teachers, const std::function<void()>& beside) {
  const std::vector<int> passable = passable_outcomes();
  Forecasts forecasts;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) {
    double p = 0;
    for (std::size_t y = 0; y < passable.size(); ++y) p += passable[y] * folds.probability[n * passable.size() + y];
    forecasts.model.push_back(p);
    forecasts.happened.push_back(passable[data.table.outcome[n]]);
  }
  forecasts.baselines = cross_validate_baselines(data.table, forecasts.happened, fold, fold_count, beside);
  forecasts.baselines["gaussian_process"] = teachers.held_out();
  return score_forecasts(forecasts, seed);
}

/// A machine of code words ends with balanced inputs, if its joint distribution was trained.
void balance(const learning::VisibleLayout& layout, const learning::TrainingTable& table,
             const learning::TrainingSettings& settings, const learning::Teaching* lesson,
             learning::RbmWeights& weights) {
  if (settings.negative != learning::NegativePhaseKind::code_words || settings.generative == 0) return;
  weights = balanced_inputs(layout, table, std::move(weights), settings.seed, lesson);
}

/// Trains the machines of all folds, and beside them the last teacher.
learning::CrossValidation train_folds(const Inputs& in, const learning::VisibleLayout& layout, std::size_t folds,
                                      const KeptWork& kept, TrainingSampler& source, TrainingProgress& progress,
                                      Teachers& teachers) {
  learning::CrossValidation validation = cross_validate(layout, in.data.table, in.training, source.sampler(), folds,
                                                        {.progress =
                                                             [&](std::size_t done) {
                                                               progress.machine_done(done);
                                                               source.begin();
                                                             },
                                                         .watch = progress.watch(),
                                                         .store = fold_store(kept, progress, source),
                                                         .teaching = [&](std::size_t f) { return teachers.of(f); },
                                                         .beside = [&] { teachers.fit_last(); }});
  teachers.keep_last();
  return validation;
}

VehicleOdds odds_report(const std::vector<VehicleTrials>& vehicles, double shift) {
  VehicleOdds report{.shift = shift, .vehicles = {}};
  for (const VehicleTrials& trials : vehicles)
    report.vehicles.push_back({trials.hash, trials.vehicle, trials.table.row_count()});
  return report;
}

/// Writes the model. That of a family holds its teacher, too, which answers for single vehicles.
void write_trained(const fs::path& file, const learning::Model& model, const Inputs& in,
                   const std::function<const Teacher&()>& teacher) {
  const bool is_of_family = in.teacher.weight > 0 && samples_vehicles(in.data.lower, in.data.upper);
  learning::write_model(file, model, [&](Hdf5Writer& out) {
    if (is_of_family && !in.others.forecast) teacher().write(out);
  });
}

}  // namespace

void take_study(TrainRequest& request, const std::filesystem::path& study, std::optional<std::uint64_t> seed) {
  request.seed = seed.value_or(1);
  if (study.empty()) return;
  const campaign::Study read = campaign::read_study(study);
  if (!seed) request.seed = read.seed;
  request.learning = read.config.object_if("learning");
  request.design = read.config.object_if("design");
}

LearningSettings trainable_settings(const std::optional<Config>& section) {
  const LearningSettings settings = read_learning_settings(section);
  if (settings.training.gradients == learning::GradientDevice::cuda && !learning::gradients_on_gpu())
    section->fail("gradients",
                  "is cuda, but LibTorch sees no GPU here; Debian's libtorch-dev has no CUDA: choose cpu, or build "
                  "against a LibTorch that has (README.md, GONOGO_TORCH)");
  return settings;
}

std::string work_key(const TrainRequest& request, const LearningSettings& settings) {
  Json key;
  key["dataset"] = file_hash(request.dataset);
  key["contract"] = content_hash(campaign::contract_text());
  key["program"] = std::string(program_version()) + " " + program_revision();
  key["settings"] = to_json(settings);
  for (const std::filesystem::path& other : request.others) key["others"].push_back(file_hash(other));
  if (request.forecast) key["forecast"] = request.forecast->hash;
  for (const VehicleTrials& trials : request.vehicles) key["vehicles"].push_back(trials.hash);
  if (request.design) key["design"] = request.design->json();
  key["hold_out"] = request.hold_out;
  for (const std::uint64_t group : request.groups) key["groups"].push_back(Json(group));
  key["seed"] = request.seed;
  return content_hash(key.dump());
}

TrainingReport train_model(const TrainRequest& request) {
  Inputs in = read_inputs(request);
  const learning::TrainingTable& table = in.data.table;
  learning::TrainingSettings& training = in.training;
  learning::Model model;
  model.layout = make_layout(in.data, in.settings);
  TrainingSampler source(in.settings, model.layout, training);
  const std::size_t folds = usable_folds(table, in.settings.folds);
  if (folds < 2) throw InputError(request.dataset.string() + ": trials at two points or more are needed to train");

  const KeptWork kept(request.model, work_key(request, in.settings));
  TrainingProgress progress(folds, training, source.watch());
  const std::vector<std::size_t> fold = learning::assign_folds(table, folds, training.seed);
  const TaughtPoints points =
      taught_points(in.data.lower, in.data.upper, in.settings.taught_points, request.seed, in.others);
  Teachers teachers(in, fold, folds, points, kept);
  progress.teach(table.row_count(), [&] { teachers.fit_folds(); });
  learning::CrossValidation validation = train_folds(in, model.layout, folds, kept, source, progress, teachers);
  training.epochs = validation.best_epoch;
  progress.last_machine(training.epochs);
  if (in.settings.calibrate) model.calibration_power = calibrate(in.data, validation, fold, folds);
  const auto lesson = teachers.of(folds);
  const auto train_last = [&] {
    model.weights =
        train_rbm(model.layout, table, training, source.sampler(), progress.watch(), nullptr, lesson.get()).weights;
  };
  const bool beside = trains_by_words(model.layout, table, training, source.sampler());
  if (!beside) train_last();
  const Scores scores = cross_validation_scores(in.data, validation, fold, folds, training.seed, teachers,
                                                beside ? train_last : std::function<void()>());
  describe_trials(in.data, in.settings.uniform_inputs, model);
  const double shift = request.vehicles.empty() ? 0 : fitted_shift(Predictor(model), request.vehicles);
  shift_odds(model.layout, shift, model.calibration_power, model.weights);
  balance(model.layout, table, training, lesson.get(), model.weights);
  model.log = validation.log;

  TrainingReport report{.data_hash = in.data_hash,
                        .contract_hash = content_hash(campaign::contract_text()),
                        .program_version = program_version(),
                        .gravity = in.gravity != kGravity ? std::optional(in.gravity) : std::nullopt,
                        .sampler = source.report(),
                        .calibration_power = model.calibration_power,
                        .odds = odds_report(request.vehicles, shift),
                        .seed = request.seed,
                        .settings = in.settings,
                        .teacher_weight = in.teacher.weight,
                        .others = in.others.datasets,
                        .batch = training.batch,
                        .epochs = validation.best_epoch,
                        .counts = count_trials(in.data, in.held_out),
                        .failures = failure_rate(in.data, in.held_out),
                        .cross_validation = scores,
                        .folds = folds,
                        .joint = scored_joint(Predictor(model), table, request.seed)};
  model.provenance = to_json(report);
  write_trained(request.model, model, in, [&]() -> const Teacher& { return teachers.of_all(); });
  if (!request.members_follow) kept.remove();
  return report;
}

namespace {

/// Times Exp(1) for each group, then to mean 1 again.
void reweigh(learning::TrainingTable& table, std::uint64_t seed, int member) {
  std::map<std::uint64_t, double> factor;
  double sum = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    const auto [place, is_new] = factor.try_emplace(table.group[n], 0.0);
    if (is_new) place->second = -std::log1p(-random_unit(seed, std::uint64_t(member), table.group[n]));
    table.weight[n] *= place->second;
    sum += table.weight[n];
  }
  for (double& weight : table.weight) weight *= double(table.row_count()) / sum;
}

}  // namespace

std::vector<std::filesystem::path> train_members(const TrainRequest& request, int count) {
  const learning::Model base = read_contract_model(request.model);
  Inputs in = read_inputs(request);
  if (base.provenance.at("data_hash").string() != in.data_hash)
    throw InputError(request.model.string() + ": was trained on other trials than " + request.dataset.string() +
                     "; train it anew with gonogo train");
  in.training.epochs = std::size_t(base.provenance.at("epochs").unsigned_integer());
  const bool outside = in.settings.sampler == "command" || in.settings.sampler == learning::kEmulator;
  const auto sampler = learning::make_machine_sampler(outside ? in.settings.stand_in : in.settings.sampler);
  const KeptWork kept(request.model, work_key(request, in.settings));
  Progress progress("train", "members", std::size_t(count));
  std::vector<fs::path> files;
  std::size_t reused = 0;
  for (int member = 1; member <= count; ++member) {
    files.push_back(request.model.parent_path() /
                    (request.model.stem().string() + ".member" + std::to_string(member) + ".h5"));
    if (kept.has_member(files.back())) {
      progress.update(std::size_t(member), "", ++reused);
      continue;
    }
    learning::TrainingTable table = in.data.table;
    reweigh(table, request.seed, member);
    in.training.seed = random_bits(request.seed, 1, std::uint64_t(member));
    learning::Model model = base;
    const TaughtPoints points =
        taught_points(in.data.lower, in.data.upper, in.settings.taught_points, in.training.seed, in.others);
    std::optional<Teacher> teacher;
    if (in.teacher.weight > 0) teacher.emplace(table, in.others);
    const auto lesson = teacher ? teaching(in.teacher, points, (*teacher)(points.values)) : nullptr;
    model.weights = train_rbm(base.layout, table, in.training, *sampler, {}, nullptr, lesson.get()).weights;
    shift_odds(base.layout, read_report(base.provenance).odds.shift, base.calibration_power, model.weights);
    balance(base.layout, table, in.training, lesson.get(), model.weights);
    model.provenance["member"] = member;
    write_trained(files.back(), model, in, [&]() -> const Teacher& { return *teacher; });
    kept.keep_member(files.back());
    progress.update(std::size_t(member), "", reused);
  }
  kept.remove();
  return files;
}

}  // namespace gonogo::outcome
