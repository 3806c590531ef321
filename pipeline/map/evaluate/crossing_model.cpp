#include "pipeline/map/evaluate/crossing_model.h"

#include <algorithm>

#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::map {
namespace {

using Probabilities = std::function<void(std::span<const double> points, std::span<double> result)>;

double p_go_of(std::span<const double> outcome) {
  double sum = 0;
  for (std::size_t o = 0; o < outcome.size(); ++o)
    if (campaign::passes(campaign::contract().outcomes[o].verdict)) sum += outcome[o];
  return sum;
}

/// The point without its obstacles: what the soil's model was trained on.
std::vector<double> ground_of(std::span<const double> point) {
  std::vector<double> ground(point.begin(), point.end());
  for (std::size_t v = 0; v < ground.size(); ++v)
    if (campaign::is_task_variable(campaign::contract().variables[v])) ground[v] = 0;
  return ground;
}

/// Takes over the crossing's answer where it is the lower one.
void take_lower(std::span<double> result, std::span<const double> crossing) {
  const double p = p_go_of(crossing);
  if (!(p < p_go_of(result))) return;
  const auto& outcomes = campaign::contract().outcomes;
  for (std::size_t o = 0; o < outcomes.size(); ++o) result[o] = campaign::passes(outcomes[o].verdict) ? crossing[o] : 0;
  result[campaign::contract().outcome_index(campaign::Verdict::no_go, campaign::Reason::obstacle)] = 1 - p;
}

Probabilities with_crossing(const Probabilities& soil, const Probabilities& crossing, double least_bed) {
  return [soil, crossing, least_bed](std::span<const double> points, std::span<double> result) {
    const std::size_t width = campaign::contract().variables.size(), outcomes = campaign::contract().outcomes.size();
    const std::size_t bed = campaign::contract().variable_index("bed_depth");
    std::vector<double> ground, ditches;
    std::vector<std::size_t> with_ditch;
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const auto point = points.subspan(i * width, width);
      const std::vector<double> alone = ground_of(point);
      ground.insert(ground.end(), alone.begin(), alone.end());
      if (!campaign::has_task_values(point)) continue;
      with_ditch.push_back(i);
      ditches.insert(ditches.end(), point.begin(), point.end());
      double& depth = ditches[ditches.size() - width + bed];
      if (depth < least_bed) depth = least_bed;
    }
    soil(ground, result);
    if (with_ditch.empty()) return;
    std::vector<double> answer(with_ditch.size() * outcomes);
    crossing(ditches, answer);
    for (std::size_t k = 0; k < with_ditch.size(); ++k)
      take_lower(result.subspan(with_ditch[k] * outcomes, outcomes),
                 std::span<const double>(answer).subspan(k * outcomes, outcomes));
  };
}

/// What both have sampled; a task's variables are the crossing's, a shallower bed counts as the crossing's.
std::vector<Range> common_box(const OutcomeModel& model, const OutcomeModel& crossing) {
  std::vector<Range> box = crossing.sampled;
  for (std::size_t v = 0; v < box.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable)) continue;
    box[v].maximum = std::min(box[v].maximum, model.sampled[v].maximum);
    box[v].minimum =
        variable.name == "bed_depth" ? model.sampled[v].minimum : std::max(box[v].minimum, model.sampled[v].minimum);
  }
  return box;
}

}  // namespace

void add_crossing_model(OutcomeModel& model, const OutcomeModel& crossing) {
  const double least_bed = crossing.sampled[campaign::contract().variable_index("bed_depth")].minimum;
  model.crossing_sampled = common_box(model, crossing);
  model.crossing_hash = crossing.hash;
  model.probabilities = with_crossing(model.probabilities, crossing.probabilities, least_bed);
  for (Probabilities& member : model.members) member = with_crossing(member, crossing.probabilities, least_bed);
  if (!model.novelty || !crossing.novelty) return;
  model.novelty = [soil = model.novelty, ditch = crossing.novelty](std::span<const double> point) {
    const double ground = soil(ground_of(point));
    return campaign::has_task_values(point) ? std::max(ground, ditch(point)) : ground;
  };
}

}  // namespace gonogo::map
