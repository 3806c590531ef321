#include "pipeline/outcome/training/member_machine.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/math/random.h"
#include "learning/rbm/words/word_training.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/outcome/settings.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::uint64_t kOutcomes = 0x6d656d62;  // stream of random numbers
constexpr std::size_t kPoints = 8192;            // that the teacher labels, each with a drawn row

/// An outcome by its probabilities, if the class that passes has this one.
std::size_t drawn_outcome(std::span<const double> probability, const std::vector<int>& passable, double passes,
                          double unit) {
  double of_class[2] = {0, 0};
  for (std::size_t y = 0; y < passable.size(); ++y) of_class[passable[y]] += probability[y];
  std::size_t last = 0;
  for (std::size_t y = 0; y < passable.size(); ++y) {
    const double share = passable[y] ? passes : 1 - passes;
    const double p = of_class[passable[y]] > 0 ? share * probability[y] / of_class[passable[y]] : 0;
    if (p > 0) last = y;
    if ((unit -= p) < 0) return y;
  }
  return last;  // by rounding
}

/// A row at every point. in_family: these as the family's; passes: P(go) of every point.
TrainingData drawn_rows(const Predictor& family, const FamilyQuestion& question, const std::vector<double>& points,
                        const std::vector<double>& in_family, const std::vector<double>& passes) {
  const std::vector<int> passable = passable_outcomes();
  const std::size_t width = question.lower.size(), outcomes = passable.size();
  std::vector<double> probability(kPoints * outcomes);
  family.outcome_probabilities(in_family, probability);
  TrainingData data;
  data.lower = question.lower;
  data.upper = question.upper;
  data.outcome_count.assign(outcomes, 0);
  data.table.variable_count = width;
  data.table.variables = points;
  data.table.weight.assign(kPoints, 1.0);
  for (std::size_t n = 0; n < kPoints; ++n) {
    const std::size_t y = drawn_outcome(std::span(probability).subspan(n * outcomes, outcomes), passable, passes[n],
                                        random_unit(kSeed, kOutcomes, n));
    data.table.outcome.push_back(y);
    data.table.group.push_back(n);
    ++data.outcome_count[y];
  }
  return data;
}

double shifted(double p, double shift) { return p / (p + (1 - p) * std::exp(-shift)); }

/// What a family's model is shifted by [nat].
double shift_of(const learning::Model& family) {
  const Json* odds = family.provenance.find("vehicle_odds");
  return odds ? odds->at("shift_nat").number() : 0;
}

std::vector<double> shifted_answers(const learning::Model& family, const Teacher& teacher,
                                    const std::vector<double>& in_family) {
  std::vector<double> p = teacher.of_many(in_family);
  if (const double shift = shift_of(family); shift != 0)
    for (double& x : p) x = shifted(x, shift);
  return p;
}

}  // namespace

std::vector<double> member_forecast(const learning::Model& family, const Teacher& teacher,
                                    const FamilyQuestion& question, const std::vector<double>& points) {
  return shifted_answers(family, teacher, question.in_family(points));
}

learning::Model member_machine(const Predictor& family, const Teacher& teacher, const FamilyQuestion& question,
                               MachineUse use) {
  TaughtPoints points = taught_points(question.lower, question.upper, kPoints, kSeed, {});
  const std::vector<double> in_family = question.in_family(points.values),
                            passes = shifted_answers(family.model(), teacher, in_family);
  const TrainingData data = drawn_rows(family, question, points.values, in_family, passes);
  const LearningSettings settings = settings_for_trials({}, kPoints, 0);
  learning::TrainingSettings training = training_settings(settings, kPoints, 0, kSeed);
  training.report_every = training.epochs;  // nobody reads the log
  if (use == MachineUse::answers) training.generative = 0;
  const auto lesson = teaching(teacher_share(settings), std::move(points), passes);
  learning::Model model;
  model.layout = make_layout(data, settings);
  model.weights = learning::train_words(model.layout, data.table, training, {},
                                        learning::initial_weights(model.layout, data.table, training), lesson.get())
                      .weights;
  if (use == MachineUse::samples)
    model.weights = learning::balanced_inputs(model.layout, data.table, std::move(model.weights), kSeed, lesson.get());
  describe_trials(data, settings.uniform_inputs, model);
  model.provenance = family.model().provenance;
  model.provenance["member"] = question.vehicle;
  model.provenance[campaign::kGravityKey] = question.gravity;
  return model;
}

}  // namespace gonogo::outcome
