#include "pipeline/learn/settings.h"

namespace gonogo::pipeline {
namespace {

std::map<std::string, EncoderSpec> read_encoders(const Config& section) {
  std::map<std::string, EncoderSpec> encoders;
  for (const auto& [name, entry] : section.members()) {
    contract().variable_index(name);
    EncoderSpec spec;
    spec.code = entry.choice("code", {"thermometer", "one_hot", "gray"});
    spec.bits = int(entry.integer("bits", {.minimum = 1, .maximum = spec.code == "gray" ? 8.0 : 64.0}));
    entry.finish();
    encoders[name] = spec;
  }
  return encoders;
}

}  // namespace

LearningSettings read_learning_settings(const std::optional<Config>& section) {
  LearningSettings settings;
  if (!section) return settings;
  const auto count = [&](const char* key, std::size_t fallback, double least, double most) {
    return std::size_t(section->integer_or(key, std::int64_t(fallback), {.minimum = least, .maximum = most}));
  };
  if (section->has("sampler")) settings.sampler = section->choice("sampler", {"block_gibbs", "exact"});
  settings.hidden = count("hidden", settings.hidden, 1, 1024);
  settings.epochs = count("epochs", settings.epochs, 1, 1e6);
  settings.batch = count("batch", settings.batch, 1, 1e6);
  settings.chains = count("chains", settings.chains, 1, 1e6);
  settings.sweeps = count("sweeps", settings.sweeps, 1, 1e6);
  settings.folds = count("folds", settings.folds, 2, 100);
  settings.learning_rate = section->number_or("learning_rate", settings.learning_rate, {.minimum = 1e-6, .maximum = 1});
  settings.weight_decay = section->number_or("weight_decay", settings.weight_decay, {.minimum = 0, .maximum = 1e6});
  settings.generative = section->number_or("generative", settings.generative, {.minimum = 0, .maximum = 100});
  if (section->has("bins")) settings.quantile_bins = section->choice("bins", {"range", "quantile"}) == "quantile";
  if (const auto encoders = section->object_if("encoders")) settings.encoders = read_encoders(*encoders);
  section->finish();
  return settings;
}

Json to_json(const LearningSettings& settings) {
  Json json = Json::object(), encoders = Json::object();
  json["sampler"] = settings.sampler;
  json["hidden"] = Json(std::uint64_t(settings.hidden));
  json["epochs"] = Json(std::uint64_t(settings.epochs));
  json["batch"] = Json(std::uint64_t(settings.batch));
  json["learning_rate"] = settings.learning_rate;
  json["weight_decay"] = settings.weight_decay;
  json["generative"] = settings.generative;
  json["chains"] = Json(std::uint64_t(settings.chains));
  json["sweeps"] = Json(std::uint64_t(settings.sweeps));
  json["folds"] = Json(std::uint64_t(settings.folds));
  json["bins"] = settings.quantile_bins ? "quantile" : "range";
  for (const auto& [name, spec] : settings.encoders) {
    Json entry;
    entry["code"] = spec.code;
    entry["bits"] = spec.bits;
    encoders[name] = std::move(entry);
  }
  json["encoders"] = std::move(encoders);
  return json;
}

}  // namespace gonogo::pipeline
