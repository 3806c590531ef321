#include "pipeline/learn/capacity.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/progress.h"
#include "base/random.h"
#include "learning/hardware/embedding.h"
#include "learning/rbm/train.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/learn/training_data.h"
#include "pipeline/learn/training_sampler.h"

namespace gonogo::pipeline {
namespace {

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Which weights there are, and what they cost on hardware.
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
  for (std::size_t n = 0; n < table.row_count(); ++n)
    weight[table.outcome[n]] += table.weight[n], total += table.weight[n];
  for (double w : weight)
    if (w > 0) loss -= w / total * std::log(w / total);
  return loss;
}

Json measured(const TrainingData& data, LearningSettings settings, const std::string& connectivity, int bits,
              std::uint64_t seed) {
  for (const Variable& variable : contract().variables)
    if (!settings.encoders.count(variable.name) && variable.encoder.code != "one_hot")
      settings.encoders[variable.name] = {variable.encoder.code, bits};
  learning::TrainingSettings training = training_settings(settings, data.table.row_count(), seed);
  const learning::VisibleLayout layout = make_layout(data, settings);
  const std::size_t visible = layout.unit_count(), hidden = training.hidden;
  Json entry;
  entry["bits"] = std::int64_t(bits);
  entry["hidden"] = Json(std::uint64_t(hidden));
  entry["connectivity"] = connectivity;
  entry["visible"] = Json(std::uint64_t(visible));
  Connectivity pairs;
  try {
    pairs = connectivity_named(connectivity, visible, hidden, seed);
  } catch (const InputError& error) {  // the graph has too few lines
    entry["impossible"] = std::string(error.what());
    return entry;
  }
  training.masked = pairs.masked;
  TrainingSampler source(settings, layout, training);
  const learning::CrossValidation folds =
      cross_validate(layout, data.table, training, source.sampler(), settings.folds);
  double best = INFINITY;
  for (const learning::EpochLog& log : folds.log) best = std::min(best, log.held_out_loss);
  const std::size_t weights = visible * hidden - pairs.masked.size();
  entry["couplers"] = Json(std::uint64_t(weights));
  entry["parameters"] = Json(std::uint64_t(weights + visible + hidden));
  entry["qubits"] = Json(std::uint64_t(pairs.qubits));
  entry["longest_chain"] = Json(std::uint64_t(pairs.longest_chain));
  entry["epochs"] = Json(std::uint64_t(folds.best_epoch));
  entry["held_out_loss_nat"] = best;
  entry["gain_nat"] = base_loss(data.table, layout.outcome_count()) - best;
  return entry;
}

}  // namespace

Json measure_capacity(const CapacityRequest& request) {
  LearningSettings settings = read_learning_settings(request.learning);
  if (settings.sampler == "emulator")
    throw InputError("capacity: the sampler emulator has a graph of its own; name graphs by --connectivity");
  const TrainingData data = make_training_data(read_dataset(request.dataset).records, request.design);
  for (const std::string& name : request.connectivity)  // a wrong name is said before anything is trained
    if (name.rfind("sparse:", 0) == 0)
      share_in(name.substr(7), name);
    else if (name != "full")
      learning::graph_named(name.substr(0, name.find(',')));
  const std::size_t count = request.bits.size() * request.hidden.size() * request.connectivity.size();
  Progress progress("capacity", "machines", count);
  Json report, entries = Json::array();
  std::size_t done = 0;
  for (int bits : request.bits)
    for (std::size_t hidden : request.hidden)
      for (const std::string& name : request.connectivity) {
        settings.training.hidden = hidden;
        entries.push_back(measured(data, settings, name, bits, request.seed));
        progress.update(++done);
      }
  report["trials"] = Json(std::uint64_t(data.table.row_count()));
  report["base_loss_nat"] = base_loss(data.table, contract().outcomes.size());
  report["machines"] = std::move(entries);
  return report;
}

std::string capacity_text(const Json& report) {
  char line[256];
  std::snprintf(line, sizeof line,
                "%lld trials; %.4f nat without any variable\n%5s %7s %7s %-20s %9s %10s %7s %10s %8s\n",
                static_cast<long long>(report.at("trials").integer()), report.at("base_loss_nat").number(), "bits",
                "visible", "hidden", "connectivity", "couplers", "parameters", "qubits", "held out", "gain");
  std::string text = line;
  for (const Json& m : report.at("machines").items()) {
    const auto whole = [&](const char* key) { return static_cast<long long>(m.at(key).integer()); };
    std::snprintf(line, sizeof line, "%5lld %7lld %7lld %-20s ", whole("bits"), whole("visible"), whole("hidden"),
                  m.at("connectivity").string().c_str());
    text += line;
    if (const Json* reason = m.find("impossible")) {
      text += reason->string() + "\n";
      continue;
    }
    std::snprintf(line, sizeof line, "%9lld %10lld %7lld %10.4f %8.4f\n", whole("couplers"), whole("parameters"),
                  whole("qubits"), m.at("held_out_loss_nat").number(), m.at("gain_nat").number());
    text += line;
  }
  return text;
}

std::string capacity_csv(const Json& report) {
  const std::vector<const char*> keys = {"bits",   "visible",       "hidden", "couplers",          "parameters",
                                         "qubits", "longest_chain", "epochs", "held_out_loss_nat", "gain_nat"};
  std::string text = "connectivity";
  for (const char* key : keys) text += std::string(",") + key;
  text += "\n";
  for (const Json& m : report.at("machines").items()) {
    text += "\"" + m.at("connectivity").string() + "\"";
    for (const char* key : keys) text += "," + (m.find(key) ? m.at(key).dump() : std::string());
    text += "\n";
  }
  return text;
}

}  // namespace gonogo::pipeline
