#include "tests/learning/gray_box.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/qubits/line_embedding.h"

namespace gonogo::learning {
namespace {

enum GrayBoxStream : std::uint64_t { kFirst = 21, kRows = 22, kGauges = 23, kChains = 24 };

/// Adds a row's products to the moments with weight w.
template <class Spin>
void add_moments(const Problem& problem, Spin spin, double w, std::vector<double>& single, std::vector<double>& pair) {
  for (std::size_t i = 0; i < single.size(); ++i) single[i] += w * spin(i);
  for (std::size_t k = 0; k < pair.size(); ++k)
    pair[k] += w * spin(problem.couplings[k].a) * spin(problem.couplings[k].b);
}

}  // namespace

GrayBox::GrayBox(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible,
                 std::size_t hidden, const GrayBoxSettings& settings)
    : device_(std::move(device)), settings_(settings), visible_(visible), hidden_(hidden) {
  Problem units;  // every pair coupled, so that the embedding keeps all couplers
  units.vartype = Vartype::spin;
  units.linear.assign(visible + hidden, 0.0);
  for (std::size_t v = 0; v < visible + hidden; ++v) units.labels.emplace_back(std::int64_t(v));
  for (std::size_t i = 0; i < visible; ++i)
    for (std::size_t j = 0; j < hidden; ++j)
      units.couplings.push_back(
          {std::uint32_t(i), std::uint32_t(visible + j),
           settings.first_coupling * (2 * random_unit(settings.seed, kFirst, i * hidden + j) - 1)});
  EmbeddedProblem embedded =
      embed_problem(units, graph, embed_biclique(graph, visible, hidden), settings.chain_coupling);
  problem_ = std::move(embedded.problem);
  problem_.offset = 0;
  record_ = std::move(embedded.record);
  std::map<Label, std::uint32_t> owner;
  for (std::size_t v = 0; v < record_.chains.size(); ++v)
    for (std::int64_t q : record_.chains[v]) owner[Label(q)] = std::uint32_t(v);
  for (const Label& label : problem_.labels) variable_.push_back(owner.at(label));
  share_steps();
}

void GrayBox::share_steps() {
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> couplers;
  const auto units_of = [&](const Coupling& c) { return std::minmax(variable_[c.a], variable_[c.b]); };
  for (const Coupling& c : problem_.couplings) ++couplers[units_of(c)];
  for (std::uint32_t unit : variable_) field_.push_back({0, 0, 1 / double(record_.chains[unit].size())});
  for (const Coupling& c : problem_.couplings) {
    const auto [low, high] = units_of(c);
    coupling_.push_back({0, 0, low == high ? 1 : 1 / couplers[{low, high}]});
  }
}

SampleSet GrayBox::device_rows(const Problem& problem, std::size_t reads, std::size_t gauges,
                               std::uint64_t draw) const {
  SampleSet all;
  gauges = std::min(std::max<std::size_t>(gauges, 1), reads);
  for (std::size_t k = 0; k < gauges; ++k) {
    const std::uint64_t seed = random_bits(settings_.seed, kRows, draw);
    const auto gauge = random_gauge(problem.variable_count(), random_bits(seed, kGauges, k));
    const SampleRequest request{.reads = reads * (k + 1) / gauges - reads * k / gauges,
                                .seed = random_bits(seed, kChains, k),
                                .sweeps = settings_.sweeps};
    const SampleSet part = apply_gauge(device_->sample(apply_gauge(problem, gauge), request), gauge);
    if (k == 0) {
      all = part;
      continue;
    }
    all.values.insert(all.values.end(), part.values.begin(), part.values.end());
    all.energies.insert(all.energies.end(), part.energies.begin(), part.energies.end());
    all.occurrences.insert(all.occurrences.end(), part.occurrences.begin(), part.occurrences.end());
  }
  return all;
}

GrayBox::Moments GrayBox::model_moments() const {
  Moments moments{std::vector<double>(problem_.variable_count()), std::vector<double>(problem_.couplings.size())};
  const SampleSet rows = device_rows(problem_, settings_.reads, settings_.gauges, draws_++);
  for (std::size_t r = 0; r < rows.row_count(); ++r)
    add_moments(
        problem_, [&](std::size_t i) { return double(rows.row(r)[i]); }, 1 / double(rows.row_count()), moments.spin,
        moments.pair);
  return moments;
}

GrayBox::Moments GrayBox::data_moments(std::span<const double> rows) const {
  Moments moments{std::vector<double>(problem_.variable_count()), std::vector<double>(problem_.couplings.size())};
  const std::size_t count = rows.size() / visible_;
  std::vector<double> fixed(problem_.variable_count()), spin(fixed.size());
  for (std::size_t r = 0; r < count; ++r) {
    for (std::size_t q = 0; q < fixed.size(); ++q)
      fixed[q] = variable_[q] < visible_ ? 2 * rows[r * visible_ + variable_[q]] - 1 : NAN;
    Problem free = clamp(problem_, fixed);
    // Fields that fixed neighbours add up to may leave the range; the qubit is certain by then.
    for (double& h : free.linear) h = std::clamp(h, settings_.ranges.h_low, settings_.ranges.h_high);
    const SampleSet found = device_rows(free, 1, 1, draws_++);
    std::size_t next = 0;
    for (std::size_t q = 0; q < fixed.size(); ++q)
      spin[q] = std::isnan(fixed[q]) ? double(found.row(0)[next++]) : fixed[q];
    add_moments(
        problem_, [&](std::size_t i) { return spin[i]; }, 1 / double(count), moments.spin, moments.pair);
  }
  return moments;
}

void GrayBox::update(std::span<const double> rows, double share) {
  GONOGO_ASSERT(!rows.empty() && rows.size() % visible_ == 0);
  const Moments data = data_moments(rows), model = model_moments();
  const CoefficientRanges& range = settings_.ranges;
  ++updates_;
  const double rate = share * settings_.rate;
  for (std::size_t i = 0; i < data.spin.size(); ++i)
    problem_.linear[i] = std::clamp(problem_.linear[i] - 2 * rate * step(field_[i], data.spin[i] - model.spin[i]),
                                    range.h_low, range.h_high);
  for (std::size_t k = 0; k < data.pair.size(); ++k) {
    double& value = problem_.couplings[k].value;
    value = std::clamp(value - rate * step(coupling_[k], data.pair[k] - model.pair[k]), range.j_low, range.j_high);
  }
}

double GrayBox::step(Descent& descent, double gradient) const {
  constexpr double kMean = 0.9, kSquare = 0.999, kTiny = 1e-8;
  descent.mean = kMean * descent.mean + (1 - kMean) * gradient;
  descent.square = kSquare * descent.square + (1 - kSquare) * gradient * gradient;
  const double n = double(updates_);
  return descent.part * descent.mean / (1 - std::pow(kMean, n)) /
         (std::sqrt(descent.square / (1 - std::pow(kSquare, n))) + kTiny);
}

Problem GrayBox::contracted_problem() const {
  Problem units;
  units.vartype = Vartype::spin;
  units.linear.assign(visible_ + hidden_, 0.0);
  for (std::size_t v = 0; v < visible_ + hidden_; ++v) units.labels.emplace_back(std::int64_t(v));
  for (std::size_t q = 0; q < variable_.size(); ++q) units.linear[variable_[q]] += problem_.linear[q];
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> between;
  for (const Coupling& c : problem_.couplings) {
    const auto [low, high] = std::minmax(variable_[c.a], variable_[c.b]);
    if (low != high) between[{low, high}] += c.value;
  }
  for (const auto& [pair, value] : between) units.couplings.push_back({pair.first, pair.second, value});
  return units;
}

RbmWeights GrayBox::contracted(double beta) const {
  const Problem qubo = to_qubo(scaled(contracted_problem(), beta));
  RbmWeights machine = RbmWeights::zeros(visible_, hidden_);
  for (std::size_t i = 0; i < visible_; ++i) machine.visible_bias[i] = -qubo.linear[i];
  for (std::size_t j = 0; j < hidden_; ++j) machine.hidden_bias[j] = -qubo.linear[visible_ + j];
  for (const Coupling& c : qubo.couplings) machine.weight[c.a * hidden_ + (c.b - visible_)] = -c.value;
  return machine;
}

BetaEstimate GrayBox::measured_beta(std::size_t reads) const {
  const SampleSet rows = device_rows(problem_, reads, settings_.gauges, draws_++);
  EmbeddingRecord record = record_;
  record.source = contracted_problem();
  return pseudo_likelihood_beta(record.source,
                                unembed(rows, record, BrokenChains::weighted_random, settings_.seed).samples);
}

}  // namespace gonogo::learning
