#include "learning/annealer/emulator.h"

#include <cmath>
#include <cstdio>
#include <set>

#include "base/math/random.h"
#include "learning/sampler/exact.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

Device quiet() {
  Device device = d_wave_2x(0.02, 7);
  device.errors = DeviceErrors::none();
  return device;
}

/// Random coefficients on the working qubits below 16 (the first two cells).
Problem on_device(const Device& device) {
  Problem problem;
  problem.vartype = Vartype::spin;
  std::vector<Qubit> qubits;
  for (Qubit q : device.graph.qubits())
    if (q < 16) qubits.push_back(q);
  for (std::uint32_t i = 0; i < qubits.size(); ++i) {
    problem.labels.emplace_back(std::int64_t(qubits[i]));
    problem.linear.push_back(0.2 * random_unit(1, 0, i) - 0.1);
    for (std::uint32_t j = i + 1; j < qubits.size(); ++j)
      if (device.graph.coupled(qubits[i], qubits[j]))
        problem.couplings.push_back({i, j, 0.5 * random_unit(2, i, j) - 0.25});
  }
  return problem;
}

/// Mean of z^2 over all pair moments, against exact ones of `reference`.
double moment_score(const SampleSet& rows, const Problem& reference) {
  const ExactMoments exact = exact_moments(reference);
  double score = 0;
  for (std::size_t k = 0; k < reference.couplings.size(); ++k) {
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r)
      sum += rows.row(r)[reference.couplings[k].a] * rows.row(r)[reference.couplings[k].b];
    const double n = double(rows.row_count()), m = exact.pair_mean[k];
    score += std::pow(sum / n - m, 2) / ((1 - m * m) / n) / double(reference.couplings.size());
  }
  return score;
}

}  // namespace

TEST_CASE(
    "without errors the device gives Boltzmann rows at its temperature, with them those of the disturbed problem") {
  const Device still = quiet();
  const Problem problem = on_device(still);
  const SampleRequest request{.reads = 6000, .seed = 3, .sweeps = 600};
  const Problem at_temperature = scaled(problem, 1 / still.temperature);
  const double clean = moment_score(Emulator(still).sample(problem, request), at_temperature);
  Device noisy = still;
  noisy.errors = DeviceErrors{};
  noisy.errors.readout = 0;
  const SampleSet rows = Emulator(noisy).sample(problem, request);
  const double against_given = moment_score(rows, at_temperature);
  const double against_disturbed =
      moment_score(rows, scaled(disturbed(problem, noisy, request.seed), 1 / noisy.temperature));
  std::printf(
      "emulator: mean z^2 without errors %.2f; with errors %.2f against the given, %.2f against the disturbed\n", clean,
      against_given, against_disturbed);
  CHECK(clean < 2);
  CHECK(against_given > 5);
  CHECK(against_disturbed < 2);
  for (std::size_t r = 0; r < 5; ++r) CHECK(rows.energies[r] == Approx(energy(problem, rows.row(r))));
}

TEST_CASE("background susceptibility as in D-Wave's documentation") {
  Device device = quiet();
  device.errors.susceptibility = -0.01;
  device.ranges.j_high = 2;
  Problem chain;
  chain.vartype = Vartype::spin;
  for (std::int64_t q : {0, 4, 1}) chain.labels.emplace_back(q);
  chain.linear = {0.3, 0.8, -0.25};
  chain.couplings = {{0, 1, 1.2}, {1, 2, -0.4}};
  const Problem result = disturbed(chain, device, 1);
  CHECK(result.linear[0] == Approx(0.2904).epsilon(1e-14));
  CHECK(result.linear[1] == Approx(0.8 - 0.01 * 0.46).epsilon(1e-14));
  REQUIRE(result.couplings.size() == 3);
  CHECK(result.couplings[1].value == Approx(-0.01 * 1.2 * -0.4).epsilon(1e-14));  // between the two ends
}

TEST_CASE("converters have the published number of levels, and control errors the published size") {
  Device device = quiet();
  device.errors.h_step_low = 0.0164;
  device.errors.h_step_high = 0.001;
  Problem one;
  one.vartype = Vartype::spin;
  one.labels = {std::int64_t(device.graph.qubits()[0])};
  one.linear = {-1.99};
  std::set<double> levels;
  for (double h = -2; h < -1.9; h += 0.0001) {
    one.linear[0] = h;
    const double found = disturbed(one, device, 1).linear[0];
    CHECK(std::abs(found - h) < 0.0083);
    levels.insert(std::round(found / 0.004));
  }
  CHECK(levels.size() < 30);
  device.errors = DeviceErrors{};
  device.errors.h_step_low = device.errors.h_step_high = device.errors.h_scale_deviation = 0;
  device.errors.flux_deviation = 0;
  one.linear[0] = 0.5;
  double mean = 0, square = 0;
  for (std::uint64_t programming = 0; programming < 4000; ++programming) {
    const double error = disturbed(one, device, programming).linear[0] - 0.5;
    mean += error / 4000;
    square += error * error / 4000;
  }
  CHECK(mean == Approx(-0.013).margin(4 * 0.010 / std::sqrt(4000.0)));
  CHECK(std::sqrt(square - mean * mean) == Approx(0.010).epsilon(0.06));
}

TEST_CASE("readout errors turn the stated share of bits") {
  Device device = quiet();
  device.errors.readout = 0.01;
  device.temperature = 0.02;
  Problem strong;
  strong.vartype = Vartype::spin;
  for (std::size_t k = 0; k < 100; ++k) strong.labels.emplace_back(std::int64_t(device.graph.qubits()[k]));
  strong.linear.assign(100, -1);
  const SampleSet rows = Emulator(device).sample(strong, {.reads = 400, .seed = 1, .sweeps = 10});
  double wrong = 0;
  for (std::int8_t value : rows.values) wrong += value < 0;
  CHECK(wrong / 40000 == Approx(0.01).margin(4 * std::sqrt(0.01 / 40000)));
}

TEST_CASE("answers travel in SAPI's form; what the device cannot hold is refused") {
  const Device device = d_wave_2x(0.02, 7);
  const Emulator emulator(device);
  const Problem problem = on_device(device);
  for (bool histogram : {true, false}) {
    const std::string text = emulator.answer(problem, {.reads = 300, .seed = 5, .sweeps = 30}, histogram);
    const SampleSet answer = samples_from_sapi(text, "answer");
    std::int64_t reads = 0;
    for (std::int64_t count : answer.occurrences) reads += count;
    CHECK(reads == 300);
    CHECK(check_answer(problem, answer, "answer").row_count() == answer.row_count());
    if (histogram) CHECK(answer.row_count() < 300);
  }
  CHECK(problem_from_sapi(to_sapi(problem, solver_of(device), {}), solver_of(device), "p") == problem);
  Problem large = problem;
  large.linear[0] = 2.5;
  refused([&] { emulator.sample(large, {}); }, "allowed");
  Device scaling = device;
  scaling.auto_scale = true;
  CHECK(Emulator(scaling).sample(large, {.reads = 2, .sweeps = 5}).info.at("auto_scale_factor").number() ==
        Approx(2 / 2.5));
  Problem dead = problem;
  for (std::int64_t q = 0; q < 1152; ++q)
    if (!device.graph.works(Qubit(q))) dead.labels[0] = q;
  refused([&] { emulator.sample(dead, {}); }, "working qubits");
}
