#include "pipeline/learn/training/teacher.h"

#include <algorithm>

#include "learning/rbm/gaussian_process.h"
#include "pipeline/campaign/design/sobol.h"

namespace gonogo::learn {
namespace {

std::vector<double> points_of(const std::vector<double>& lower, const std::vector<double>& upper, std::uint64_t seed) {
  std::vector<double> points;
  for (std::uint32_t k = 0; k < kTaughtPoints; ++k)
    for (std::size_t v = 0; v < lower.size(); ++v)
      points.push_back(lower[v] + (upper[v] - lower[v]) * campaign::scrambled_sobol(k, seed, int(v)));
  return points;
}

learning::GaussianProcessModel process_of(const learning::TrainingTable& rows, const OtherTrials& others) {
  const learning::TrainingTable table = others.joined(rows);
  return learning::fit_gaussian_process(table, passable_labels(table));
}

std::shared_ptr<const learning::Teaching> taught(double weight, std::vector<double> points,
                                                 std::vector<double> probability) {
  return std::make_shared<const learning::Teaching>(learning::Teaching{.weight = weight,
                                                                       .points = std::move(points),
                                                                       .probability = std::move(probability),
                                                                       .label = passable_outcomes()});
}

}  // namespace

double teacher_weight(std::size_t trials) {
  constexpr std::size_t kFew = 500;
  return trials < kFew ? 3 : 1;
}

Teacher::Teacher(const TrainingData& data, const OtherTrials& others, double weight,
                 const std::vector<std::size_t>& fold, std::uint64_t seed, const KeptWork& kept)
    : data_(data),
      others_(others),
      weight_(weight),
      fold_(fold),
      kept_(kept),
      points_(points_of(data.lower, data.upper, seed)) {}

const ProcessAnswers& Teacher::answers(std::size_t fold) {
  if (const auto found = answers_.find(fold); found != answers_.end()) return found->second;
  if (std::optional<ProcessAnswers> kept = kept_.process(fold))
    return answers_.emplace(fold, std::move(*kept)).first->second;
  std::vector<std::size_t> training, held_out;
  for (std::size_t n = 0; n < fold_.size(); ++n) (fold_[n] == fold ? held_out : training).push_back(n);
  const std::size_t variables = data_.table.variable_count;
  const learning::TrainingTable unseen = data_.table.subset(held_out);
  const learning::GaussianProcessModel process = process_of(data_.table.subset(training), others_.away_from(unseen));
  ProcessAnswers fresh{process.probabilities(others_.at_own(unseen.variables, variables)),
                       weight_ > 0 ? process.most_probable(others_.at_own(points_, variables)) : std::vector<double>()};
  kept_.keep_process(fold, fresh);
  return answers_.emplace(fold, std::move(fresh)).first->second;
}

std::shared_ptr<const learning::Teaching> Teacher::of_fold(std::size_t fold) {
  return weight_ > 0 ? taught(weight_, points_, answers(fold).taught) : nullptr;
}

std::shared_ptr<const learning::Teaching> Teacher::of_all() {
  return weight_ > 0
             ? taught(
                   weight_, points_,
                   process_of(data_.table, others_).most_probable(others_.at_own(points_, data_.table.variable_count)))
             : nullptr;
}

std::vector<double> Teacher::held_out() {
  std::vector<std::size_t> next(*std::max_element(fold_.begin(), fold_.end()) + 1, 0);
  std::vector<double> result;
  for (std::size_t f : fold_) result.push_back(answers(f).held_out[next[f]++]);
  return result;
}

std::shared_ptr<const learning::Teaching> teach_all(const learning::TrainingTable& table, const OtherTrials& others,
                                                    const std::vector<double>& lower, const std::vector<double>& upper,
                                                    double weight, std::uint64_t seed) {
  if (weight == 0) return nullptr;
  std::vector<double> points = points_of(lower, upper, seed);
  std::vector<double> probability =
      process_of(table, others).most_probable(others.at_own(points, table.variable_count));
  return taught(weight, std::move(points), std::move(probability));
}

}  // namespace gonogo::learn
