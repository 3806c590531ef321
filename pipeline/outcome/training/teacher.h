// The teacher of a machine says P(go) at points without a trial (learning/rbm/train.h). It is the mean of two Gaussian
// processes that are fitted to the same trials, each at its most probable latent function:
//
// - one learns which trials pass;
// - the other does, too, with the mean a + b r(x). r(x) is the share of the commanded speed to expect, by a regression
//   on the speeds of the trials. A speed says more of a trial than whether it passes.
//
// Both take the size of the slope across as one more input. A vehicle whose sides are alike passes as often with either
// side up, so a trial then tells of both. Trials of other vehicles give that input little weight.
//
// Where few trials are of the finest fidelity, the process also learns those of other fidelities. It takes fidelity as
// inputs beside the variables and answers at the finest; the machine's own rows are the finest trials alone. One kernel
// over points and fidelities is the simplest model of Kennedy & O'Hagan, "Predicting the output from a complex computer
// code when fast approximations are available", Biometrika 87:1 (2000). Other trials of the same fidelity, of another
// design, are as good as own ones to the process.
//
// A vehicle whose family has a model starts from its forecast f [nat]. The means of the two processes are
// f + c + w.x and f + c' + w'.x + b r(x), by logistic regressions whose penalties hold them to f, and f is an input of
// both. r(x) then adds to what the family's trials expect. Few own trials so say how the vehicle differs from its
// family.
//
// For a family of vehicles, trials of its wheels by themselves are the coarse fidelity. Both processes then see the
// margins of the vehicle that is composed of such wheels beside the variables (composed.h).
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/rbm/gaussian_process.h"
#include "learning/rbm/train.h"
#include "learning/training.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/prior/composed.h"
#include "pipeline/outcome/prior/forecast.h"
#include "pipeline/outcome/prior/speed_share.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {

/// What two trials of the same variables may differ in.
struct Fidelity {
  bool is_whole = false;
  bool has_compliant_tyres = false;  // true of a family, whose deflections are variables
  double grains_per_tyre = 0;        // tyre width over grain diameter [-]
  double wheel_rolling = 0;          // rolling friction of grains on wheels over that between grains [-]
  /// The numerics show the grains' own strength in a slow shear test (docs/log/creep.md): contacts give, or the solver
  /// stops at a tolerance or takes a hundred updates a step.
  bool has_solved_contacts = false;

  bool operator==(const Fidelity&) const = default;
  /// A whole vehicle is finer than a quarter; then compliant tyres than rigid ones; then solved contacts than others;
  /// then grains that resist rolling on wheels as on each other (docs/wheels.md); then small grains than large ones.
  bool is_finer_than(const Fidelity& other) const;
  /// "whole vehicle, compliant tyres, 7.9 grains across a wheel, which resist rolling on it, contacts solved"
  std::string text() const;
  /// Inputs of the process: 0 or 1, 0 or 1, log2(grains_per_tyre), wheel_rolling, 0 or 1.
  std::vector<double> inputs() const;
};

/// What trials say of themselves that are learned together with others.
struct TrialSource {
  std::string where;    // names the trials
  std::string vehicle;  // the whole one: "hmmwv" of hmmwv and of hmmwv_quarter
  double gravity = 0;   // [m/s^2]
  Fidelity fidelity;
};

/// Throws InputError where the dataset does not hold its vehicle and soil table.
TrialSource source_of(const campaign::Provenance& provenance, const std::string& where);

struct OtherDataset {
  std::string hash;        // of the file
  std::size_t trials = 0;  // valid ones
  std::string fidelity;    // Fidelity::text()
};

struct OtherTrials {
  learning::TrainingTable table;  // [rows x (variables, then Fidelity::inputs())]; no rows: there are no other trials
  std::vector<double> own;        // Fidelity::inputs() of the model's own trials
  std::vector<OtherDataset> datasets;
  /// Of a family's wheels, where one of the datasets has them.
  std::shared_ptr<const ComposedVehicle> composed{};
  std::shared_ptr<const Forecast> forecast{};        // nothing: none
  std::shared_ptr<const SpeedShare> family_speed{};  // of the family's trials; nothing: they are not known

  bool empty() const { return table.row_count() == 0; }
  /// Trials of all datasets, and those behind the forecast.
  std::size_t count() const;
  /// What a process learns from: these rows of the model's own trials and all others. `rows` alone without others.
  learning::TrainingTable joined(const learning::TrainingTable& rows) const;
  /// The same without trials at the points of these rows of the own trials: what a process may know that is judged by
  /// them. The same point at another fidelity tells most of the outcome.
  OtherTrials away_from(const learning::TrainingTable& rows) const;
  /// The points at the own fidelity, as the process takes them. points: [point count x variables]
  std::vector<double> at_own(const std::vector<double>& points, std::size_t variables) const;
};

/// Valid trials of other datasets than the own one, which `where` names. Those of the wheels of a family make
/// `composed`. Trials of the own fidelity teach, too: those of another design, say. Throws InputError where they cannot
/// be learned together: another vehicle or another gravity, or a file given twice. A quarter of a vehicle is named as
/// it, with "_quarter" after.
OtherTrials read_other_trials(const campaign::Provenance& own, const std::string& where,
                              const std::vector<std::filesystem::path>& others);

/// Starts from the forecast, and from the speeds of the trials behind it.
void add_forecast(OtherTrials& known, std::shared_ptr<const Forecast> forecast);

/// The same files, the finest first; those of one fidelity stay in their order.
std::vector<std::filesystem::path> finest_first(std::vector<std::filesystem::path> datasets);

/// Points that a teacher labels: `count` of a scrambled Sobol' sequence over the sampled box [point x variable].
std::vector<double> taught_points(const std::vector<double>& lower, const std::vector<double>& upper, std::size_t count,
                                  std::uint64_t seed);

class Teacher {
 public:
  /// Learns these rows of the model's own trials and all others. The second process is left out without margins.
  Teacher(const learning::TrainingTable& rows, const OtherTrials& others);
  /// P(go) of points at the own fidelity [point count x variables].
  std::vector<double> operator()(const std::vector<double>& points) const;

 private:
  /// The second process.
  struct Graded {
    SpeedShare share;                     // r
    learning::LogisticModel passes;       // a + b r, or what it adds to a forecast
    learning::GaussianProcessModel rest;  // around it
  };

  /// Points at the own fidelity as the processes take them.
  std::vector<double> seen(const std::vector<double>& points) const;
  /// Mean of the first process at points [x variables]; empty without a forecast.
  std::vector<double> mean(const std::vector<double>& points) const;
  /// Mean of the second process. shares: r of every point
  std::vector<double> graded_mean(const learning::LogisticModel& passes, const std::vector<double>& points,
                                  const std::vector<double>& shares) const;
  learning::LogisticModel passes_by_share(const learning::TrainingTable& rows, const std::vector<int>& label,
                                          const std::vector<double>& points, const std::vector<double>& shares) const;

  std::size_t variables_;
  OtherTrials fidelity_;                               // of the own trials, without rows
  std::optional<learning::LogisticModel> correction_;  // c + w.x beside a forecast
  learning::GaussianProcessModel plain_;
  std::optional<Graded> graded_;
};

/// P(go) by a process that sees which trials pass and the variables as they are, at its posterior mean: a baseline.
std::vector<double> process_baseline(const learning::TrainingTable& rows, const OtherTrials& others,
                                     const std::vector<double>& points);

/// How much a teacher counts: t and r of learning::Teaching.
struct TeacherShare {
  double weight = 0, joint_share = 0;
};
/// The weight that the study gives, or 10. The taught points share in the joint distribution as they weigh beside the
/// trials, r = t / (1 + t), if that distribution is the box's: the machine is one of code words, and trials count by
/// prior / proposal density.
TeacherShare teacher_share(const LearningSettings& settings);

/// probability: P(go) of the points.
std::shared_ptr<const learning::Teaching> teaching(TeacherShare share, std::vector<double> points,
                                                   std::vector<double> probability);

/// The teaching of a machine for all rows of `table`, whose weights the process takes too, at these points; none for
/// weight 0.
std::shared_ptr<const learning::Teaching> teach_all(const learning::TrainingTable& table, const OtherTrials& others,
                                                    std::vector<double> points, TeacherShare share);

}  // namespace gonogo::outcome
