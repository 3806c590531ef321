// The teacher of a machine: a Gaussian process fitted to the same trials says P(go) at points without a trial, at its
// most probable latent function (learning/rbm/teaching.h). In cross-validation every fold has a teacher that has not
// seen it, and that process's forecasts of the fold's trials score it as a baseline.
#pragma once
#include <map>
#include <memory>
#include <vector>

#include "learning/rbm/teaching.h"
#include "pipeline/learn/training/kept_work.h"
#include "pipeline/learn/training/other_fidelity.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {

/// Weight of the teacher's term for so many trials, where the study gives none.
double teacher_weight(std::size_t trials);

/// Number of points that a teacher labels: a scrambled Sobol' sequence over the sampled box.
inline constexpr std::size_t kTaughtPoints = 2048;

class Teacher {
 public:
  /// `weight` 0: nothing is taught. `kept`, `data` and `others` must outlive the teacher.
  Teacher(const TrainingData& data, const OtherTrials& others, double weight, const std::vector<std::size_t>& fold,
          std::uint64_t seed, const KeptWork& kept);
  /// What the machine of a fold is taught; none without a weight. Fitted at the first call.
  std::shared_ptr<const learning::Teaching> of_fold(std::size_t fold);
  /// What the machine of all trials is taught.
  std::shared_ptr<const learning::Teaching> of_all();
  /// P(go) of every trial by the process that has not seen the trial's fold [row].
  std::vector<double> held_out();

 private:
  const ProcessAnswers& answers(std::size_t fold);

  const TrainingData& data_;
  const OtherTrials& others_;
  double weight_;
  std::vector<std::size_t> fold_;
  const KeptWork& kept_;
  std::vector<double> points_;
  std::map<std::size_t, ProcessAnswers> answers_;
};

/// The teaching of a machine for all rows of `table`, whose weights the process takes too; none for weight 0. lower,
/// upper: the sampled box.
std::shared_ptr<const learning::Teaching> teach_all(const learning::TrainingTable& table, const OtherTrials& others,
                                                    const std::vector<double>& lower, const std::vector<double>& upper,
                                                    double weight, std::uint64_t seed);

}  // namespace gonogo::learn
