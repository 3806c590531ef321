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
// Both also learn trials of other fidelities and designs, where there are some (prior/other_trials.h).
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
#include <vector>

#include "base/hdf5/hdf5.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "learning/rbm/words/teaching.h"
#include "learning/training.h"
#include "pipeline/outcome/prior/other_trials.h"
#include "pipeline/outcome/prior/speed_share.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {

/// Whether a box of variables samples numbers of a family's vehicles.
bool samples_vehicles(const std::vector<double>& lower, const std::vector<double>& upper);

/// Points that a teacher labels.
struct TaughtPoints {
  std::vector<double> values;   // [point x variable]
  std::size_t joint_every = 1;  // learning::Teaching::joint_every
};

/// `count` points of a scrambled Sobol' sequence over the sampled box. Beside other trials of a family, of its own
/// fidelity, every second one has the numbers of a vehicle of theirs, within a fortieth of the box. Where those are of
/// real vehicles, a machine that cannot follow its teacher everywhere follows it there.
TaughtPoints taught_points(const std::vector<double>& lower, const std::vector<double>& upper, std::size_t count,
                           std::uint64_t seed, const OtherTrials& others);

inline constexpr const char* kTeacherGroup = "teacher";

class Teacher {
 public:
  /// Learns these rows of the model's own trials and all others. The second process is left out without margins.
  Teacher(const learning::TrainingTable& rows, const OtherTrials& others);
  /// P(go) of points at the own fidelity [point count x variables].
  std::vector<double> operator()(const std::vector<double>& points) const;
  /// The same on all threads. The bits do not depend on their number.
  std::vector<double> of_many(const std::vector<double>& points) const;

  /// As the group kTeacherGroup of a file, and from there, with the same answers. One that started from a forecast
  /// cannot be written. Throws InputError for a file without that group, or with a damaged one.
  void write(Hdf5Writer& out) const;
  static Teacher read(const std::filesystem::path& file);

 private:
  Teacher() = default;

  /// The second process.
  struct Graded {
    SpeedShare share;                     // r
    learning::LogisticModel passes;       // a + b r, or what it adds to a forecast
    learning::GaussianProcessModel rest;  // around it
  };

  /// Mean of the first process at points [x variables], by the family's log odds there; empty without a forecast.
  std::vector<double> mean(const std::vector<double>& points, const std::vector<double>& family_odds) const;
  /// What the logistic model of the second mean sees: r, after the variables and the size across beside a forecast.
  std::vector<double> with_share(const std::vector<double>& points, const std::vector<double>& shares) const;

  std::size_t variables_ = 0;
  OtherTrials known_;                                  // of the own trials, without rows
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
std::shared_ptr<const learning::Teaching> teaching(TeacherShare share, TaughtPoints points,
                                                   std::vector<double> probability);

}  // namespace gonogo::outcome
