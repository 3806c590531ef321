#include "pipeline/learn/training/capacity.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "base/progress.h"
#include "base/random.h"
#include "learning/hardware/embedding.h"
#include "learning/rbm/train.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/learn/training/bin_coverage.h"
#include "pipeline/learn/training/train_model.h"
#include "pipeline/learn/training/training_data.h"
#include "pipeline/learn/training/training_sampler.h"

namespace gonogo::learn {
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
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    weight[table.outcome[n]] += table.weight[n];
    total += table.weight[n];
  }
  for (double w : weight)
    if (w > 0) loss -= w / total * std::log(w / total);
  return loss;
}

Json measured(const TrainingData& data, LearningSettings settings, const std::string& connectivity, int bits,
              std::uint64_t seed) {
  for (const campaign::Variable& variable : campaign::contract().variables)
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
  const BinCoverage coverage = bin_coverage(layout, data.table);
  entry["fewest_in_a_bin"] = Json(std::uint64_t(coverage.fewest));
  entry["empty_pairs_of_bins"] = coverage.empty_pairs;
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

/// One variable's code of another length, all else as in the first combination.
Json measured_with(const TrainingData& data, LearningSettings settings, const CapacityRequest& request,
                   const campaign::Variable& variable, int bits) {
  settings.training.hidden = request.hidden.front();
  const auto given = settings.encoders.find(variable.name);
  settings.encoders[variable.name] = {given == settings.encoders.end() ? variable.encoder.code : given->second.code,
                                      bits};
  settings.edges.erase(variable.name);
  Json entry = measured(data, settings, request.connectivity.front(), request.bits.front(), request.seed);
  entry["variable"] = variable.name;
  entry["bits"] = std::int64_t(bits);
  return entry;
}

std::vector<campaign::Variable> varying(const TrainingData& data) {
  std::vector<campaign::Variable> variables;
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v)
    if (data.lower[v] < data.upper[v]) variables.push_back(campaign::contract().variables[v]);
  return variables;
}

/// "" for machines of all variables alike.
std::string variable_of(const Json& machine) {
  const Json* name = machine.find("variable");
  return name ? name->string() : "";
}

}  // namespace

Json measure_capacity(const CapacityRequest& request) {
  LearningSettings settings = trainable_settings(request.learning);
  if (settings.sampler == "emulator")
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
  const std::vector<campaign::Variable> variables = varying(data);
  const std::size_t count = request.bits.size() * request.hidden.size() * request.connectivity.size() +
                            variables.size() * request.variable_bits.size();
  Progress progress("capacity", "machines", count);
  Json report, entries = Json::array();
  settings.given.insert("hidden");
  std::size_t done = 0;
  for (int bits : request.bits)
    for (std::size_t hidden : request.hidden)
      for (const std::string& name : request.connectivity) {
        settings.training.hidden = hidden;
        entries.push_back(measured(data, settings, name, bits, request.seed));
        progress.update(++done);
      }
  for (const campaign::Variable& variable : variables)
    for (int bits : request.variable_bits) {
      entries.push_back(measured_with(data, settings, request, variable, bits));
      progress.update(++done);
    }
  report["trials"] = Json(std::uint64_t(data.table.row_count()));
  report["base_loss_nat"] = base_loss(data.table, campaign::contract().outcomes.size());
  report["machines"] = std::move(entries);
  return report;
}

std::string capacity_text(const Json& report) {
  std::string text = line("%lld trials; %.4f nat without any variable\n",
                          static_cast<long long>(report.at("trials").integer()), report.at("base_loss_nat").number());
  bool of_variables = false;
  const auto heading = [&] {
    text += line("%5s %7s %7s %-20s %9s %10s %7s %10s %8s %8s %8s\n", "bits", "visible", "hidden",
                 of_variables ? "variable" : "connectivity", "couplers", "parameters", "qubits", "held out", "gain",
                 "fewest", "empty");
  };
  heading();
  for (const Json& m : report.at("machines").items()) {
    const auto whole = [&](const char* key) { return static_cast<long long>(m.at(key).integer()); };
    const std::string variable = variable_of(m);
    if (!of_variables && !variable.empty()) {
      of_variables = true;
      text += "\none variable with other bits, the others as in the first line:\n";
      heading();
    }
    text += line("%5lld %7lld %7lld %-20s ", whole("bits"), whole("visible"), whole("hidden"),
                 variable.empty() ? m.at("connectivity").string().c_str() : variable.c_str());
    if (const Json* reason = m.find("impossible")) {
      text += reason->string() + "\n";
      continue;
    }
    text += line("%9lld %10lld %7lld %10.4f %8.4f %8lld %7.1f%%\n", whole("couplers"), whole("parameters"),
                 whole("qubits"), m.at("held_out_loss_nat").number(), m.at("gain_nat").number(),
                 whole("fewest_in_a_bin"), 100 * m.at("empty_pairs_of_bins").number());
  }
  return text + "fewest: trials in the emptiest bin; empty: pairs of bins of two variables without a trial\n";
}

std::string capacity_csv(const Json& report) {
  const std::vector<const char*> keys = {
      "bits",   "visible",           "hidden",   "couplers",        "parameters",         "qubits", "longest_chain",
      "epochs", "held_out_loss_nat", "gain_nat", "fewest_in_a_bin", "empty_pairs_of_bins"};
  std::string text = "connectivity,variable";
  for (const char* key : keys) text += std::string(",") + key;
  text += "\n";
  for (const Json& m : report.at("machines").items()) {
    text += "\"" + m.at("connectivity").string() + "\"," + variable_of(m);
    for (const char* key : keys) text += "," + (m.find(key) ? m.at(key).dump() : std::string());
    text += "\n";
  }
  return text;
}

}  // namespace gonogo::learn
