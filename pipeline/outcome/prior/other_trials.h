// What is known besides the trials of a model: those of other fidelities or designs, wheels of its family, and the
// forecast of its family's model.
//
// Where few trials are of the finest fidelity, a teacher also learns those of other fidelities (training/teacher.h). It
// takes fidelity as inputs beside the variables and answers at the finest; the machine's own rows are the finest trials
// alone. One kernel over points and fidelities is the simplest model of Kennedy & O'Hagan, "Predicting the output from
// a complex computer code when fast approximations are available", Biometrika 87:1 (2000). Other trials of the same
// fidelity, of another design, are as good as own ones to it.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "learning/training.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/prior/composed.h"
#include "pipeline/outcome/prior/forecast.h"
#include "pipeline/outcome/prior/speed_share.h"

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
  /// The same without trials near these rows of the own trials: what a process may know that is judged by them. The
  /// same point at another fidelity tells most of the outcome. Near: in every variable within a twentieth of these
  /// trials' span.
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

}  // namespace gonogo::outcome
