#include "pipeline/outcome/training/training_sampler.h"

#include <algorithm>

#include "learning/annealer/emulator.h"
#include "learning/sampler/chains/gpu_chains.h"

namespace gonogo::outcome {
namespace {

constexpr double kFirstScale = 0.2;  // what a machine of temperature 0.2 would need if nothing else warmed its rows

/// Whether a GPU is there and faster. Below so many updates of units per update of the weights, launching takes longer.
bool gpu_gains(const LearningSettings& settings, std::size_t visible) {
  constexpr double kLeast = 1e6;
  const learning::TrainingSettings& training = settings.training;
  const double updates = double(training.chains) * double(training.sweeps) * double(visible + training.hidden);
  return settings.sampler == "block_gibbs" && settings.gpu && updates >= kLeast && learning::gpu_answers();
}

}  // namespace

TrainingSampler::TrainingSampler(const LearningSettings& settings, const learning::VisibleLayout& layout,
                                 learning::TrainingSettings& training)
    : wanted_(settings.sampler), on_gpu_(gpu_gains(settings, layout.unit_count())), choice_(settings.emulator) {
  if (wanted_ == learning::kEmulator) {
    use_emulator(layout, training);
  } else if (wanted_ == "command") {
    use_with_stand_in(learning::make_sampler("command", {{"program", settings.command}}), settings.stand_in);
  } else if (on_gpu_) {
    use_with_stand_in(learning::make_sampler("block_gibbs", {{"on_gpu", true}}), "block_gibbs");
  } else {
    sampler_ = learning::make_machine_sampler(wanted_);
  }
}

void TrainingSampler::use_emulator(const learning::VisibleLayout& layout, learning::TrainingSettings& training) {
  const std::size_t visible = layout.unit_count();
  const learning::HardwareGraph whole = learning::graph_named(choice_.graph);
  learning::Device device{
      .graph = learning::without(whole, learning::random_dead_qubits(whole, choice_.dead_share, choice_.dead_seed)),
      .ranges = {},
      .errors = {},
      .temperature = choice_.temperature,
      .auto_scale = false,
      .serial = choice_.dead_seed};
  labels_ = layout.unit_labels();
  seed_ = training.seed;
  working_qubits_ = device.graph.qubits().size();
  pairs_ = visible * training.hidden;
  learning::AnnealerSettings settings;
  settings.scale = kFirstScale;
  settings.chain_coupling = choice_.chain_coupling;
  settings.gauges = choice_.gauges;
  settings.sweeps = choice_.sweeps;
  settings.susceptibility = device.errors.susceptibility;
  const learning::HardwareGraph graph = device.graph;
  auto sampler = std::make_unique<learning::AnnealerSampler>(std::make_shared<learning::Emulator>(std::move(device)),
                                                             graph, visible, training.hidden, settings);
  annealer_ = sampler.get();  // whose own rows tell the temperature
  sampler_ = std::move(sampler);
  if (choice_.post_sweeps > 0) sampler_ = std::make_unique<learning::SweptOn>(std::move(sampler_), choice_.post_sweeps);
  begin();
  for (const auto& [unit, variable] : annealer_->embedding().uncoupled)
    training.masked.emplace_back(unit, variable - std::uint32_t(visible));
  training.report_every = 1;  // the temperature is taken after every epoch
}

void TrainingSampler::use_with_stand_in(std::unique_ptr<learning::Sampler> wanted, const std::string& other) {
  auto sampler = std::make_unique<learning::WithStandIn>(std::move(wanted), learning::make_machine_sampler(other));
  stand_in_ = sampler.get();
  sampler_ = std::move(sampler);
}

learning::EpochHook TrainingSampler::watch() {
  if (!annealer_) return {};
  return [this](std::size_t epoch, const learning::RbmWeights& weights) {
    control_->update(epoch, learning::to_qubo(weights, labels_));
    return true;
  };
}

void TrainingSampler::begin() {
  if (!annealer_) return;
  annealer_->set_scale(kFirstScale);
  control_.emplace(*annealer_, learning::thermometer_named(choice_.thermometer), choice_.reads, choice_.sweeps, seed_);
}

SamplerReport TrainingSampler::report() const {
  SamplerReport report{.name = sampler_->name(), .on_gpu = on_gpu_ && !stood_in(), .stood_in = stood_in()};
  if (annealer_) {
    const auto& embedding = annealer_->embedding();
    report.annealer = {.choice = choice_,
                       .working_qubits = working_qubits_,
                       .pairs = pairs_,
                       .masked_pairs = embedding.uncoupled.size(),
                       .last_scale = annealer_->scale(),
                       .readings = control_->log()};
    for (const auto& chain : embedding.chains)
      report.annealer->longest_chain = std::max(report.annealer->longest_chain, chain.size());
  }
  if (report.stood_in) {
    report.wanted = on_gpu_ ? wanted_ + " on a GPU" : wanted_;
    report.reason = stand_in_->reason();
  }
  return report;
}

}  // namespace gonogo::outcome
