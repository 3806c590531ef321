#include "learning/annealer/annealer_sampler.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "learning/qubits/line_embedding.h"
#include "learning/sampler/chains/bipartite.h"

namespace gonogo::learning {
namespace {

enum AnnealerStream : std::uint64_t {
  kGauge = 11,
  kDevice = 12,
  kBroken = 13,
  kThermometer = 14,
  kTuning = 31,
  kProbe,
  kFinalRows,
  kPost
};

constexpr double kSecondScale = 0.75;   // of the two scales of a reading
constexpr double kWidestReading = 0.5;  // interval over estimate: less certain ones do not move the scale
constexpr double kMaxChange = 1.5;      // of the scale in one epoch

std::size_t cut_to_ranges(Problem& problem, const CoefficientRanges& ranges) {
  std::size_t cut = 0;
  const auto clip = [&](double& x, double low, double high) {
    const double inside = std::clamp(x, low, high);
    cut += inside != x;
    x = inside;
  };
  for (double& h : problem.linear) clip(h, ranges.h_low, ranges.h_high);
  for (Coupling& c : problem.couplings) clip(c.value, ranges.j_low, ranges.j_high);
  return cut;
}

/// Fields that become the given ones when the device adds chi J h to them.
void take_off_leak(Problem& problem, double chi) {
  const std::vector<double> h = problem.linear;
  for (const Coupling& c : problem.couplings) {
    problem.linear[c.a] -= chi * c.value * h[c.b];
    problem.linear[c.b] -= chi * c.value * h[c.a];
  }
}

void append(SampleSet& all, const SampleSet& part) {
  all.values.insert(all.values.end(), part.values.begin(), part.values.end());
  all.energies.insert(all.energies.end(), part.energies.begin(), part.energies.end());
  all.occurrences.insert(all.occurrences.end(), part.occurrences.begin(), part.occurrences.end());
}

void add_use(const AnnealerUse& use, Json& json) {
  json["scale"] = use.scale;
  json["cut_coefficients"] = Json(std::uint64_t(use.cut_coefficients));
  json["chain_break_fraction"] = use.chain_break_fraction;
}

}  // namespace

AnnealerSampler::AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible,
                                 std::size_t hidden, const AnnealerSettings& settings)
    : AnnealerSampler(std::move(device), graph, embed_two_sides(graph, visible, hidden), visible + hidden, settings) {}

AnnealerSampler::AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, Embedding embedding,
                                 std::size_t variables, const AnnealerSettings& settings)
    : device_(std::move(device)),
      graph_(graph),
      embedding_(std::move(embedding)),
      variables_(variables),
      settings_(settings) {}

double AnnealerSampler::largest_scale(const Problem& problem) const {
  CoefficientRanges ranges = settings_.ranges;
  ranges.j_high = std::min(ranges.j_high, settings_.chain_coupling / 2);
  ranges.j_low = std::max(ranges.j_low, -settings_.chain_coupling / 2);
  return auto_scale_factor(embed_problem(to_ising(problem), graph_, embedding_, 0).problem, ranges);
}

SampleSet AnnealerSampler::sample(const Problem& problem, const SampleRequest& request) const {
  AnnealerUse use;
  SampleSet rows = sample(problem, request, use);
  add_use(use, rows.info);
  return rows;
}

SampleSet AnnealerSampler::sample(const Problem& problem, const SampleRequest& request, AnnealerUse& use) const {
  if (problem.variable_count() != variables_)
    throw InputError("sampler " + name() + ": embedded for " + std::to_string(variables_) + " variables, not " +
                     std::to_string(problem.variable_count()));
  const Problem ising = to_ising(problem);
  EmbeddedProblem embedded =
      embed_problem(scaled(ising, settings_.scale), graph_, embedding_, settings_.chain_coupling);
  take_off_leak(embedded.problem, settings_.susceptibility);
  use = {settings_.scale, cut_to_ranges(embedded.problem, settings_.ranges), 0};
  SampleSet rows{.vartype = problem.vartype, .labels = problem.labels};
  const std::size_t gauges = std::min(std::max<std::size_t>(1, settings_.gauges), request.reads);
  for (std::size_t k = 0; k < gauges; ++k) {
    SampleRequest part = request;
    part.start = nullptr;
    part.reads = request.reads * (k + 1) / gauges - request.reads * k / gauges;
    part.seed = random_bits(request.seed, kDevice, k);
    if (settings_.sweeps > 0) part.sweeps = settings_.sweeps;
    const auto gauge = random_gauge(embedded.problem.variable_count(), random_bits(request.seed, kGauge, k));
    const SampleSet turned = device_->sample(apply_gauge(embedded.problem, gauge), part);
    const Unembedded found =
        unembed(apply_gauge(turned, gauge), embedded.record, settings_.broken, random_bits(request.seed, kBroken, k));
    for (double share : found.chain_break_fraction) use.chain_break_fraction += share / double(request.reads);
    append(rows, found.samples);
  }
  if (problem.vartype == Vartype::binary)
    for (std::int8_t& value : rows.values) value = value > 0;
  for (std::size_t r = 0; r < rows.row_count(); ++r) rows.energies[r] = energy(problem, rows.row(r));
  return rows;
}

Thermometer thermometer_named(const std::string& name) {
  if (name == "none") return Thermometer::none;
  if (name == "pseudo_likelihood") return Thermometer::pseudo_likelihood;
  if (name == "histogram") return Thermometer::histogram;
  if (name == "offset_model") return Thermometer::offset_model;
  throw InputError("thermometer \"" + name +
                   "\" does not exist; use none, pseudo_likelihood, histogram or offset_model");
}

SampleSet TemperatureControl::rows_at(double scale, const Problem& problem, std::uint64_t draw) {
  const double before = sampler_.scale();
  sampler_.set_scale(scale);
  SampleSet rows =
      sampler_.sample(problem, {.reads = reads_, .seed = random_bits(seed_, kThermometer, draw), .sweeps = sweeps_});
  sampler_.set_scale(before);
  return rows;
}

void TemperatureControl::update(std::size_t epoch, const Problem& problem) {
  if (thermometer_ == Thermometer::none) return;
  const double scale = sampler_.scale();
  const SampleSet rows = rows_at(scale, problem, 2 * epoch);
  ThermometerReading reading{.epoch = epoch, .scale = scale};
  const BetaEstimate local = pseudo_likelihood_beta(problem, rows, seed_ + epoch);
  reading.beta = local.beta;
  reading.low = local.low;
  reading.high = local.high;
  double wanted = scale / local.beta;
  if (thermometer_ != Thermometer::pseudo_likelihood) {
    const double second = kSecondScale * scale;
    const SampleSet others = rows_at(second, problem, 2 * epoch + 1);
    if (thermometer_ == Thermometer::histogram) {
      const BetaEstimate global = histogram_beta(rows.energies, scale, others.energies, second, seed_ + epoch);
      reading.beta = global.beta * scale;
      reading.low = global.low * scale;
      reading.high = global.high * scale;
      wanted = 1 / global.beta;
    } else {
      const BetaEstimate other = pseudo_likelihood_beta(problem, others, seed_ + epoch);
      for (const auto& [x, b] : {std::pair(scale, local), std::pair(second, other)}) {
        scales_.push_back(x);
        temperatures_.push_back(1 / b.beta);
        errors_.push_back(std::max((b.high - b.low) / 4 / (b.beta * b.beta), 1e-6));
      }
      const std::size_t kept = std::min<std::size_t>(scales_.size(), 10);  // the machine changes: recent readings only
      const auto last = [&](const std::vector<double>& all) { return std::span(all).last(kept); };
      const OffsetModel model = fit_offset_model(last(scales_), last(temperatures_), last(errors_));
      if (model.offset < 0.9 && model.slope > 0) wanted = model.scale_for(1);
    }
  }
  log_.push_back(reading);
  // A machine without structure says nothing about the temperature of its rows.
  const bool far = reading.high < 1 || reading.low > 1;  // however wide the interval, it is on one side
  const bool unknown =
      !(wanted > 0) || !std::isfinite(wanted) || (!far && reading.high - reading.low > kWidestReading * reading.beta);
  if (std::isinf(local.beta))
    wanted = 0;
  else if (unknown)
    return;
  wanted = std::clamp(wanted, scale / kMaxChange, scale * kMaxChange);
  wanted = std::clamp(wanted, first_scale_ / furthest_, first_scale_ * furthest_);
  sampler_.set_scale(std::min(wanted, sampler_.largest_scale(problem)));
}

namespace {

constexpr double kStrengths[] = {0.6, 0.8, 1.0};  // |J| inside chains over the largest that any gauge can program
constexpr double kStiff = 3;                      // |J| inside chains over the temperature, at the first strength
constexpr double kMostBroken = 0.02;              // share of broken chains that a weaker strength may have
constexpr std::size_t kRounds = 14;               // measurements of the temperature
constexpr double kWidestSearch = 50;              // of the scale, from the first one
constexpr double kNear = 0.02;                    // of beta to 1

/// Block Gibbs from the device's rows.
SampleSet swept_on(const Problem& problem, const SampleSet& rows, const SampleRequest& request, std::size_t sweeps) {
  SampleRequest more{
      .reads = rows.row_count(), .seed = random_bits(request.seed, kPost, 0), .sweeps = sweeps, .start = &rows};
  return make_sampler("block_gibbs")->sample(problem, more);
}

}  // namespace

SampleSet SweptOn::sample(const Problem& problem, const SampleRequest& request) const {
  return swept_on(problem, source_->sample(problem, request), request, sweeps_);
}

Json to_json(const Correction& correction) {
  Json json = Json::object();
  add_use(correction.use, json);
  json["chain_coupling"] = correction.chain_coupling;
  json["beta"] = correction.beta;
  json["beta_low"] = correction.beta_low;
  json["beta_high"] = correction.beta_high;
  json["masked_pairs"] = Json(std::uint64_t(correction.masked_pairs));
  json["programmings"] = Json(std::uint64_t(correction.programmings));
  json["post_sweeps"] = Json(std::uint64_t(correction.post_sweeps));
  return json;
}

CorrectedAnnealer::CorrectedAnnealer(std::shared_ptr<const Sampler> device, const HardwareGraph& graph,
                                     Embedding embedding, const CorrectionSettings& settings)
    : device_(std::move(device)), graph_(graph), embedding_(std::move(embedding)), settings_(settings) {}

AnnealerSampler CorrectedAnnealer::tuned(const Problem& problem, const SampleRequest& request,
                                         double chain_coupling) const {
  AnnealerSettings settings;
  settings.chain_coupling = chain_coupling;
  settings.gauges = settings_.programmings;
  settings.ranges = settings_.ranges;
  settings.susceptibility = settings_.susceptibility;
  AnnealerSampler sampler(device_, graph_, embedding_, problem.variable_count(), settings);
  sampler.set_scale(std::min(settings_.first_scale, sampler.largest_scale(problem)));
  TemperatureControl control(sampler, Thermometer::pseudo_likelihood, settings_.probe_reads, request.sweeps,
                             random_bits(request.seed, kTuning, 0), kWidestSearch);
  for (std::size_t round = 0; round < kRounds; ++round) {
    stop_if_cancelled();
    const double scale = sampler.scale();
    control.update(round, problem);
    if (std::abs(control.log().back().beta - 1) > kNear && sampler.scale() != scale) continue;
    sampler.set_scale(scale);
    break;
  }
  return sampler;
}

SampleSet CorrectedAnnealer::sample(const Problem& problem, const SampleRequest& request) const {
  Correction correction;
  SampleSet rows = sample(problem, request, correction);
  rows.info = to_json(correction);
  return rows;
}

SampleSet CorrectedAnnealer::sample(const Problem& problem, const SampleRequest& request,
                                    Correction& correction) const {
  SampleRequest probe = request, final = request;
  probe.reads = settings_.probe_reads;
  probe.seed = random_bits(request.seed, kProbe, 0);
  final.seed = random_bits(request.seed, kFinalRows, 0);
  correction.masked_pairs = embedding_.uncoupled.size();
  correction.programmings = std::min(settings_.programmings, request.reads);
  correction.post_sweeps = settings_.post_sweeps > 0 && split_in_two(to_qubo(problem)) ? settings_.post_sweeps : 0;
  double largest = std::min(-settings_.ranges.j_low, settings_.ranges.j_high);
  AnnealerSampler sampler = tuned(problem, request, kStrengths[0] * largest);
  // The scale is the machine's temperature but for what warms its rows. Chains far stiffer than that freeze.
  for (int round = 0; round < 3; ++round) {
    const double fitting = kStiff / kStrengths[0] * sampler.scale();
    if (fitting > largest / 2) break;
    const AnnealerSampler softer = tuned(problem, request, kStrengths[0] * fitting);
    if (softer.scale() >= softer.largest_scale(problem)) break;  // the problem's couplings need stiffer chains
    sampler = softer;
    largest = fitting;
  }
  for (double share : kStrengths) {
    const double strength = share * largest;
    if (share != kStrengths[0]) sampler = tuned(problem, request, strength);
    sampler.sample(problem, probe, correction.use);
    if (correction.use.chain_break_fraction > kMostBroken && share != kStrengths[2]) continue;
    SampleSet rows = sampler.sample(problem, final, correction.use);
    const BetaEstimate left = pseudo_likelihood_beta(problem, rows, request.seed);
    correction.chain_coupling = strength;
    correction.beta = left.beta;
    correction.beta_low = left.low;
    correction.beta_high = left.high;
    return correction.post_sweeps > 0 ? swept_on(problem, rows, request, correction.post_sweeps) : rows;
  }
  return {};  // not reached: the last strength always answers
}

}  // namespace gonogo::learning
