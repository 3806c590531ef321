// Distributions of all unknown variables at once.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "learning/model/posterior_parts.h"

namespace gonogo::learning {

Posterior::Question Posterior::question(std::span<const double> variables, std::optional<std::size_t> outcome) const {
  GONOGO_ASSERT(variables.size() == nodes_.size());
  Question asked{hidden_bias_, {}, outcome, 1};
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    if (!std::isnan(variables[v])) {
      add_field(nodes_[v], variables[v], asked.field);
    } else if (nodes_[v].unit_count > 0) {
      asked.unknown.push_back(v);
      asked.terms *= double(nodes_[v].middle.size());
    }
  }
  return asked;
}

namespace {

/// Value below which `share` of the probability lies. half: half widths of the bins, over which it is spread evenly.
double quantile(std::span<const double> middle, std::span<const double> half, std::span<const double> probability,
                double share) {
  double below = 0;
  for (std::size_t bin = 0; bin < middle.size(); ++bin) {
    const double p = probability[bin];
    if (p > 0 && below + p >= share) return middle[bin] + half[bin] * (2 * (share - below) / p - 1);
    below += p;
  }
  return middle.back() + half.back();  // probabilities that sum to a little less than `share`
}

}  // namespace

/// Mean, deviation and quantiles of every unknown variable from its probabilities.
JointAnswer Posterior::finish(const Question& asked, JointAnswer answer) const {
  for (std::size_t v : asked.unknown) {
    UnknownVariable& variable = answer.variables[v];
    const Nodes& nodes = nodes_[v];
    double square = 0;
    for (std::size_t bin = 0; bin < nodes.middle.size(); ++bin) {
      const double p = variable.probability[bin], x = nodes.middle[bin];
      variable.mean += p * x;
      square += p * (x * x + nodes.half[bin] * nodes.half[bin] / 3);
    }
    variable.low = quantile(nodes.middle, nodes.half, variable.probability, 0.05);
    variable.high = quantile(nodes.middle, nodes.half, variable.probability, 0.95);
    variable.deviation = std::sqrt(std::max(0.0, square - variable.mean * variable.mean));
  }
  return answer;
}

JointAnswer Posterior::joint_sum(const Question& asked) const {
  const std::size_t hidden = asked.field.size(), outcomes = outcome_count(), depth = asked.unknown.size();
  std::vector<std::size_t> bin(depth, 0);
  std::vector<double> field(hidden), score(outcomes), log_weight;
  for (std::size_t term = 0; term < std::size_t(asked.terms); ++term) {
    field = asked.field;
    double bias = 0;
    for (std::size_t k = 0, rest = term; k < depth; ++k) {
      const Nodes& nodes = nodes_[asked.unknown[k]];
      const std::size_t b = rest % nodes.middle.size();
      rest /= nodes.middle.size();
      bias += nodes.bias[b];
      for (std::size_t j = 0; j < hidden; ++j) field[j] += nodes.field[b * hidden + j];
    }
    scores(field, score);
    const double total = has_prior_ ? log_sum_exp(score) : 0;  // a prior says how probable the combination is
    for (std::size_t y = 0; y < outcomes; ++y)
      log_weight.push_back(!asked.outcome || *asked.outcome == y ? score[y] - total + bias : -INFINITY);
  }
  normalise_logs(log_weight);
  JointAnswer answer;
  answer.variables.resize(nodes_.size());
  answer.outcome.probability.assign(outcomes, 0.0);
  answer.outcome.standard_error.assign(outcomes, 0.0);
  for (std::size_t v : asked.unknown) {
    answer.variables[v].probability.assign(nodes_[v].middle.size(), 0.0);
    answer.variables[v].standard_error.assign(nodes_[v].middle.size(), 0.0);
  }
  for (std::size_t k = 0; k < log_weight.size(); ++k) {
    answer.outcome.probability[k % outcomes] += log_weight[k];
    for (std::size_t u = 0, rest = k / outcomes; u < depth; ++u) {
      const std::size_t bins = nodes_[asked.unknown[u]].middle.size();
      answer.variables[asked.unknown[u]].probability[rest % bins] += log_weight[k];
      rest /= bins;
    }
  }
  return finish(asked, std::move(answer));
}

/// One chain of replicas at inverse temperatures 0 ... 1 with what is known clamped. A state is the bins of the unknown
/// variables and the outcome; hidden units are summed out in exchanges.
class Posterior::TemperedChain {
 public:
  TemperedChain(const Posterior& posterior, const Question& asked, const MarginalOptions& options, std::size_t chain)
      : posterior_(posterior), asked_(asked), options_(options), chain_(chain), hidden_(asked.field.size()) {
    for (std::size_t r = 0; r < options.rungs; ++r) {
      State state;
      for (std::size_t v : asked.unknown)
        state.bin.push_back(std::size_t(uniform() * double(posterior.nodes_[v].middle.size())));
      state.outcome = asked.outcome ? *asked.outcome : std::size_t(uniform() * double(posterior.outcome_count()));
      states_.push_back(state);
    }
  }

  /// Sweeps all rungs; `top` gets the conditional probabilities of every unknown variable, then of the outcome, given
  /// the hidden units of the last rung: their mean is what the chain estimates.
  void sweep(std::size_t number, std::vector<std::vector<double>>& top) {
    for (std::size_t r = 0; r < states_.size(); ++r) sweep_rung(states_[r], beta(r), top);
    for (std::size_t r = number % 2; r + 1 < states_.size(); r += 2) exchange(r);
  }

 private:
  struct State {
    std::vector<std::size_t> bin;
    std::size_t outcome = 0;
  };
  double uniform() { return random_unit(options_.seed, chain_, counter_++); }
  double beta(std::size_t rung) const { return states_.size() > 1 ? double(rung) / double(states_.size() - 1) : 1.0; }

  std::vector<double> field_of(const State& state) const {
    std::vector<double> field = asked_.field;
    for (std::size_t k = 0; k < state.bin.size(); ++k) {
      const double* add = posterior_.nodes_[asked_.unknown[k]].field.data() + state.bin[k] * hidden_;
      for (std::size_t j = 0; j < hidden_; ++j) field[j] += add[j];
    }
    for (std::size_t j = 0; j < hidden_; ++j) field[j] += posterior_.outcome_weight_[state.outcome * hidden_ + j];
    return field;
  }

  void sweep_rung(State& state, double strength, std::vector<std::vector<double>>& conditional) {
    const std::vector<double> field = field_of(state);
    std::vector<double> h(hidden_);
    for (std::size_t j = 0; j < hidden_; ++j) h[j] = uniform() * (1 + std::exp(-strength * field[j])) < 1;
    const auto draw_from = [&](std::vector<double>& p, std::span<const double> bias, std::span<const double> weight) {
      p.assign(bias.begin(), bias.end());
      for (std::size_t k = 0; k < p.size(); ++k)
        for (std::size_t j = 0; j < hidden_; ++j) p[k] += h[j] * weight[k * hidden_ + j];
      for (double& x : p) x *= strength;
      normalise_logs(p);
      return draw(p, uniform());
    };
    conditional.resize(asked_.unknown.size() + 1);
    for (std::size_t k = 0; k < asked_.unknown.size(); ++k) {
      const Nodes& nodes = posterior_.nodes_[asked_.unknown[k]];
      state.bin[k] = draw_from(conditional[k], nodes.bias, nodes.field);
    }
    if (asked_.outcome) return;
    state.outcome = draw_from(conditional.back(), posterior_.outcome_bias_, posterior_.outcome_weight_);
  }

  double log_weight(const State& state, double strength) const {
    double sum = strength * posterior_.outcome_bias_[state.outcome];
    for (std::size_t k = 0; k < state.bin.size(); ++k)
      sum += strength * posterior_.nodes_[asked_.unknown[k]].bias[state.bin[k]];
    for (double f : field_of(state)) sum += softplus(strength * f);
    return sum;
  }

  void exchange(std::size_t r) {
    const double here = beta(r), above = beta(r + 1);
    const double gain = log_weight(states_[r + 1], here) + log_weight(states_[r], above) -
                        log_weight(states_[r], here) - log_weight(states_[r + 1], above);
    if (uniform() < std::exp(std::min(gain, 0.0))) std::swap(states_[r], states_[r + 1]);
  }

  const Posterior& posterior_;
  const Question& asked_;
  const MarginalOptions& options_;
  std::uint64_t chain_, counter_ = 0;
  std::size_t hidden_;
  std::vector<State> states_;
};

JointAnswer Posterior::joint_sample(const Question& asked, const MarginalOptions& options) const {
  if (options.chains < 2 || options.rungs < 1) throw InputError("posterior: two chains and one rung at least");
  std::vector<std::vector<std::vector<double>>> means(options.chains);  // [chain][unknown, then outcome][bin]
  for_each_on_host(options.chains, 1, [&](std::size_t chain) {
    TemperedChain replicas(*this, asked, options, chain);
    std::vector<std::vector<double>> now;
    for (std::size_t sweep = 0; sweep < options.burn_in + options.sweeps; ++sweep) {
      replicas.sweep(sweep, now);
      if (sweep < options.burn_in) continue;
      if (means[chain].empty())
        for (const auto& p : now) means[chain].emplace_back(p.size(), 0.0);
      for (std::size_t k = 0; k < now.size(); ++k)
        for (std::size_t bin = 0; bin < now[k].size(); ++bin)
          means[chain][k][bin] += now[k][bin] / double(options.sweeps);
    }
  });
  const auto summary = [&](std::size_t k, std::vector<double>& probability, std::vector<double>& error) {
    const double n = double(options.chains);
    for (std::size_t bin = 0; bin < means[0][k].size(); ++bin) {
      double mean = 0, square = 0;
      for (const auto& chain : means) mean += chain[k][bin] / n;
      for (const auto& chain : means) square += (chain[k][bin] - mean) * (chain[k][bin] - mean) / (n - 1);
      probability.push_back(mean);
      error.push_back(std::sqrt(square / n));
    }
  };
  JointAnswer answer;
  answer.exact = answer.outcome.exact = false;
  answer.variables.resize(nodes_.size());
  for (std::size_t k = 0; k < asked.unknown.size(); ++k) {
    UnknownVariable& variable = answer.variables[asked.unknown[k]];
    summary(k, variable.probability, variable.standard_error);
  }
  if (asked.outcome) {
    answer.outcome.probability.assign(outcome_count(), 0.0);
    answer.outcome.probability[*asked.outcome] = 1;
    answer.outcome.standard_error.assign(outcome_count(), 0.0);
  } else {
    summary(asked.unknown.size(), answer.outcome.probability, answer.outcome.standard_error);
  }
  return finish(asked, std::move(answer));
}

JointAnswer Posterior::joint(std::span<const double> variables, std::optional<std::size_t> outcome,
                             const MarginalOptions& options) const {
  if (outcome && *outcome >= outcome_count())
    throw InputError("posterior: outcome " + std::to_string(*outcome) + " does not exist");
  const Question asked = question(variables, outcome);
  if (asked.terms <= double(options.max_terms)) return joint_sum(asked);
  return has_prior_ ? joint_drawn(asked, options) : joint_sample(asked, options);
}

// Distributions of unknown variables with more combinations than can be summed, where a prior says what they may be:
// independent draws from the prior, weighted by P(outcome | variables) where the outcome is known.

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

void Posterior::outcome_shares(const Question& asked, bool in_products, std::span<const std::size_t> bins,
                               std::span<double> result) const {
  const std::size_t hidden = asked.field.size(), depth = asked.unknown.size(), outcomes = outcome_count();
  const std::size_t lanes = result.size() / outcomes;
  std::vector<double> field(hidden), inverse(hidden * kLanes, 1.0), product(products_.padded_outcomes() * kLanes);
  for (std::size_t l = 0; l < lanes; ++l) {
    field = asked.field;
    for (std::size_t k = 0; k < depth; ++k) {
      const double* of_bin = nodes_[asked.unknown[k]].field.data() + bins[l * depth + k] * hidden;
      for (std::size_t j = 0; j < hidden; ++j) field[j] += of_bin[j];
    }
    if (!in_products) outcome_shares(field, result.subspan(l * outcomes, outcomes));
    for (std::size_t j = 0; j < hidden && in_products; ++j) inverse[j * kLanes + l] = std::exp(-field[j]);
  }
  if (!in_products) return;
  products_(inverse, product);
  for (std::size_t l = 0; l < lanes; ++l) {
    double total = 0;
    for (std::size_t y = 0; y < outcomes; ++y) total += product[y * kLanes + l];
    for (std::size_t y = 0; y < outcomes; ++y) result[l * outcomes + y] = product[y * kLanes + l] / total;
  }
}

/// Draws of group `g`, added to its sums. `prior`: [unknown variable][bin].
void Posterior::draw_group(const Question& asked, const std::vector<std::vector<double>>& prior,
                           const MarginalOptions& options, std::size_t g, DrawnSums& sums) const {
  const std::size_t depth = asked.unknown.size(), outcomes = outcome_count();
  const bool in_products = products_fit(asked.field, asked.unknown);
  std::vector<std::size_t> bins(kLanes * depth);
  std::vector<double> shares(kLanes * outcomes);
  for (std::size_t first = 0; first < options.sweeps; first += kLanes) {
    const std::size_t lanes = std::min(kLanes, options.sweeps - first);
    for (std::size_t i = 0; i < lanes * depth; ++i)
      bins[i] = draw(prior[i % depth], random_unit(options.seed, g, first * depth + i));
    outcome_shares(asked, in_products, bins, std::span(shares).first(lanes * outcomes));
    for (std::size_t l = 0; l < lanes; ++l) {
      const std::span<const double> p = std::span(shares).subspan(l * outcomes, outcomes);
      const double weight = asked.outcome ? p[*asked.outcome] : 1;
      sums.weight += weight;
      for (std::size_t k = 0; k < depth; ++k) sums.bins[k][bins[l * depth + k]] += weight;
      for (std::size_t y = 0; y < outcomes; ++y) sums.outcome[y] += p[y];
    }
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
  for_each_on_host(group.size(), 1, [&](std::size_t g) { draw_group(asked, prior, options, g, group[g]); });
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
