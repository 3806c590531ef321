#include "learning/model/posterior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "learning/model/posterior_parts.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kMaxHidden = 1024;  // hidden units whose fields fit on the stack

}  // namespace

Posterior::Posterior(const VisibleLayout& layout, const RbmWeights& weights, const InputPrior& prior)
    : hidden_bias_(weights.hidden_bias) {
  const std::size_t hidden = weights.hidden_count;
  if (weights.visible_count != layout.unit_count())
    throw InputError("model: " + std::to_string(weights.visible_count) + " visible units where its layout has " +
                     std::to_string(layout.unit_count()));
  if (hidden > kMaxHidden) throw InputError("model: more than 1024 hidden units");
  for (std::size_t v = 0; v < layout.variable_count(); ++v) {
    const Encoder& encoder = layout.encoders()[v];
    Nodes nodes;
    nodes.smooth = encoder.categories().empty();
    nodes.unit_count = encoder.unit_count();
    std::vector<Bit> word(encoder.unit_count());
    for (int bin = 0; bin < encoder.bin_count(); ++bin) {
      encoder.encode(bin, word);
      nodes.middle.push_back(encoder.value(bin));
      nodes.half.push_back(nodes.smooth ? encoder.resolution(bin) : 0);
      nodes.bias.push_back(0);
      nodes.field.resize(nodes.field.size() + hidden, 0.0);
      double* field = nodes.field.data() + std::size_t(bin) * hidden;
      for (std::size_t k = 0; k < word.size(); ++k) {
        if (!word[k]) continue;
        const std::size_t i = layout.offset(v) + k;
        nodes.bias.back() += weights.visible_bias[i];
        for (std::size_t j = 0; j < hidden; ++j) field[j] += weights.weight[i * hidden + j];
      }
    }
    for (const double field : nodes.field) nodes.inverse.push_back(std::exp(-field));
    nodes_.push_back(std::move(nodes));
  }
  const std::size_t first = layout.input_unit_count();
  outcome_bias_.assign(weights.visible_bias.begin() + std::ptrdiff_t(first), weights.visible_bias.end());
  outcome_weight_.assign(weights.weight.begin() + std::ptrdiff_t(first * hidden), weights.weight.end());
  for (double u : outcome_weight_) {
    outcome_factor_.push_back(std::exp(u));
    largest_outcome_weight_ = std::max(largest_outcome_weight_, u);
  }
  if (!prior.empty()) take_prior(prior);
  prepare_products();
}

InputPrior uniform_prior(const VisibleLayout& layout) {
  InputPrior prior;
  for (const Encoder& encoder : layout.encoders()) {
    const std::size_t bins = std::size_t(encoder.bin_count());
    prior.emplace_back(bins, 1 / double(bins));
    if (bins == 1 || !encoder.categories().empty()) continue;
    for (std::size_t bin = 0; bin < bins; ++bin)
      prior.back()[bin] = 2 * encoder.resolution(int(bin)) / (encoder.upper() - encoder.lower());
  }
  return prior;
}

void Posterior::take_prior(const InputPrior& prior) {
  if (prior.size() != nodes_.size())
    throw InputError("model: a prior for " + std::to_string(prior.size()) + " variables where its layout has " +
                     std::to_string(nodes_.size()));
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    double sum = 0;
    for (double p : prior[v]) sum += p >= 0 ? p : NAN;
    if (prior[v].size() != nodes_[v].bias.size() || !(std::abs(sum - 1) < 1e-9))
      throw InputError("model: the prior of variable " + std::to_string(v) + " must hold " +
                       std::to_string(nodes_[v].bias.size()) + " probabilities that sum to 1");
    for (std::size_t bin = 0; bin < prior[v].size(); ++bin) nodes_[v].bias[bin] = std::log(prior[v][bin]);
  }
  has_prior_ = true;
}

void Posterior::add_field(const Nodes& nodes, double x, std::span<double> field) const {
  const std::size_t hidden = field.size(), last = nodes.middle.size() - 1;
  if (nodes.unit_count == 0) return;
  if (!nodes.smooth) {
    const auto bin = std::size_t(std::clamp(std::floor(x + 0.5), 0.0, double(last)));
    for (std::size_t j = 0; j < hidden; ++j) field[j] += nodes.field[bin * hidden + j];
    return;
  }
  std::size_t left = 0;
  while (left + 1 < last && x >= nodes.middle[left + 1]) ++left;
  const double share = std::clamp((x - nodes.middle[left]) / (nodes.middle[left + 1] - nodes.middle[left]), 0.0, 1.0);
  const double* a = nodes.field.data() + left * hidden;
  for (std::size_t j = 0; j < hidden; ++j) field[j] += a[j] + share * (a[j + hidden] - a[j]);
}

void Posterior::scores(std::span<const double> field, std::span<double> result) const {
  const std::size_t hidden = field.size();
  const double highest = *std::max_element(field.begin(), field.end());
  if (highest + largest_outcome_weight_ > 40) {  // the products below could overflow
    for (std::size_t y = 0; y < result.size(); ++y) {
      result[y] = outcome_bias_[y];
      for (std::size_t j = 0; j < hidden; ++j) result[y] += softplus(field[j] + outcome_weight_[y * hidden + j]);
    }
    return;
  }
  // One exponential per hidden unit: sum_j log(1 + e^(f_j + U_yj)) = log prod_j (1 + e^f_j e^U_yj), in products of 16
  // factors, each at most e^41.
  std::array<double, kMaxHidden> power;
  for (std::size_t j = 0; j < hidden; ++j) power[j] = std::exp(field[j]);
  for (std::size_t y = 0; y < result.size(); ++y) {
    const double* factor = outcome_factor_.data() + y * hidden;
    double sum = outcome_bias_[y];
    for (std::size_t begin = 0; begin < hidden; begin += 16) {
      double product = 1;
      for (std::size_t j = begin; j < std::min(hidden, begin + 16); ++j) product *= 1 + power[j] * factor[j];
      sum += std::log(product);
    }
    result[y] = sum;
  }
}

void Posterior::outcome_shares(std::span<const double> field, std::span<double> result) const {
  scores(field, result);
  const double highest = *std::max_element(result.begin(), result.end());
  double sum = 0;
  for (double& x : result) sum += x = std::exp(x - highest);
  for (double& x : result) x /= sum;
}

void Posterior::operator()(std::span<const double> variables, std::span<double> result) const {
  GONOGO_ASSERT(variables.size() == nodes_.size() && result.size() == outcome_count());
  std::array<double, kMaxHidden> storage;
  const std::span<double> field(storage.data(), hidden_bias_.size());
  std::copy(hidden_bias_.begin(), hidden_bias_.end(), field.begin());
  for (std::size_t v = 0; v < nodes_.size(); ++v) add_field(nodes_[v], variables[v], field);
  outcome_shares(field, result);
}

PosteriorAnswer Posterior::marginal(std::span<const double> variables, const MarginalOptions& options) const {
  GONOGO_ASSERT(variables.size() == nodes_.size());
  std::vector<double> field = hidden_bias_;
  std::vector<std::size_t> unknown;
  double terms = 1;
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    if (!std::isnan(variables[v])) {
      add_field(nodes_[v], variables[v], field);
    } else if (nodes_[v].unit_count > 0) {
      unknown.push_back(v);
      terms *= double(nodes_[v].middle.size());
    }
  }
  if (terms <= double(options.max_terms)) {
    // With nothing unknown the bits are those of operator().
    if (auto answer = unknown.empty() ? std::nullopt : sum_products(field, summation(unknown))) return *answer;
    return sum_logarithms(field, unknown);
  }
  return joint(variables, std::nullopt, options).outcome;
}

std::vector<std::size_t> Posterior::bin_counts(const std::vector<std::size_t>& variables) const {
  std::vector<std::size_t> counts;
  for (std::size_t v : variables) counts.push_back(nodes_[v].middle.size());
  return counts;
}

template <class Visit>
void Posterior::visit_combinations(const std::vector<double>& field, const std::vector<std::size_t>& unknown,
                                   Visit&& visit) const {
  const std::size_t hidden = field.size(), depth = unknown.size();
  // Level k: the field and the bias with the first k unknown variables set.
  std::vector<std::vector<double>> partial(depth + 1, field);
  std::vector<double> bias(depth + 1, 0.0);
  for_each_combination(
      bin_counts(unknown),
      [&](std::size_t k, std::size_t bin) {
        const Nodes& nodes = nodes_[unknown[k]];
        const double* add = nodes.field.data() + bin * hidden;
        for (std::size_t j = 0; j < hidden; ++j) partial[k + 1][j] = partial[k][j] + add[j];
        bias[k + 1] = bias[k] + nodes.bias[bin];
      },
      [&] { visit(partial[depth], bias[depth]); });
}

PosteriorAnswer Posterior::sum_logarithms(const std::vector<double>& field,
                                          const std::vector<std::size_t>& unknown) const {
  PosteriorAnswer answer;
  answer.standard_error.assign(outcome_count(), 0.0);
  if (unknown.empty()) {
    answer.probability.resize(outcome_count());
    outcome_shares(field, answer.probability);
    return answer;
  }
  std::vector<double> score(outcome_count()), highest(outcome_count(), -INFINITY), sum(outcome_count(), 0.0);
  if (has_prior_) {
    visit_combinations(field, unknown, [&](const std::vector<double>& combined, double log_prior) {
      const double prior = std::exp(log_prior);
      if (prior == 0) return;
      outcome_shares(combined, score);
      for (std::size_t y = 0; y < score.size(); ++y) sum[y] += prior * score[y];
    });
    answer.probability = sum;
  } else {
    visit_combinations(field, unknown, [&](const std::vector<double>& combined, double bias) {
      scores(combined, score);
      for (std::size_t y = 0; y < score.size(); ++y) {
        const double term = score[y] + bias;
        if (term > highest[y]) {
          sum[y] *= std::exp(highest[y] - term);
          highest[y] = term;
        }
        sum[y] += std::exp(term - highest[y]);
      }
    });
    for (std::size_t y = 0; y < sum.size(); ++y) answer.probability.push_back(highest[y] + std::log(sum[y]));
    normalise_logs(answer.probability);
  }
  return answer;
}

// The sum of Posterior::sum_logarithms in products instead of logarithms: with q_y of OutcomeProducts,
//
//   P(y | known) proportional to sum over combinations of exp(bias + sum_j f_j) q_y   the machine's own distribution
//   P(y | known)               = sum over combinations of prior q_y / sum_y q_y       with a prior for the inputs
//
// No exponential and no logarithm is left inside the sum. Only where no product can leave the range of double;
// elsewhere there is no answer.

namespace {

constexpr std::size_t kMaxInner = 256;  // combinations whose exp(-field) are tabulated

}  // namespace

/// Log of a bin's weight in the sum. Without a prior it holds the first factor of OutcomeProducts.
void Posterior::prepare_products() {
  const std::size_t hidden = hidden_bias_.size();
  for (Nodes& nodes : nodes_) {
    nodes.log_weight = nodes.bias;
    for (std::size_t bin = 0; bin < nodes.bias.size() && !has_prior_; ++bin)
      for (std::size_t j = 0; j < hidden; ++j) nodes.log_weight[bin] += nodes.field[bin * hidden + j];
    const double heaviest = *std::max_element(nodes.log_weight.begin(), nodes.log_weight.end());
    for (double& weight : nodes.log_weight) weight -= heaviest;
  }
  if (outcome_count() == 0) return;
  products_ = OutcomeProducts(outcome_bias_, outcome_weight_);
  single_products_ = SingleProducts(outcome_bias_, outcome_weight_);
}

Posterior::FieldRange Posterior::field_range(std::span<const double> field,
                                             const std::vector<std::size_t>& unknown) const {
  const std::size_t hidden = field.size();
  FieldRange range{{field.begin(), field.end()}, {field.begin(), field.end()}};
  for (std::size_t j = 0; j < hidden; ++j) {
    double size = std::abs(field[j]);
    for (const std::size_t v : unknown) {
      double least = INFINITY, most = -INFINITY;
      for (std::size_t bin = 0; bin < nodes_[v].bias.size(); ++bin) {
        least = std::min(least, nodes_[v].field[bin * hidden + j]);
        most = std::max(most, nodes_[v].field[bin * hidden + j]);
      }
      range.lowest[j] += least;
      range.highest[j] += most;
      size += std::max(std::abs(least), std::abs(most));
    }
    range.size = std::max(range.size, size);
  }
  return range;
}

/// Whether every number of the sum stays in the range of double, by the extreme fields of every hidden unit.
bool Posterior::products_fit(std::span<const double> field, const std::vector<std::size_t>& unknown) const {
  const FieldRange range = field_range(field, unknown);
  if (!(range.size < kMaxLog)) return false;
  double lightest = 0;
  for (const std::size_t v : unknown)
    if (!has_prior_) lightest += *std::min_element(nodes_[v].log_weight.begin(), nodes_[v].log_weight.end());
  return products_.fit(range.lowest, range.highest, kMaxLog + lightest);
}

template <class Real, std::size_t kCount>
Posterior::LaneBlocks<Real> Posterior::lane_blocks(const std::vector<std::size_t>& unknown) const {
  const std::size_t hidden = hidden_bias_.size();
  const std::vector<std::size_t> bins = bin_counts(unknown);
  const std::size_t terms =
      std::accumulate(bins.begin(), bins.end(), std::size_t(1), [](auto a, auto b) { return a * b; });
  LaneBlocks<Real> blocks;
  blocks.count = (terms + kCount - 1) / kCount;
  blocks.inverse.assign(blocks.count * hidden * kCount, Real(1));
  blocks.weight.assign(blocks.count * kCount, Real(0));
  std::vector<double> inverse(hidden);
  for (std::size_t term = 0; term < terms; ++term) {
    inverse.assign(hidden, 1.0);
    double log_weight = 0;
    for (std::size_t k = 0, rest = term; k < unknown.size(); rest /= bins[k++]) {
      const Nodes& nodes = nodes_[unknown[k]];
      log_weight += nodes.log_weight[rest % bins[k]];
      const double* of_bin = nodes.inverse.data() + rest % bins[k] * hidden;
      for (std::size_t j = 0; j < hidden; ++j) inverse[j] *= of_bin[j];
    }
    Real* lane = blocks.inverse.data() + term / kCount * hidden * kCount + term % kCount;
    for (std::size_t j = 0; j < hidden; ++j) lane[j * kCount] = Real(inverse[j]);
    blocks.weight[term] = Real(std::exp(log_weight));
  }
  return blocks;
}

Posterior::Summation Posterior::summation(const std::vector<std::size_t>& unknown) const {
  std::size_t depth = unknown.size(), terms = 1;  // the first `depth` variables are outside the tabulated blocks
  for (const auto bins = bin_counts(unknown); depth > 0 && (terms == 1 || terms * bins[depth - 1] <= kMaxInner);)
    terms *= bins[--depth];
  const auto inside = unknown.begin() + std::ptrdiff_t(depth);
  const std::vector<std::size_t> inner(inside, unknown.end());
  Summation plan{unknown, {unknown.begin(), inside}, lane_blocks<double, kLanes>(inner), {}, {}, {}};
  if (!has_prior_ || single_products_.error_bound() > kGridError) return plan;
  const std::vector<double> nothing(hidden_bias_.size(), 0.0);
  plan.unknown_range = field_range(nothing, unknown);
  const FieldRange range = field_range(nothing, inner);
  for (std::size_t j = 0; j < hidden_bias_.size(); ++j)
    plan.part.push_back(std::max(std::abs(range.lowest[j]), std::abs(range.highest[j])));
  plan.single = lane_blocks<float, SingleProducts::kLanes>(inner);
  return plan;
}

template <class Add>
void Posterior::visit_outer(std::span<const double> field, const Summation& plan, Add&& add) const {
  const std::vector<std::size_t>& outer = plan.outer;
  const std::size_t depth = outer.size(), hidden = field.size();
  // Level k: what the known and the first k unknown variables give.
  std::vector<std::vector<double>> inverse(depth + 1, std::vector<double>(hidden));
  std::vector<double> log_weight(depth + 1, 0.0);
  for (std::size_t j = 0; j < hidden; ++j) inverse[0][j] = std::exp(-field[j]);
  for_each_combination(
      bin_counts(outer),
      [&](std::size_t k, std::size_t bin) {
        const Nodes& nodes = nodes_[outer[k]];
        const double* of_bin = nodes.inverse.data() + bin * hidden;
        for (std::size_t j = 0; j < hidden; ++j) inverse[k + 1][j] = inverse[k][j] * of_bin[j];
        log_weight[k + 1] = log_weight[k] + nodes.log_weight[bin];
      },
      [&] { add(inverse[depth], std::exp(log_weight[depth])); });
}

std::vector<double> Posterior::outcome_products(std::span<const double> field, const Summation& plan) const {
  const LaneBlocks<double>& inner = plan.inner;
  const std::size_t block_size = field.size() * kLanes;
  std::array<double, kLanes> weight;
  OutcomeProducts::Sum sum(products_);
  visit_outer(field, plan, [&](std::span<const double> inverse, double outer_weight) {
    for (std::size_t block = 0; block < inner.count; ++block) {
      for (std::size_t l = 0; l < kLanes; ++l) weight[l] = outer_weight * inner.weight[block * kLanes + l];
      products_.add(inverse, std::span(inner.inverse).subspan(block * block_size, block_size), weight, has_prior_, sum);
    }
  });
  std::vector<double> result(outcome_count(), 0.0);
  for (std::size_t i = 0; i < result.size() * kLanes; ++i) result[i / kLanes] += sum.weighted[i];
  return result;
}

std::optional<std::vector<double>> Posterior::single_products(std::span<const double> field,
                                                              const Summation& plan) const {
  FieldRange range = plan.unknown_range;
  for (std::size_t j = 0; j < field.size(); ++j) {
    if (!(range.size + std::abs(field[j]) < kMaxLog)) return std::nullopt;
    range.lowest[j] += field[j];
    range.highest[j] += field[j];
  }
  const auto scaled = single_products_.scaled(range.lowest, range.highest, plan.part);
  if (!scaled) return std::nullopt;
  constexpr std::size_t kCount = SingleProducts::kLanes, kMost = SingleProducts::kMostBlocks;
  const LaneBlocks<float>& inner = *plan.single;
  const std::size_t hidden = field.size(), block_size = hidden * kCount;
  std::vector<double> sum(single_products_.apart_count(), 0.0);
  std::vector<float> common(hidden);
  visit_outer(field, plan, [&](std::span<const double> inverse, double weight) {
    for (std::size_t j = 0; j < hidden; ++j) common[j] = float(inverse[j] * scaled->over_middle[j]);
    for (std::size_t first = 0; first < inner.count; first += kMost) {
      const std::size_t blocks = std::min(kMost, inner.count - first);
      single_products_.add(*scaled, common, std::span(inner.inverse).subspan(first * block_size, blocks * block_size),
                           std::span(inner.weight).subspan(first * kCount, blocks * kCount), weight, sum);
    }
  });
  const double total = std::accumulate(sum.begin(), sum.end(), 0.0);
  if (single_products_.alike_error(sum) > total * kGridError / 10) return std::nullopt;
  return single_products_.all_outcomes(sum);
}

std::optional<PosteriorAnswer> Posterior::sum_products(std::span<const double> field, const Summation& plan,
                                                       Precision precision) const {
  std::optional<std::vector<double>> sums;
  if (precision == Precision::single && plan.single) sums = single_products(field, plan);
  if (!sums && !products_fit(field, plan.unknown)) return std::nullopt;
  PosteriorAnswer answer;
  answer.probability = sums ? std::move(*sums) : outcome_products(field, plan);
  const double total = std::accumulate(answer.probability.begin(), answer.probability.end(), 0.0);
  for (double& p : answer.probability) p /= total;
  answer.standard_error.assign(outcome_count(), 0.0);
  return answer;
}

}  // namespace gonogo::learning
