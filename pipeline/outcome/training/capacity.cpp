#include "pipeline/outcome/training/capacity.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "learning/qubits/embedding.h"
#include "learning/qubits/line_embedding.h"
#include "learning/rbm/train.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/training/train_model.h"
#include "pipeline/outcome/training/training_sampler.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

/// A row with an unknown variable counts for its other variables. In a layout without inner edges all rows share one
/// bin.
BinCoverage bin_coverage(const learning::VisibleLayout& layout, const learning::TrainingTable& table) {
  const auto& encoders = layout.encoders();
  std::vector<std::vector<int>> bin(encoders.size());  // [variable][row], -1 where unknown
  BinCoverage coverage{table.row_count(), 0};
  for (std::size_t v = 0; v < encoders.size(); ++v) {
    std::vector<std::size_t> count(std::size_t(encoders[v].bin_count()), 0);
    for (std::size_t n = 0; n < table.row_count(); ++n) {
      const double x = table.row(n)[v];
      bin[v].push_back(std::isnan(x) ? -1 : encoders[v].bin_of(x));
      if (bin[v].back() >= 0) ++count[std::size_t(bin[v].back())];
    }
    if (count.size() > 1) coverage.fewest = std::min(coverage.fewest, *std::min_element(count.begin(), count.end()));
  }
  double pairs = 0, met = 0;
  for (std::size_t a = 0; a < encoders.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const auto wide = std::size_t(encoders[b].bin_count());
      if (encoders[a].bin_count() < 2 || wide < 2) continue;
      std::vector<char> seen(std::size_t(encoders[a].bin_count()) * wide, 0);
      for (std::size_t n = 0; n < table.row_count(); ++n)
        if (bin[a][n] >= 0 && bin[b][n] >= 0) seen[std::size_t(bin[a][n]) * wide + std::size_t(bin[b][n])] = 1;
      pairs += double(seen.size());
      met += double(std::count(seen.begin(), seen.end(), 1));
    }
  if (pairs > 0) coverage.empty_pairs = 1 - met / pairs;
  return coverage;
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Masked weights, and the qubits that the others need.
struct Connectivity {
  Pairs masked;
  std::size_t qubits = 0, longest_chain = 0;  // 0: not on a graph
};

double share_in(const std::string& text, const std::string& whole) {
  std::size_t used = 0;
  double share = NAN;
  try {
    share = std::stod(text, &used);
  } catch (const std::exception&) {
  }
  if (used != text.size() || !(share >= 0 && share <= 1))
    throw InputError("connectivity \"" + whole + "\": \"" + text + "\" is not a share between 0 and 1");
  return share;
}

Connectivity on_graph(const std::string& name, std::size_t visible, std::size_t hidden, std::uint64_t seed) {
  const std::size_t comma = name.find(',');
  learning::HardwareGraph graph = learning::graph_named(name.substr(0, comma));
  if (comma != std::string::npos)
    graph = learning::without(graph, learning::random_dead_qubits(graph, share_in(name.substr(comma + 1), name), seed));
  const learning::Embedding embedding = learning::embed_biclique(graph, visible, hidden);
  Connectivity result;
  for (const auto& [a, b] : embedding.uncoupled) result.masked.emplace_back(a, b - std::uint32_t(visible));
  for (const auto& chain : embedding.chains) {
    result.qubits += chain.size();
    result.longest_chain = std::max(result.longest_chain, chain.size());
  }
  return result;
}

Connectivity connectivity_named(const std::string& name, std::size_t visible, std::size_t hidden, std::uint64_t seed) {
  constexpr std::uint64_t kSparse = 0x73706172;  // stream of random numbers
  Connectivity result;
  if (name == "full") return result;
  if (name.rfind("sparse:", 0) != 0) return on_graph(name, visible, hidden, seed);
  const double share = share_in(name.substr(7), name);
  for (std::uint32_t i = 0; i < visible; ++i)
    for (std::uint32_t j = 0; j < hidden; ++j)
      if (random_unit(seed, kSparse, i * hidden + j) >= share) result.masked.emplace_back(i, j);
  return result;
}

/// Mean -log of the outcomes' frequencies among the trials [nat]: what a machine without weights reaches at best.
double base_loss(const learning::TrainingTable& table, std::size_t outcomes) {
  std::vector<double> weight(outcomes, 0.0);
  double total = 0, loss = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    weight[table.outcome[n]] += table.weight[n];
    total += table.weight[n];
  }
  for (double w : weight)
    if (w > 0) loss -= w / total * std::log(w / total);
  return loss;
}

Capacity::Machine measured(const TrainingData& data, LearningSettings settings, const std::string& connectivity,
                           int bits, std::uint64_t seed) {
  for (const campaign::Variable& variable : campaign::contract().variables)
    if (!settings.encoders.count(variable.name) && variable.encoder.code != "one_hot")
      settings.encoders[variable.name] = {variable.encoder.code, bits};
  settings.teacher = 0;
  learning::TrainingSettings training = training_settings(settings, data.table.row_count(), 0, seed);
  const learning::VisibleLayout layout = make_layout(data, settings);
  Capacity::Machine machine{.bits = bits,
                            .hidden = training.hidden,
                            .visible = layout.unit_count(),
                            .connectivity = connectivity,
                            .coverage = bin_coverage(layout, data.table),
                            .impossible = {},
                            .variable = {}};
  try {
    const Connectivity pairs = connectivity_named(connectivity, machine.visible, machine.hidden, seed);
    training.masked = pairs.masked;
    machine.qubits = pairs.qubits;
    machine.longest_chain = pairs.longest_chain;
  } catch (const InputError& error) {  // the graph has too few lines
    machine.impossible = error.what();
    return machine;
  }
  machine.couplers = machine.visible * machine.hidden - training.masked.size();
  machine.parameters = machine.couplers + machine.visible + machine.hidden;
  TrainingSampler source(settings, layout, training);
  const learning::CrossValidation folds =
      cross_validate(layout, data.table, training, source.sampler(), settings.folds);
  machine.epochs = folds.best_epoch;
  machine.held_out_loss = INFINITY;
  for (const learning::EpochLog& log : folds.log)
    machine.held_out_loss = std::min(machine.held_out_loss, log.held_out_loss);
  machine.gain = base_loss(data.table, layout.outcome_count()) - machine.held_out_loss;
  return machine;
}

/// One variable's code of another length, all else as in the first combination.
Capacity::Machine measured_with(const TrainingData& data, LearningSettings settings, const CapacityRequest& request,
                                const campaign::Variable& variable, int bits) {
  settings.training.hidden = request.hidden.front();
  const auto given = settings.encoders.find(variable.name);
  settings.encoders[variable.name] = {given == settings.encoders.end() ? variable.encoder.code : given->second.code,
                                      bits};
  settings.edges.erase(variable.name);
  Capacity::Machine machine =
      measured(data, settings, request.connectivity.front(), request.bits.front(), request.seed);
  machine.variable = variable.name;
  machine.bits = bits;
  return machine;
}

std::vector<campaign::Variable> varying_variables(const TrainingData& data) {
  std::vector<campaign::Variable> variables;
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v)
    if (data.lower[v] < data.upper[v]) variables.push_back(campaign::contract().variables[v]);
  return variables;
}

}  // namespace

Capacity measure_capacity(const CapacityRequest& request) {
  LearningSettings settings = trainable_settings(request.learning);
  if (settings.sampler == learning::kEmulator)
    throw InputError("capacity: the sampler emulator has a graph of its own; name graphs by --connectivity");
  TrainingData data = make_training_data(campaign::read_dataset(request.dataset).records, request.design);
  temper_weights(data, settings.importance);
  for (const std::string& name : request.connectivity)  // a wrong name is said before anything is trained
    if (name.rfind("sparse:", 0) == 0)
      share_in(name.substr(7), name);
    else if (name != "full")
      learning::graph_named(name.substr(0, name.find(',')));
  if (request.bits.empty() || request.hidden.empty() || request.connectivity.empty())
    throw InputError("capacity: bits, hidden units and connectivity need one value each at least");
  const std::vector<campaign::Variable> variables = varying_variables(data);
  const std::size_t count = request.bits.size() * request.hidden.size() * request.connectivity.size() +
                            variables.size() * request.variable_bits.size();
  Progress progress("capacity", "machines", count);
  Capacity capacity{.trials = data.table.row_count(),
                    .base_loss = base_loss(data.table, campaign::contract().outcomes.size()),
                    .machines = {}};
  settings.given.insert("hidden");
  std::size_t done = 0;
  for (int bits : request.bits)
    for (std::size_t hidden : request.hidden)
      for (const std::string& name : request.connectivity) {
        settings.training.hidden = hidden;
        capacity.machines.push_back(measured(data, settings, name, bits, request.seed));
        progress.update(++done);
      }
  for (const campaign::Variable& variable : variables)
    for (int bits : request.variable_bits) {
      capacity.machines.push_back(measured_with(data, settings, request, variable, bits));
      progress.update(++done);
    }
  return capacity;
}

Json to_json(const Capacity& capacity) {
  Json machines = Json::array();
  for (const Capacity::Machine& m : capacity.machines) {
    Json entry = Json::Object{{"bits", m.bits},
                              {"hidden", m.hidden},
                              {"connectivity", m.connectivity},
                              {"visible", m.visible},
                              {"fewest_in_a_bin", m.coverage.fewest},
                              {"empty_pairs_of_bins", m.coverage.empty_pairs}};
    if (m.impossible.empty()) {
      entry["couplers"] = m.couplers;
      entry["parameters"] = m.parameters;
      entry["qubits"] = m.qubits;
      entry["longest_chain"] = m.longest_chain;
      entry["epochs"] = m.epochs;
      entry["held_out_loss_nat"] = m.held_out_loss;
      entry["gain_nat"] = m.gain;
    } else {
      entry["impossible"] = m.impossible;
    }
    if (!m.variable.empty()) entry["variable"] = m.variable;
    machines.push_back(std::move(entry));
  }
  return Json::Object{
      {"trials", capacity.trials}, {"base_loss_nat", capacity.base_loss}, {"machines", std::move(machines)}};
}

std::string capacity_text(const Capacity& capacity) {
  std::string text = line("%zu trials; %.4f nat without any variable\n", capacity.trials, capacity.base_loss);
  const auto heading = [&](const char* what) {
    text += line("%5s %7s %7s %-20s %9s %10s %7s %10s %8s %8s %8s\n", "bits", "visible", "hidden", what, "couplers",
                 "parameters", "qubits", "held out", "gain", "fewest", "empty");
  };
  heading("connectivity");
  bool of_variables = false;
  for (const Capacity::Machine& m : capacity.machines) {
    if (!of_variables && !m.variable.empty()) {
      of_variables = true;
      text += "\none variable with other bits, the others as in the first line:\n";
      heading("variable");
    }
    text += line("%5d %7zu %7zu %-20s ", m.bits, m.visible, m.hidden,
                 (m.variable.empty() ? m.connectivity : m.variable).c_str());
    text += m.impossible.empty()
                ? line("%9zu %10zu %7zu %10.4f %8.4f %8zu %7.1f%%\n", m.couplers, m.parameters, m.qubits,
                       m.held_out_loss, m.gain, m.coverage.fewest, 100 * m.coverage.empty_pairs)
                : m.impossible + "\n";
  }
  return text + "fewest: trials in the emptiest bin; empty: pairs of bins of two variables without a trial\n";
}

std::string capacity_csv(const Capacity& capacity) {
  std::string text =
      "connectivity,variable,bits,visible,hidden,couplers,parameters,qubits,longest_chain,epochs,held_out_loss_nat,"
      "gain_nat,fewest_in_a_bin,empty_pairs_of_bins\n";
  for (const Capacity::Machine& m : capacity.machines) {
    text += line("\"%s\",%s,%d,%zu,%zu,", m.connectivity.c_str(), m.variable.c_str(), m.bits, m.visible, m.hidden);
    text += m.impossible.empty()
                ? line("%zu,%zu,%zu,%zu,%zu,", m.couplers, m.parameters, m.qubits, m.longest_chain, m.epochs) +
                      Json(m.held_out_loss).dump() + "," + Json(m.gain).dump() + ","
                : ",,,,,,,";
    text += line("%zu,", m.coverage.fewest) + Json(m.coverage.empty_pairs).dump() + "\n";
  }
  return text;
}

}  // namespace gonogo::outcome
