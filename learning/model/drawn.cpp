// Distributions of unknown variables with more combinations than can be summed, where a prior says what they may be:
// independent draws from the prior, weighted by P(outcome | variables) where the outcome is known.
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "learning/model/question.h"

namespace gonogo::learning {

/// Sums over the draws of one group: of weights, and of weights times what is asked for.
struct Posterior::DrawnSums {
  double weight = 0;
  std::vector<std::vector<double>> bins;  // [unknown variable][bin]
  std::vector<double> outcome;            // [outcome count]
};

namespace {

/// Ratio of sums over groups, and its standard error by the scatter between groups (linearised).
void ratio(const std::vector<double>& part, const std::vector<double>& weight, double& estimate, double& error) {
  const double groups = double(part.size());
  double sum = 0, total = 0, square = 0;
  for (std::size_t g = 0; g < part.size(); ++g) {
    sum += part[g];
    total += weight[g];
  }
  estimate = sum / total;
  for (std::size_t g = 0; g < part.size(); ++g) {
    const double d = (part[g] - estimate * weight[g]) * groups / total;
    square += d * d;
  }
  error = std::sqrt(square / (groups * (groups - 1)));
}

}  // namespace

/// Draws of group `g`, added to its sums. `prior`: [unknown variable][bin].
void Posterior::draw_group(const Question& asked, const std::vector<std::vector<double>>& prior,
                           const MarginalOptions& options, std::size_t g, DrawnSums& sums) const {
  const std::size_t hidden = asked.field.size(), depth = asked.unknown.size(), outcomes = outcome_count();
  std::vector<std::size_t> bin(depth);
  const bool in_products = products_fit(asked.field, asked.unknown);
  std::vector<double> known = asked.field, drawn, p(in_products ? padded_outcomes() : outcomes);
  if (in_products)
    for (double& x : known) x = std::exp(x);
  for (std::size_t d = 0; d < options.sweeps; ++d) {
    drawn = known;
    for (std::size_t k = 0; k < depth; ++k) {
      bin[k] = draw(prior[k], random_unit(options.seed, g, d * depth + k));
      const Nodes& nodes = nodes_[asked.unknown[k]];
      const double* of_bin = (in_products ? nodes.factor : nodes.field).data() + bin[k] * hidden;
      for (std::size_t j = 0; j < hidden; ++j) drawn[j] = in_products ? drawn[j] * of_bin[j] : drawn[j] + of_bin[j];
    }
    if (in_products)
      shares_of_products(drawn, p);
    else
      outcome_shares(drawn, p);
    const double weight = asked.outcome ? p[*asked.outcome] : 1;
    sums.weight += weight;
    for (std::size_t k = 0; k < depth; ++k) sums.bins[k][bin[k]] += weight;
    for (std::size_t y = 0; y < outcomes; ++y) sums.outcome[y] += p[y];
  }
}

JointAnswer Posterior::joint_drawn(const Question& asked, const MarginalOptions& options) const {
  GONOGO_ASSERT(options.chains >= 2);
  const std::size_t depth = asked.unknown.size(), outcomes = outcome_count();
  std::vector<std::vector<double>> prior;
  DrawnSums nothing{0, {}, std::vector<double>(outcomes, 0.0)};
  for (std::size_t v : asked.unknown) {
    prior.emplace_back();
    for (double log_p : nodes_[v].bias) prior.back().push_back(std::exp(log_p));
    nothing.bins.emplace_back(prior.back().size(), 0.0);
  }
  std::vector<DrawnSums> group(options.chains, nothing);
#pragma omp parallel for schedule(static)
  for (std::size_t g = 0; g < group.size(); ++g) draw_group(asked, prior, options, g, group[g]);
  std::vector<double> part(group.size()), weight;
  double total = 0;
  for (const DrawnSums& sums : group) {
    weight.push_back(sums.weight);
    total += sums.weight;
  }
  if (!(total > 0))
    throw InputError("model: none of " + std::to_string(options.chains * options.sweeps) +
                     " points drawn from the prior makes outcome " + std::to_string(asked.outcome.value_or(0)) +
                     " possible; give more variables");
  const auto summary = [&](auto&& value, std::vector<double>& probability, std::vector<double>& error) {
    for (std::size_t g = 0; g < group.size(); ++g) part[g] = value(group[g]);
    ratio(part, weight, probability.emplace_back(), error.emplace_back());
  };
  JointAnswer answer;
  answer.exact = answer.outcome.exact = false;
  answer.variables.resize(nodes_.size());
  for (std::size_t k = 0; k < depth; ++k) {
    UnknownVariable& variable = answer.variables[asked.unknown[k]];
    for (std::size_t bin = 0; bin < prior[k].size(); ++bin)
      summary([&](const DrawnSums& sums) { return sums.bins[k][bin]; }, variable.probability, variable.standard_error);
  }
  for (std::size_t y = 0; y < outcomes && !asked.outcome; ++y)
    summary([&](const DrawnSums& sums) { return sums.outcome[y]; }, answer.outcome.probability,
            answer.outcome.standard_error);
  if (asked.outcome) {
    answer.outcome.probability.assign(outcomes, 0.0);
    answer.outcome.probability[*asked.outcome] = 1;
    answer.outcome.standard_error.assign(outcomes, 0.0);
  }
  return finish(asked, std::move(answer));
}

}  // namespace gonogo::learning
