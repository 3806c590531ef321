#include "learning/training.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/math/random.h"

namespace gonogo::learning {

TrainingTable TrainingTable::subset(const std::vector<std::size_t>& rows) const {
  TrainingTable part;
  part.variable_count = variable_count;
  for (std::size_t i : rows) {
    part.variables.insert(part.variables.end(), row(i).begin(), row(i).end());
    part.outcome.push_back(outcome[i]);
    part.weight.push_back(weight[i]);
    part.group.push_back(group[i]);
    if (!margin.empty()) part.margin.push_back(margin[i]);
  }
  return part;
}

std::vector<std::size_t> permutation(std::size_t count, std::uint64_t seed, std::uint64_t stream) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t(0));
  for (std::size_t i = count; i > 1; --i) {
    const auto j = std::size_t(random_unit(seed, stream, i) * double(i));
    std::swap(order[i - 1], order[j]);
  }
  return order;
}

std::vector<std::size_t> assign_folds(const TrainingTable& table, std::size_t fold_count, std::uint64_t seed) {
  std::map<std::uint64_t, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < table.row_count(); ++i) groups[table.group[i]].push_back(i);
  std::vector<const std::vector<std::size_t>*> members;
  for (const auto& [group, rows] : groups) members.push_back(&rows);
  std::vector<std::size_t> fold(table.row_count()), size(fold_count, 0);
  for (std::size_t g : permutation(members.size(), seed, 0x666f6c64)) {
    const auto smallest = std::size_t(std::min_element(size.begin(), size.end()) - size.begin());
    for (std::size_t row : *members[g]) fold[row] = smallest;
    size[smallest] += members[g]->size();
  }
  return fold;
}

namespace {

constexpr std::array<std::pair<const char*, NegativePhaseKind>, 5> kNegativePhases = {
    {{"persistent", NegativePhaseKind::persistent},
     {"contrastive", NegativePhaseKind::contrastive},
     {"tempering", NegativePhaseKind::tempering},
     {"trajectory", NegativePhaseKind::trajectory},
     {"code_words", NegativePhaseKind::code_words}}};
constexpr std::array<std::pair<const char*, Optimizer>, 2> kOptimizers = {
    {{"adam", Optimizer::adam}, {"sgd", Optimizer::sgd}}};
constexpr std::array<std::pair<const char*, GradientDevice>, 2> kGradientDevices = {
    {{"cpu", GradientDevice::cpu}, {"cuda", GradientDevice::cuda}}};

template <class Table, class Value>
std::string name_in(const Table& table, Value value) {
  for (const auto& [name, entry] : table)
    if (entry == value) return name;
  return "";
}

template <class Table>
auto value_in(const Table& table, const std::string& name, const std::string& what) {
  std::string known;
  for (const auto& [entry, value] : table) {
    if (entry == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(entry);
  }
  throw InputError(what + " \"" + name + "\" does not exist; use one of: " + known);
}

}  // namespace

std::string negative_phase_name(NegativePhaseKind kind) { return name_in(kNegativePhases, kind); }
NegativePhaseKind negative_phase_named(const std::string& name) {
  return value_in(kNegativePhases, name, "negative phase");
}
std::string optimizer_name(Optimizer optimizer) { return name_in(kOptimizers, optimizer); }
Optimizer optimizer_named(const std::string& name) { return value_in(kOptimizers, name, "optimizer"); }
std::string gradient_device_name(GradientDevice device) { return name_in(kGradientDevices, device); }
GradientDevice gradient_device_named(const std::string& name) {
  return value_in(kGradientDevices, name, "device of gradients");
}

}  // namespace gonogo::learning
