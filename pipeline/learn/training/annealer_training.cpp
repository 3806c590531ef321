#include "pipeline/learn/training/annealer_training.h"

#include <algorithm>

namespace gonogo::learn {
namespace {

constexpr double kFirstScale = 0.2;  // what a machine of temperature 0.2 would need if nothing else warmed its rows

}  // namespace

EmulatorChoice read_emulator_choice(const std::optional<Config>& section) {
  EmulatorChoice choice;
  if (!section) return choice;
  const auto count = [&](const char* key, std::size_t fallback) {
    return std::size_t(section->integer_or(key, std::int64_t(fallback), {.minimum = 1, .maximum = 1e6}));
  };
  choice.graph = section->text_or("graph", choice.graph);
  choice.temperature = section->number_or("temperature", choice.temperature, {.minimum = 1e-3, .maximum = 100});
  choice.dead_share = section->number_or("dead_share", choice.dead_share, {.minimum = 0, .maximum = 0.5});
  choice.dead_seed = std::uint64_t(section->integer_or("dead_seed", 1, {.minimum = 0, .maximum = 1e15}));
  if (section->has("thermometer"))
    choice.thermometer = section->choice("thermometer", {"pseudo_likelihood", "histogram", "offset_model", "none"});
  choice.chain_coupling = section->number_or("chain_coupling", choice.chain_coupling, {.minimum = 0.01, .maximum = 1});
  choice.gauges = count("gauges", choice.gauges);
  choice.sweeps = count("sweeps", choice.sweeps);
  choice.reads = count("reads", choice.reads);
  section->finish();
  return choice;
}

Json to_json(const EmulatorChoice& choice) {
  Json json;
  json["graph"] = choice.graph;
  json["temperature"] = choice.temperature;
  json["dead_share"] = choice.dead_share;
  json["dead_seed"] = Json(choice.dead_seed);
  json["thermometer"] = choice.thermometer;
  json["chain_coupling"] = choice.chain_coupling;
  json["gauges"] = Json(std::uint64_t(choice.gauges));
  json["sweeps"] = Json(std::uint64_t(choice.sweeps));
  json["reads"] = Json(std::uint64_t(choice.reads));
  return json;
}

AnnealerTraining::AnnealerTraining(const EmulatorChoice& choice, const learning::VisibleLayout& layout,
                                   std::size_t hidden, std::uint64_t seed)
    : choice_(choice), labels_(layout.unit_labels()), visible_(layout.unit_count()), hidden_(hidden), seed_(seed) {
  const learning::HardwareGraph whole = learning::graph_named(choice.graph);
  learning::Device device{
      .graph = learning::without(whole, learning::random_dead_qubits(whole, choice.dead_share, choice.dead_seed)),
      .ranges = {},
      .errors = {},
      .temperature = choice.temperature,
      .auto_scale = false,
      .serial = choice.dead_seed};
  qubits_ = device.graph.qubits().size();
  learning::AnnealerSettings settings;
  settings.scale = kFirstScale;
  settings.chain_coupling = choice.chain_coupling;
  settings.gauges = choice.gauges;
  settings.sweeps = choice.sweeps;
  const learning::HardwareGraph graph = device.graph;
  sampler_ = std::make_unique<learning::AnnealerSampler>(std::make_shared<learning::Emulator>(std::move(device)), graph,
                                                         visible_, hidden_, settings);
  begin();
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> AnnealerTraining::masked() const {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const auto& [visible, variable] : sampler_->embedding().uncoupled)
    pairs.emplace_back(visible, variable - std::uint32_t(visible_));
  return pairs;
}

void AnnealerTraining::begin() {
  sampler_->set_scale(kFirstScale);
  control_.emplace(*sampler_, learning::thermometer_named(choice_.thermometer), choice_.reads, choice_.sweeps, seed_);
}

void AnnealerTraining::watch(std::size_t epoch, const learning::RbmWeights& weights) {
  control_->update(epoch, learning::to_qubo(weights, labels_));
}

Json AnnealerTraining::report() const {
  std::size_t longest = 0;
  for (const auto& chain : sampler_->embedding().chains) longest = std::max(longest, chain.size());
  Json json = to_json(choice_), readings = Json::array();
  json["working_qubits"] = Json(std::uint64_t(qubits_));
  json["longest_chain"] = Json(std::uint64_t(longest));
  json["pairs"] = Json(std::uint64_t(visible_ * hidden_));
  json["masked_pairs"] = Json(std::uint64_t(masked().size()));
  json["last_scale"] = sampler_->scale();
  for (const learning::ThermometerReading& reading : control_->log()) {
    Json entry;
    entry["epoch"] = Json(std::uint64_t(reading.epoch));
    entry["scale"] = reading.scale;
    entry["beta"] = reading.beta;
    entry["beta_low"] = reading.low;
    entry["beta_high"] = reading.high;
    readings.push_back(std::move(entry));
  }
  json["readings"] = std::move(readings);
  return json;
}

}  // namespace gonogo::learn
