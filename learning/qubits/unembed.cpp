#include "learning/qubits/unembed.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"

namespace gonogo::learning {
namespace {

using Columns = std::vector<std::vector<std::size_t>>;  // columns of the answer for each chain

Columns chain_columns(const SampleSet& answer, const EmbeddingRecord& record) {
  std::map<Label, std::size_t> column;
  for (std::size_t k = 0; k < answer.labels.size(); ++k) column[answer.labels[k]] = k;
  Columns result;
  for (const auto& chain : record.chains) {
    auto& columns = result.emplace_back();
    for (std::int64_t qubit : chain) {
      const auto found = column.find(Label(qubit));
      if (found == column.end())
        throw InputError("answer: qubit " + std::to_string(qubit) + " of the embedding has no column");
      columns.push_back(found->second);
    }
  }
  return result;
}

int chain_sum(std::span<const std::int8_t> row, const std::vector<std::size_t>& columns) {
  int sum = 0;
  for (std::size_t k : columns) sum += row[k];
  return sum;
}

bool unbroken(int sum, std::size_t length) { return std::size_t(std::abs(sum)) == length; }

/// Broken chains get 0 in `values` and are set downhill, the largest |local field| first.
void descend(const Problem& source, std::vector<std::int8_t>& values) {
  std::vector<double> field(source.linear);
  for (const Coupling& c : source.couplings) {
    field[c.a] += c.value * values[c.b];
    field[c.b] += c.value * values[c.a];
  }
  for (;;) {
    std::size_t next = values.size();
    for (std::size_t v = 0; v < values.size(); ++v)
      if (values[v] == 0 && (next == values.size() || std::abs(field[v]) > std::abs(field[next]))) next = v;
    if (next == values.size()) return;
    values[next] = field[next] > 0 ? -1 : 1;
    for (const Coupling& c : source.couplings) {
      if (c.a == next) field[c.b] += c.value * values[next];
      if (c.b == next) field[c.a] += c.value * values[next];
    }
  }
}

std::vector<std::int8_t> decide(std::span<const std::int8_t> row, std::size_t number, const Columns& columns,
                                const EmbeddingRecord& record, BrokenChains policy, std::uint64_t seed) {
  std::vector<std::int8_t> values;
  for (std::size_t v = 0; v < columns.size(); ++v) {
    const int sum = chain_sum(row, columns[v]);
    const bool whole = unbroken(sum, columns[v].size());
    if (policy == BrokenChains::weighted_random)
      values.push_back(row[columns[v][random_bits(seed, number, v) % columns[v].size()]]);
    else if (policy == BrokenChains::minimize_energy && !whole)
      values.push_back(0);
    else
      values.push_back(sum >= 0 ? 1 : -1);
  }
  if (policy == BrokenChains::minimize_energy) descend(record.source, values);
  return values;
}

/// Adds `weight` reads of a row to the break counts; returns the share of broken chains.
double count_breaks(std::span<const std::int8_t> row, const Columns& columns, double weight, Unembedded& result) {
  std::size_t broken = 0, qubit = 0;
  for (std::size_t v = 0; v < columns.size(); ++v) {
    const int sum = chain_sum(row, columns[v]);
    if (!unbroken(sum, columns[v].size())) {
      ++broken;
      result.chain_break_rate[v] += weight;
    }
    for (std::size_t k : columns[v])
      result.qubit_break_rate[qubit++] += sum == 0 ? weight / 2 : (row[k] > 0) != (sum > 0) ? weight : 0;
  }
  return columns.empty() ? 0 : double(broken) / double(columns.size());
}

}  // namespace

BrokenChains broken_chains_named(const std::string& name) {
  const char* names[] = {"weighted_random", "majority_vote", "discard", "minimize_energy"};
  for (int k = 0; k < 4; ++k)
    if (name == names[k]) return BrokenChains(k);
  throw InputError("policy \"" + name +
                   "\" does not exist; use weighted_random, majority_vote, discard or minimize_energy");
}

Unembedded unembed(const SampleSet& answer, const EmbeddingRecord& record, BrokenChains policy, std::uint64_t seed) {
  if (answer.vartype != Vartype::spin) throw InputError("answer: rows over qubits must be SPIN");
  const Columns columns = chain_columns(answer, record);
  std::size_t qubits = 0;
  double reads = 0;
  for (const auto& chain : columns) qubits += chain.size();
  for (std::int64_t count : answer.occurrences) reads += double(count);
  Unembedded result;
  result.chain_break_rate.assign(columns.size(), 0);
  result.qubit_break_rate.assign(qubits, 0);
  result.samples.vartype = Vartype::spin;
  result.samples.labels = record.source.labels;
  result.samples.info = answer.info;
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    const double fraction = count_breaks(answer.row(r), columns, double(answer.occurrences[r]) / reads, result);
    if (policy == BrokenChains::discard && fraction > 0) continue;
    const std::vector<std::int8_t> values = decide(answer.row(r), r, columns, record, policy, seed);
    result.samples.values.insert(result.samples.values.end(), values.begin(), values.end());
    result.samples.energies.push_back(energy(record.source, values));
    result.samples.occurrences.push_back(answer.occurrences[r]);
    result.chain_break_fraction.push_back(fraction);
  }
  return result;
}

std::vector<std::int8_t> random_gauge(std::size_t variables, std::uint64_t seed) {
  std::vector<std::int8_t> gauge;
  for (std::size_t i = 0; i < variables; ++i) gauge.push_back(random_bits(seed, 0, i) & 1 ? 1 : -1);
  return gauge;
}

Problem apply_gauge(const Problem& ising, const std::vector<std::int8_t>& gauge) {
  GONOGO_ASSERT(ising.vartype == Vartype::spin && gauge.size() == ising.variable_count());
  Problem result = ising;
  for (std::size_t i = 0; i < gauge.size(); ++i) result.linear[i] *= gauge[i];
  for (Coupling& c : result.couplings) c.value *= gauge[c.a] * gauge[c.b];
  return result;
}

SampleSet apply_gauge(const SampleSet& samples, const std::vector<std::int8_t>& gauge) {
  GONOGO_ASSERT(samples.vartype == Vartype::spin && gauge.size() == samples.variable_count());
  SampleSet result = samples;
  for (std::size_t k = 0; k < result.values.size(); ++k)
    result.values[k] = std::int8_t(result.values[k] * gauge[k % gauge.size()]);
  return result;
}

double auto_scale_factor(const Problem& ising, const CoefficientRanges& ranges) {
  double excess = 0;  // largest coefficient in units of its limit
  const auto add = [&](double value, double low, double high) {
    excess = std::max(excess, value > 0 ? value / high : value / low);
  };
  std::vector<double> sum(ising.variable_count(), 0.0);
  for (double h : ising.linear) add(h, ranges.h_low, ranges.h_high);
  for (const Coupling& c : ising.couplings) {
    add(c.value, ranges.j_low, ranges.j_high);
    sum[c.a] += c.value;
    sum[c.b] += c.value;
  }
  if (ranges.per_qubit_coupling)
    for (double s : sum) add(s, ranges.per_qubit_coupling->first, ranges.per_qubit_coupling->second);
  return excess > 0 ? 1 / excess : 1;
}

Problem scaled(const Problem& problem, double factor) {
  Problem result = problem;
  result.offset *= factor;
  for (double& bias : result.linear) bias *= factor;
  for (Coupling& c : result.couplings) c.value *= factor;
  return result;
}

void check_ranges(const Problem& ising, const CoefficientRanges& ranges) {
  const std::string help = "; scale the problem by " + number_text(auto_scale_factor(ising, ranges), 6) + " or less";
  const auto check = [&](const std::string& what, double value, double low, double high) {
    if (value < low || value > high)
      throw InputError(what + " is " + number_text(value, 6) + ", allowed is " + number_text(low) + " to " +
                       number_text(high) + help);
  };
  std::vector<double> sum(ising.variable_count(), 0.0);
  for (std::size_t i = 0; i < sum.size(); ++i)
    check("linear bias of " + label_text(ising.labels[i]), ising.linear[i], ranges.h_low, ranges.h_high);
  for (const Coupling& c : ising.couplings) {
    check("coupling of " + label_text(ising.labels[c.a]) + " and " + label_text(ising.labels[c.b]), c.value,
          ranges.j_low, ranges.j_high);
    sum[c.a] += c.value;
    sum[c.b] += c.value;
  }
  for (std::size_t i = 0; ranges.per_qubit_coupling && i < sum.size(); ++i)
    check("sum of couplings of " + label_text(ising.labels[i]), sum[i], ranges.per_qubit_coupling->first,
          ranges.per_qubit_coupling->second);
}

}  // namespace gonogo::learning
