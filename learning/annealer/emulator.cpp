#include "learning/annealer/emulator.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

enum EmulatorStream : std::uint64_t { kScale = 1, kField, kFlux, kCoupling, kReadout };

/// The nearest value the converters can make; their step changes linearly over the range.
double quantised(double x, double low, double high, double step_low, double step_high) {
  const double step = step_low + (x - low) / (high - low) * (step_high - step_low);
  return step > 0 ? std::round(x / step) * step : x;
}

std::uint64_t qubit_of(const Problem& problem, std::size_t i) {
  return std::uint64_t(std::get<std::int64_t>(problem.labels[i]));
}

/// Background susceptibility: every spin's field leaks through its couplings, and couplings through common neighbours.
void leak(Problem& problem, double chi) {
  if (chi == 0) return;
  std::vector<std::vector<std::pair<std::uint32_t, double>>> neighbours(problem.variable_count());
  const std::vector<double> h = problem.linear;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> J;
  for (const Coupling& c : problem.couplings) {
    neighbours[c.a].emplace_back(c.b, c.value);
    neighbours[c.b].emplace_back(c.a, c.value);
    problem.linear[c.a] += chi * c.value * h[c.b];
    problem.linear[c.b] += chi * c.value * h[c.a];
    J[{c.a, c.b}] = c.value;
  }
  for (const auto& list : neighbours)  // (J J)_ab = sum over the common neighbour
    for (const auto& [a, x] : list)
      for (const auto& [b, y] : list)
        if (a < b) J[{a, b}] += chi * x * y;
  problem.couplings.clear();
  for (const auto& [pair, value] : J) problem.couplings.push_back({pair.first, pair.second, value});
}

/// Times of a job on a 2X-like machine [us]: 20 us anneals.
Json timing(std::size_t reads) {
  constexpr double anneal = 20, readout = 123, delay = 21, programming = 12'000;
  return Json::Object{{"qpu_sampling_time", double(reads) * (anneal + readout + delay)},
                      {"qpu_anneal_time_per_sample", anneal},
                      {"qpu_readout_time_per_sample", readout},
                      {"qpu_delay_time_per_sample", delay},
                      {"qpu_programming_time", programming},
                      {"qpu_access_time", programming + double(reads) * (anneal + readout + delay)}};
}

/// Rows by energy, equal ones counted where `histogram` is set.
SampleSet by_energy(const SampleSet& rows, bool histogram) {
  std::vector<std::size_t> order(rows.row_count());
  std::iota(order.begin(), order.end(), std::size_t(0));
  const auto less = [&](std::size_t x, std::size_t y) {
    if (rows.energies[x] != rows.energies[y]) return rows.energies[x] < rows.energies[y];
    return std::lexicographical_compare(rows.row(x).begin(), rows.row(x).end(), rows.row(y).begin(), rows.row(y).end());
  };
  if (histogram) std::stable_sort(order.begin(), order.end(), less);
  SampleSet result = rows;
  result.values.clear();
  result.energies.clear();
  result.occurrences.clear();
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto row = rows.row(order[k]);
    if (histogram && k > 0 && std::equal(row.begin(), row.end(), rows.row(order[k - 1]).begin())) {
      ++result.occurrences.back();
      continue;
    }
    result.values.insert(result.values.end(), row.begin(), row.end());
    result.energies.push_back(rows.energies[order[k]]);
    result.occurrences.push_back(1);
  }
  return result;
}

}  // namespace

DeviceErrors DeviceErrors::none() {
  return {.h_mean = 0,
          .h_deviation = 0,
          .j_mean = 0,
          .j_deviation = 0,
          .flux_deviation = 0,
          .h_scale_deviation = 0,
          .susceptibility = 0,
          .h_step_low = 0,
          .h_step_high = 0,
          .j_step_low = 0,
          .j_step_high = 0,
          .readout = 0};
}

Device d_wave_2x(double dead_share, std::uint64_t serial) {
  const HardwareGraph full = graph_named("chimera:12");
  return {.graph = without(full, random_dead_qubits(full, dead_share, serial)), .serial = serial};
}

SapiSolver solver_of(const Device& device) {
  SapiSolver solver{.name = "gonogo_emulator_" + std::to_string(device.serial),
                    .chip_size = std::int64_t(device.graph.chip_size())};
  solver.qubits.assign(device.graph.qubits().begin(), device.graph.qubits().end());
  solver.couplers.assign(device.graph.couplers().begin(), device.graph.couplers().end());
  return solver;
}

Problem disturbed(const Problem& ising, const Device& device, std::uint64_t programming) {
  const DeviceErrors& e = device.errors;
  const CoefficientRanges& range = device.ranges;
  Problem result = ising;
  for (std::size_t i = 0; i < result.linear.size(); ++i)
    result.linear[i] = quantised(result.linear[i], range.h_low, range.h_high, e.h_step_low, e.h_step_high);
  for (Coupling& c : result.couplings)
    c.value = quantised(c.value, range.j_low, range.j_high, e.j_step_low, e.j_step_high);
  for (std::size_t i = 0; i < result.linear.size(); ++i) {
    const std::uint64_t q = qubit_of(ising, i);
    result.linear[i] *= 1 + e.h_scale_deviation * random_normal(device.serial, kScale, q);
    result.linear[i] += e.h_mean + e.h_deviation * random_normal(programming, kField, q) +
                        e.flux_deviation * random_normal(programming, kFlux, q);
  }
  for (Coupling& c : result.couplings)
    c.value += e.j_mean +
               e.j_deviation * random_normal(programming, kCoupling,
                                             qubit_of(ising, c.a) * device.graph.chip_size() + qubit_of(ising, c.b));
  leak(result, e.susceptibility);
  return result;
}

Emulator::Emulator(Device device) : device_(std::move(device)), solver_(solver_of(device_)) {
  if (!(device_.temperature > 0)) throw InputError("sampler emulator: the temperature must be above 0");
}

SampleSet Emulator::sample(const Problem& problem, const SampleRequest& request) const {
  const Problem ising = to_ising(problem);
  to_sapi(ising, solver_, {});  // refuses what is not on its qubits and couplers
  const double factor = device_.auto_scale ? auto_scale_factor(ising, device_.ranges) : 1;
  const Problem programmed = scaled(ising, factor);
  check_ranges(programmed, device_.ranges);
  const double beta = 1 / device_.temperature;
  const auto annealer =
      make_sampler("anneal", {{"beta_start", beta / 20}, {"beta_end", beta}, {"schedule", std::string("linear")}});
  SampleSet rows = annealer->sample(disturbed(programmed, device_, request.seed), request);
  for (std::size_t k = 0; k < rows.values.size(); ++k)
    if (random_unit(request.seed, kReadout, k) < device_.errors.readout) rows.values[k] = std::int8_t(-rows.values[k]);
  rows.vartype = problem.vartype;
  if (problem.vartype == Vartype::binary)
    for (std::int8_t& value : rows.values) value = value > 0;
  for (std::size_t r = 0; r < rows.row_count(); ++r) rows.energies[r] = energy(problem, rows.row(r));
  rows.info["temperature"] = device_.temperature;
  rows.info["auto_scale_factor"] = factor;
  rows.info["timing"] = timing(request.reads);
  return rows;
}

std::string Emulator::answer(const Problem& problem, const SampleRequest& request, bool histogram) const {
  const SampleSet rows = sample(problem, request);
  return to_sapi_answer(by_energy(rows, histogram), std::int64_t(device_.graph.chip_size()), histogram,
                        rows.info.at("timing"));
}

}  // namespace gonogo::learning
