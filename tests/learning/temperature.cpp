// Effective temperatures from rows, the annealer as a sampler, and training through it.
#include "learning/annealer/temperature.h"
#include "tests/learning/machine_likelihood.h"

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
#include "tests/learning/gray_box.h"
#include "tests/learning/toy.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

Problem toy_ising() { return to_ising(to_qubo(toy_machine(), toy_labels())); }

/// All states of a problem with their probabilities at inverse temperature beta.
SampleSet all_states(const Problem& problem, double beta, std::vector<double>& probability) {
  SampleSet rows;
  rows.vartype = problem.vartype;
  rows.labels = problem.labels;
  double z = 0;
  for (std::size_t state = 0; state < std::size_t(1) << problem.variable_count(); ++state) {
    std::vector<std::int8_t> row;
    for (std::size_t i = 0; i < problem.variable_count(); ++i) row.push_back(state >> i & 1 ? 1 : -1);
    rows.values.insert(rows.values.end(), row.begin(), row.end());
    rows.energies.push_back(energy(problem, row));
    rows.occurrences.push_back(1);
    probability.push_back(std::exp(-beta * rows.energies.back()));
    z += probability.back();
  }
  for (double& p : probability) p /= z;
  return rows;
}

SampleSet exact_rows(const Problem& problem, double beta, std::size_t reads, std::uint64_t seed) {
  SampleSet rows = make_sampler("exact")->sample(scaled(problem, beta), {.reads = reads, .seed = seed});
  for (std::size_t r = 0; r < rows.row_count(); ++r) rows.energies[r] = energy(problem, rows.row(r));
  return rows;
}

RbmWeights random_machine(std::size_t visible, std::size_t hidden, double size, std::uint64_t seed) {
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  std::uint64_t k = 0;
  for (auto* part : {&machine.weight, &machine.visible_bias, &machine.hidden_bias})
    for (double& w : *part) w = size * (2 * random_unit(seed, 1, k++) - 1);
  return machine;
}

/// Largest error of a pair moment.
double worst_moment(const Problem& problem, const SampleSet& rows, const ExactMoments& exact) {
  double worst = 0;
  for (std::size_t k = 0; k < problem.couplings.size(); ++k) {
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r)
      sum += rows.row(r)[problem.couplings[k].a] * rows.row(r)[problem.couplings[k].b];
    worst = std::max(worst, std::abs(sum / double(rows.row_count()) - exact.pair_mean[k]));
  }
  return worst;
}

std::vector<std::string> names(std::size_t count) {
  std::vector<std::string> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back("v" + std::to_string(i));
  return result;
}

/// Rows follow exp(-E / (offset + slope)), E the problem as programmed.
class WarmDevice final : public Sampler {
 public:
  WarmDevice(double offset, double slope, std::size_t sweeps = 300) : offset_(offset), slope_(slope), sweeps_(sweeps) {}
  std::string name() const override { return "warm"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override {
    SampleRequest longer = request;
    longer.sweeps = sweeps_;
    return make_sampler("anneal", {{"beta_end", 1 / (offset_ + slope_)}})->sample(problem, longer);
  }

 private:
  double offset_, slope_;
  std::size_t sweeps_;
};

class Unreachable final : public Sampler {
 public:
  std::string name() const override { return "qpu"; }
  SampleSet sample(const Problem&, const SampleRequest&) const override { throw InputError("no token is configured"); }
};

}  // namespace

TEST_CASE("the pseudo-likelihood of an exact distribution gives its beta to the last digits") {
  for (double beta : {1 / 0.35, 0.5, 1.0}) {
    std::vector<double> p;
    const SampleSet states = all_states(toy_ising(), beta, p);
    CHECK(pseudo_likelihood_beta(toy_ising(), states, 1, p, 40).beta == Approx(beta).epsilon(1e-12));
  }
}

TEST_CASE("the bootstrap interval of beta holds the truth about 95 times in 100, from both estimators") {
  const Problem problem = to_ising(to_qubo(random_machine(8, 5, 1.5, 3), names(8)));
  int local = 0, global = 0;
  constexpr int kTrials = 60;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const SampleSet rows = exact_rows(problem, 0.8, 300, 10 + trial),
                    others = exact_rows(problem, 0.6, 300, 900 + trial);
    const BetaEstimate a = pseudo_likelihood_beta(problem, rows, trial);
    local += a.low <= 0.8 && 0.8 <= a.high;
    const BetaEstimate b = histogram_beta(rows.energies, 0.8, others.energies, 0.6, trial, 12);
    global += b.low <= 1 && 1 <= b.high;
  }
  std::printf("intervals of %d that hold the truth: pseudo-likelihood %d, histogram %d\n", kTrials, local, global);
  CHECK(local >= 50);  // 57 minus four standard deviations
  CHECK(global >= 50);
}

TEST_CASE("local minima have no temperature, equal scales and empty answers are refused") {
  Problem field = toy_ising();
  SampleSet ground = exact_rows(field, 200, 20, 1);
  CHECK(std::isinf(pseudo_likelihood_beta(field, ground).beta));
  refused([&] { histogram_beta(ground.energies, 1, ground.energies, 1); }, "two different scales");
  refused([&] { pseudo_likelihood_beta(field, SampleSet{}); }, "no rows");
  const std::vector<double> one = {1.0, 1.0};
  refused([&] { fit_offset_model(one, one, one); }, "two different scales");
}

TEST_CASE("the model with an offset is recovered from temperatures at several scales") {
  const std::vector<double> scale = {0.2, 0.3, 0.5, 1}, error(4, 0.01);
  std::vector<double> temperature;
  for (double x : scale) temperature.push_back(0.4 + 0.15 / x);
  const OffsetModel model = fit_offset_model(scale, temperature, error);
  CHECK(model.offset == Approx(0.4));
  CHECK(model.slope == Approx(0.15));
  CHECK(model.scale_for(1) == Approx(0.25));
}

TEST_CASE("every thermometer brings a device of unknown temperature to beta = 1") {
  const RbmWeights machine = random_machine(8, 4, 1.2, 3);
  const Problem problem = to_qubo(machine, names(8));
  const HardwareGraph graph = graph_named("chimera:3");
  for (const char* name : {"pseudo_likelihood", "histogram", "offset_model"}) {
    AnnealerSettings settings;
    settings.scale = 1;
    settings.chain_coupling = 1;
    AnnealerSampler sampler(std::make_shared<WarmDevice>(0.1, 0.15), graph, 8, 4, settings);
    TemperatureControl control(sampler, thermometer_named(name), 400, 300, 5);
    for (std::size_t epoch = 1; epoch <= 7; ++epoch) control.update(epoch, problem);
    const SampleSet rows = sampler.sample(problem, {.reads = 2000, .seed = 77, .sweeps = 300});
    const double beta = pseudo_likelihood_beta(problem, rows).beta;
    std::printf("%s: first reading beta %.2f at scale 1, then scale %.3f, beta %.3f\n", name, control.log()[0].beta,
                sampler.scale(), beta);
    CHECK(control.log()[0].beta > 2);
    CHECK(beta == Approx(1).margin(0.1));
  }
  refused([] { thermometer_named("mercury"); }, "pseudo_likelihood");
}

TEST_CASE("one corrected annealer serves any machine, whatever its graph, scale and temperature") {
  // The machine is not the emulator: it states no temperature, and refuses what lies beyond its ranges.
  class Machine final : public Sampler {
   public:
    Machine(double temperature, const CoefficientRanges& ranges) : device_(0, temperature), ranges_(ranges) {}
    std::string name() const override { return "machine"; }
    SampleSet sample(const Problem& problem, const SampleRequest& request) const override {
      check_ranges(problem, ranges_);
      return device_.sample(problem, request);
    }

   private:
    WarmDevice device_;
    CoefficientRanges ranges_;
  };
  const Problem problem = to_ising(to_qubo(random_machine(6, 5, 1.5, 4), names(6)));
  const ExactMoments exact = exact_moments(problem);
  const SampleRequest request{.reads = 2000, .seed = 5, .sweeps = 300};
  struct Case {
    const char* graph;
    double temperature, unit;  // of the machine's energies: ranges are those of a 2X times this
  };
  for (const Case& c : {Case{"pegasus:3", 0.03, 1.0}, Case{"zephyr:2", 0.3, 1.0}, Case{"zephyr:2", 1.2, 4.0}}) {
    const HardwareGraph graph = graph_named(c.graph);
    CoefficientRanges ranges;
    for (double* end : {&ranges.h_low, &ranges.h_high, &ranges.j_low, &ranges.j_high}) *end *= c.unit;
    const auto machine = std::make_shared<Machine>(c.temperature, ranges);
    CorrectionSettings settings;
    settings.ranges = ranges;
    const Embedding embedding = embed(graph, problem, "auto");
    Correction left;
    const SampleSet rows = CorrectedAnnealer(machine, graph, embedding, settings).sample(problem, request, left);
    const double worst = worst_moment(problem, rows, exact);
    CHECK(left.beta == Approx(1).margin(0.06));
    CHECK(left.use.scale == Approx(c.temperature).epsilon(0.25));
    CHECK(worst < 0.15);  // chains that freeze before the machine is cold leave a part
    // Without correction the rows are at the machine's temperature.
    AnnealerSettings plain;
    plain.ranges = ranges;
    plain.scale = 0.2;
    plain.chain_coupling = c.unit;
    const SampleSet raw = AnnealerSampler(machine, graph, embedding, 11, plain).sample(problem, request);
    const double uncorrected = worst_moment(problem, raw, exact);
    std::printf(
        "%s at temperature %.2f, unit %.0f: scale %.3f, chains %.2f, beta %.3f, worst moment off by %.3f, raw %.3f\n",
        c.graph, c.temperature, c.unit, left.use.scale, left.chain_coupling, left.beta, worst, uncorrected);
    CHECK(std::abs(pseudo_likelihood_beta(problem, raw).beta - 1) > 0.25);
    CHECK(uncorrected > 1.5 * worst);
  }
}

TEST_CASE("rows through chains and gauges have the moments of the problem itself") {
  const Problem problem = to_qubo(random_machine(8, 4, 1.0, 6), names(8));
  AnnealerSettings settings;
  settings.scale = 0.25;
  settings.chain_coupling = 0.75;
  settings.ranges.h_low = -4;
  settings.ranges.h_high = 4;
  AnnealerSampler sampler(std::make_shared<WarmDevice>(0, 0.25, 4000), graph_named("chimera:3"), 8, 4, settings);
  const SampleSet rows = sampler.sample(problem, {.reads = 1500, .seed = 3});
  const ExactMoments exact = exact_moments(problem);
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    double mean = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r) mean += rows.row(r)[i] / 1500.0;
    CHECK(mean == Approx(exact.mean[i]).margin(0.06));
  }
  CHECK(rows.info.at("cut_coefficients").integer() == 0);
  refused([&] { sampler.sample(toy_ising(), {}); }, "12 variables");
}

TEST_CASE("a sampler that cannot be reached is stood in for, once and for all, and says why") {
  WithStandIn sampler(std::make_unique<Unreachable>(), make_sampler("exact"));
  CHECK_FALSE(sampler.stood_in());
  CHECK(sampler.name() == "qpu");
  const Problem problem = toy_ising();
  CHECK(sampler.sample(problem, {.reads = 5, .seed = 2}) ==
        make_sampler("exact")->sample(problem, {.reads = 5, .seed = 2}));
  CHECK(sampler.stood_in());
  CHECK(sampler.name() == "exact");
  CHECK(sampler.reason().find("token") != std::string::npos);
}

TEST_CASE("gray-box training learns two equal pairs on a device whose temperature and errors are unknown") {
  Device device = d_wave_2x(0, 3);
  std::vector<double> rows;  // pairs of equal bits: log 4
  for (int n = 0; n < 16; ++n)
    for (int bit : {n & 1, n & 1, n >> 1 & 1, n >> 1 & 1}) rows.push_back(bit);
  GrayBoxSettings settings;
  settings.rate = 0.005;
  settings.first_coupling = 0.1;
  settings.sweeps = 50;
  GrayBox box(std::make_shared<Emulator>(device), device.graph, 4, 4, settings);
  for (int update = 0; update < 150; ++update) box.update(rows);
  const double beta = box.measured_beta(1000).beta;
  const double reached = mean_log_likelihood(box.contracted(beta), rows);
  std::printf("gray-box: %.3f nat per row at beta %.2f, best possible %.3f, independent units %.3f\n", reached, beta,
              -std::log(4.0), -4 * std::log(2.0));
  CHECK(reached > -std::log(4.0) - 0.3);
}

// The first step of Adam has the size of the rate, whatever the gradient: fields of a chain together move a unit as far
// as the one field of a unit on one qubit. With equal steps on every qubit long chains would move many times as far.
TEST_CASE("a step of gray-box training moves a unit on three qubits as far as one on a single qubit") {
  const Device device{graph_named("chimera:1x3"), {}, DeviceErrors::none(), 0.2, false, 1};
  GrayBoxSettings settings;
  settings.rate = 0.01;
  settings.sweeps = 20;
  GrayBox box(std::make_shared<Emulator>(device), device.graph, 12, 4, settings);
  box.update(std::vector<double>(12 * 4, 1.0));  // all on, which the first machine is not
  std::size_t on_one = 0, on_three = 0;
  for (double h : box.programmed().linear) {
    on_one += std::abs(std::abs(h) - 0.02) < 1e-6;
    on_three += std::abs(std::abs(h) - 0.02 / 3) < 1e-6;
  }
  CHECK(on_one == 12);
  CHECK(on_three == 12);
}
