#include "pipeline/outcome/qubo/code_machine.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel/host_loop.h"

namespace gonogo::outcome {
namespace {

constexpr std::size_t kMaxHidden = 16;        // 2^16 rows take half a second
constexpr std::size_t kMaxCoupledUnits = 12;  // of a penalised group: all its words are listed

std::vector<CodeGroup> groups_of(const learning::Problem& problem, const learning::VisibleLayout& layout) {
  std::map<std::string, std::uint32_t> place;
  for (std::size_t i = 0; i < problem.labels.size(); ++i)
    place[learning::label_text(problem.labels[i])] = std::uint32_t(i);
  const std::vector<std::string> labels = layout.unit_labels();
  std::vector<CodeGroup> groups;
  const auto add = [&](std::ptrdiff_t variable, std::size_t first, std::size_t count) {
    CodeGroup group{.variable = variable, .unit = {}, .word = {}};
    for (std::size_t k = first; k < first + count; ++k)
      if (const auto found = place.find(labels[k]); found != place.end()) group.unit.push_back(found->second);
    if (count > 0 && group.unit.size() == count) groups.push_back(std::move(group));
  };
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    add(std::ptrdiff_t(v), layout.offset(v), layout.encoders()[v].unit_count());
  add(-1, layout.input_unit_count(), layout.outcome_count());
  for (CodeGroup& group : groups) {
    const std::size_t bins = group.variable < 0
                                 ? layout.outcome_count()
                                 : std::size_t(layout.encoders()[std::size_t(group.variable)].bin_count());
    for (std::size_t bin = 0; bin < bins; ++bin) {
      auto& word = group.word.emplace_back(group.unit.size(), std::uint8_t(0));
      if (group.variable < 0)
        word[bin] = 1;
      else
        layout.encoders()[std::size_t(group.variable)].encode(int(bin), word);
    }
  }
  return groups;
}

}  // namespace

std::optional<CodeMachine> CodeMachine::of(const learning::Problem& problem, const learning::VisibleLayout& layout) {
  CodeMachine machine;
  machine.problem_ = learning::to_qubo(problem);
  machine.groups_ = groups_of(problem, layout);
  const std::size_t n = problem.variable_count();
  std::vector<std::ptrdiff_t> group_of(n, -1), place_of(n, -1), hidden_of(n, -1);
  for (std::size_t g = 0; g < machine.groups_.size(); ++g)
    for (std::size_t k = 0; k < machine.groups_[g].unit.size(); ++k) {
      group_of[machine.groups_[g].unit[k]] = std::ptrdiff_t(g);
      place_of[machine.groups_[g].unit[k]] = std::ptrdiff_t(k);
    }
  for (std::size_t i = 0; i < n; ++i) {
    if (group_of[i] >= 0) continue;
    hidden_of[i] = std::ptrdiff_t(machine.hidden_.size());
    machine.hidden_.push_back(std::uint32_t(i));
  }
  machine.coupling_.assign(n, std::vector<double>(machine.hidden_.size(), 0.0));
  machine.inside_.assign(n, {});
  for (const learning::Coupling& c : machine.problem_.couplings) {
    if (c.value == 0) continue;
    if ((hidden_of[c.a] >= 0) != (hidden_of[c.b] >= 0)) {
      const bool a_hidden = hidden_of[c.a] >= 0;
      machine.coupling_[a_hidden ? c.b : c.a][std::size_t(hidden_of[a_hidden ? c.a : c.b])] = c.value;
      continue;
    }
    const CodeGroup* group = group_of[c.a] >= 0 ? &machine.groups_[std::size_t(group_of[c.a])] : nullptr;
    if (!group || group_of[c.a] != group_of[c.b] || group->unit.size() > kMaxCoupledUnits) return std::nullopt;
    auto& inside = machine.inside_[std::max(c.a, c.b)];
    inside.resize(group->unit.size(), 0.0);
    inside[std::size_t(place_of[std::min(c.a, c.b)])] = c.value;
  }
  machine.column_ = machine.hidden_;
  return machine;
}

CodeMachine CodeMachine::with_free_units(const learning::Problem& words, const learning::Problem& problem,
                                         const learning::VisibleLayout& layout) {
  std::optional<CodeMachine> machine = of(words, layout);
  const auto refuse = [] {
    throw InputError("problem: its free units and the machine over code words do not belong together; export it again");
  };
  if (!machine) refuse();
  FreeUnits& free = machine->free_.emplace();
  free.problem = learning::to_qubo(problem);
  std::map<std::string, std::size_t> place;
  for (std::size_t j = 0; j < machine->hidden_.size(); ++j)
    place[learning::label_text(words.labels[machine->hidden_[j]])] = j;
  const std::size_t n = problem.variable_count();
  std::vector<std::ptrdiff_t> hidden_of(n, -1), free_of(n, -1);
  std::vector<std::uint32_t> column(machine->hidden_.size(), UINT32_MAX);
  for (std::size_t i = 0; i < n; ++i) {
    if (const auto found = place.find(learning::label_text(problem.labels[i])); found != place.end()) {
      hidden_of[i] = std::ptrdiff_t(found->second);
      column[found->second] = std::uint32_t(i);
    } else {
      free_of[i] = std::ptrdiff_t(free.unit.size());
      free.unit.push_back(std::uint32_t(i));
    }
  }
  if (std::find(column.begin(), column.end(), UINT32_MAX) != column.end()) refuse();
  free.coupling.assign(free.unit.size(), std::vector<double>(column.size(), 0.0));
  for (const learning::Coupling& c : free.problem.couplings) {
    if (c.value == 0) continue;
    const bool a_free = free_of[c.a] >= 0;
    if (a_free == (free_of[c.b] >= 0)) refuse();
    free.coupling[std::size_t(free_of[a_free ? c.a : c.b])][std::size_t(hidden_of[a_free ? c.b : c.a])] = c.value;
  }
  machine->column_ = std::move(column);
  return std::move(*machine);
}

std::vector<double> CodeMachine::fields(const CodeGroup& group, std::span<const std::int8_t> row) const {
  std::vector<double> result;
  for (std::uint32_t unit : group.unit) {
    double sum = problem_.linear[unit];
    for (std::size_t j = 0; j < hidden_.size(); ++j)
      if (row[column_[j]] > 0) sum += coupling_[unit][j];
    result.push_back(sum);
  }
  return result;
}

template <class On>
double CodeMachine::word_energy(const CodeGroup& group, std::span<const double> field, On on) const {
  double sum = 0;
  for (std::size_t k = 0; k < field.size(); ++k) {
    if (!on(k)) continue;
    sum += field[k];
    const auto& inside = inside_[group.unit[k]];
    for (std::size_t m = 0; m < inside.size(); ++m)
      if (on(m)) sum += inside[m];
  }
  return sum;
}

double CodeMachine::log_all_words(const CodeGroup& group, std::span<const double> field) const {
  const bool coupled =
      std::any_of(group.unit.begin(), group.unit.end(), [&](std::uint32_t unit) { return !inside_[unit].empty(); });
  if (!coupled) {
    double sum = 0;
    for (double f : field) sum += learning::softplus(-f);
    return sum;
  }
  std::vector<double> log_weight;
  for (std::size_t bits = 0; bits < std::size_t(1) << field.size(); ++bits)
    log_weight.push_back(-word_energy(group, field, [&](std::size_t k) { return (bits >> k & 1) != 0; }));
  return learning::log_sum_exp(log_weight);
}

double CodeMachine::log_all_free(std::span<const std::int8_t> row) const {
  double result = 0;
  for (const std::uint32_t h : column_)
    if (row[h] > 0) result -= free_->problem.linear[h];
  for (std::size_t k = 0; k < free_->unit.size(); ++k) {
    double field = free_->problem.linear[free_->unit[k]];
    for (std::size_t j = 0; j < column_.size(); ++j)
      if (row[column_[j]] > 0) field += free_->coupling[k][j];
    result += learning::softplus(-field);
  }
  return result;
}

CodeMachine::Given CodeMachine::given(std::span<const std::int8_t> row) const {
  Given result;
  for (std::size_t j = 0; j < hidden_.size(); ++j)
    if (row[column_[j]] > 0) result.log_words -= problem_.linear[hidden_[j]];
  result.log_all = free_ ? log_all_free(row) : result.log_words;
  for (const CodeGroup& group : groups_) {
    const std::vector<double> field = fields(group, row);
    std::vector<double> log_word;
    for (const auto& word : group.word)
      log_word.push_back(-word_energy(group, field, [&](std::size_t k) { return word[k] != 0; }));
    const double words = learning::log_sum_exp(log_word);
    result.log_words += words;
    if (!free_) result.log_all += log_all_words(group, field);
    auto& probability = result.probability.emplace_back();
    for (double x : log_word) probability.push_back(std::exp(x - words));
  }
  return result;
}

std::optional<CodeMachine::Exact> CodeMachine::exact() const {
  if (hidden_.size() > kMaxHidden) return std::nullopt;
  Exact result;
  for (const CodeGroup& group : groups_) result.probability.emplace_back(group.word.size(), 0.0);
  std::vector<std::int8_t> row(binary().variable_count(), 0);
  double highest = -INFINITY, words = 0, all = 0, weighed = 0;  // sums in units of exp(highest)
  // The two sums of free units have a constant factor between them, which no answer depends on.
  const Given first = given(row);
  const double shift = free_ ? first.log_words - first.log_all : 0;
  for (std::size_t bits = 0; bits < std::size_t(1) << hidden_.size(); ++bits) {
    for (std::size_t j = 0; j < hidden_.size(); ++j) row[column_[j]] = std::int8_t(bits >> j & 1);
    Given now = given(row);
    now.log_words -= shift;
    if (now.log_all > highest) {
      const double factor = std::exp(highest - now.log_all);
      for (auto& group : result.probability)
        for (double& p : group) p *= factor;
      words *= factor;
      all *= factor;
      weighed *= factor;
      highest = now.log_all;
    }
    const double weight = std::exp(now.log_words - highest);
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (std::size_t b = 0; b < now.probability[g].size(); ++b)
        result.probability[g][b] += weight * now.probability[g][b];
    words += weight;
    all += std::exp(now.log_all - highest);
    weighed += std::exp(2 * (now.log_words - highest) - (now.log_all - highest));
  }
  for (auto& group : result.probability)
    for (double& p : group) p /= words;
  if (!free_) result.word_share = words / all;
  result.weighed_share = words / all * words / weighed;
  return result;
}

learning::WordMachine CodeMachine::words() const {
  std::vector<std::size_t> lengths;
  std::vector<double> word_bias, field, hidden_bias;
  for (const CodeGroup& group : groups_) {
    lengths.push_back(group.word.size());
    std::vector<double> alone;
    for (const std::uint32_t unit : group.unit) alone.push_back(problem_.linear[unit]);
    for (const auto& word : group.word) {
      word_bias.push_back(-word_energy(group, alone, [&](std::size_t k) { return word[k] != 0; }));
      for (std::size_t j = 0; j < hidden_.size(); ++j) {
        double sum = 0;
        for (std::size_t k = 0; k < word.size(); ++k)
          if (word[k]) sum -= coupling_[group.unit[k]][j];
        field.push_back(sum);
      }
    }
  }
  for (const std::uint32_t h : hidden_) hidden_bias.push_back(-problem_.linear[h]);
  return learning::WordMachine(lengths, std::move(word_bias), std::move(field), std::move(hidden_bias));
}

namespace {

/// P(word of one group | those of the others), hidden units summed out.
std::vector<double> given_others(const learning::WordMachine& machine, std::size_t group,
                                 std::span<const std::uint16_t> row) {
  std::vector<std::uint16_t> words(row.begin(), row.end());
  std::vector<double> result;
  for (std::size_t k = 0; k < machine.groups()[group].length; ++k) {
    words[group] = std::uint16_t(k);
    result.push_back(machine.log_weight(words));
  }
  learning::normalise_logs(result);
  return result;
}

}  // namespace

CodeMachine::Reference CodeMachine::outcomes() const {
  constexpr std::uint64_t kStream = 0x72656665;  // of random numbers
  constexpr std::size_t kChains = 32, kRungs = 5, kBurnIn = 3000, kDraws = 200, kEvery = 5;
  const auto group =
      std::find_if(groups_.begin(), groups_.end(), [](const CodeGroup& candidate) { return candidate.variable < 0; });
  if (group == groups_.end()) return {};
  if (std::vector<double> exact = exact_outcomes(); !exact.empty()) {
    const std::size_t count = exact.size();
    return {std::move(exact), std::vector<double>(count, 0.0)};
  }
  const learning::WordMachine machine = words();
  learning::WordChains chains(kChains, kRungs, kStream);
  const std::size_t count = group->word.size();
  std::vector<std::vector<double>> mean(kChains, std::vector<double>(count, 0.0));
  for (std::size_t n = 0; n < kDraws; ++n) {
    chains.run(machine, n == 0 ? kBurnIn : kEvery);
    for_each_on_host(kChains, 1, [&](std::size_t chain) {
      const std::vector<double> p = given_others(machine, std::size_t(group - groups_.begin()), chains.row(chain));
      for (std::size_t y = 0; y < count; ++y) mean[chain][y] += p[y] / double(kDraws);
    });
  }
  Reference result{std::vector<double>(count, 0.0), std::vector<double>(count, 0.0)};
  for (std::size_t y = 0; y < count; ++y) {
    double sum = 0, square = 0;
    for (const std::vector<double>& of : mean) sum += of[y];
    result.probability[y] = sum / double(kChains);
    for (const std::vector<double>& of : mean) square += std::pow(of[y] - result.probability[y], 2);
    result.standard_error[y] = std::sqrt(square / double(kChains - 1) / double(kChains));
  }
  return result;
}

namespace {

/// P(words of `group`), where all words have few combinations: hidden units are summed out for each. Empty where they
/// have many.
std::vector<double> by_words(const learning::WordMachine& machine, std::size_t group) {
  constexpr std::size_t kMaxRows = 4096;
  std::size_t rows = 1;
  for (const learning::WordGroup& each : machine.groups())
    if ((rows *= each.length) > kMaxRows) return {};
  std::vector<std::vector<double>> logs(machine.groups()[group].length);
  std::vector<std::uint16_t> row(machine.groups().size());
  for (std::size_t n = 0; n < rows; ++n) {
    std::size_t rest = n;
    for (std::size_t g = 0; g < row.size(); ++g, rest /= machine.groups()[g - 1].length)
      row[g] = std::uint16_t(rest % machine.groups()[g].length);
    logs[row[group]].push_back(machine.log_weight(row));
  }
  std::vector<double> result;
  for (const std::vector<double>& of : logs) result.push_back(learning::log_sum_exp(of));
  learning::normalise_logs(result);
  return result;
}

}  // namespace

std::vector<double> CodeMachine::exact_outcomes() const {
  const auto group =
      std::find_if(groups_.begin(), groups_.end(), [](const CodeGroup& candidate) { return candidate.variable < 0; });
  if (group == groups_.end()) return {};
  const auto g = std::size_t(group - groups_.begin());
  const std::optional<Exact> sums = exact();
  return sums ? sums->probability[g] : by_words(words(), g);
}

}  // namespace gonogo::outcome
