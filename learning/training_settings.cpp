#include "learning/training_settings.h"

#include <array>
#include <utility>

#include "base/error.h"

namespace gonogo::learning {
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
