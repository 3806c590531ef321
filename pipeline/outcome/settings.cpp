#include "pipeline/outcome/settings.h"

#include <algorithm>

#include "base/files/file.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "learning/encoding/encoder.h"
#include "learning/sampler/sampler.h"

namespace gonogo::outcome {
namespace {

void read_encoders(const Config& section, LearningSettings& settings) {
  for (const auto& [name, entry] : section.members()) {
    campaign::contract().variable_index(name);
    campaign::EncoderSpec spec;
    spec.code = entry.choice("code", learning::code_names());
    if (entry.has("edges") && entry.has("bits")) entry.fail("edges", "say how many bins there are; leave out bits");
    if (entry.has("edges"))
      settings.edges[name] = entry.numbers("edges");
    else
      spec.bits = int(entry.integer(
          "bits",
          {.minimum = 1, .maximum = learning::has_all_words(learning::code_from_name(spec.code)) ? 8.0 : 64.0}));
    entry.finish();
    settings.encoders[name] = spec;
  }
}

bool draws_here(const learning::SamplerKind& kind) { return kind.draws_here(); }

bool runs_alone(const learning::SamplerKind& kind) {
  return kind.origin != learning::RowOrigin::person && kind.follows_energies;
}

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
  choice.post_sweeps =
      std::size_t(section->integer_or("post_sweeps", std::int64_t(choice.post_sweeps), {.minimum = 0, .maximum = 1e6}));
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
  json["post_sweeps"] = Json(std::uint64_t(choice.post_sweeps));
  return json;
}

LearningSettings read_learning_settings(const std::optional<Config>& section) {
  LearningSettings settings;
  if (!section) return settings;
  for (const auto& [key, value] : section->json().members()) settings.given.insert(key);
  learning::TrainingSettings& training = settings.training;
  const auto count = [&](const char* key, std::size_t fallback, double least, double most) {
    return std::size_t(section->integer_or(key, std::int64_t(fallback), {.minimum = least, .maximum = most}));
  };
  if (section->has("sampler"))
    settings.sampler = section->choice("sampler", learning::sampler_names_and_emulator(runs_alone));
  if (settings.sampler == learning::kEmulator) settings.emulator = read_emulator_choice(section->object_if("emulator"));
  if (section->has("gpu")) settings.gpu = section->choice("gpu", {"auto", "never"}) == "auto";
  if (settings.sampler == "command") settings.command = section->texts("command");
  if (section->has("with")) section->texts("with");  // named_trials() finds them
  if (section->has("stand_in")) settings.stand_in = section->choice("stand_in", learning::sampler_names(draws_here));
  training.hidden = count("hidden", training.hidden, 1, 1024);
  training.epochs = count("epochs", training.epochs, 1, 1e6);
  training.batch = count("batch", training.batch, 1, 1e6);
  training.chains = count("chains", training.chains, 1, 1e6);
  training.sweeps = count("sweeps", training.sweeps, 1, 1e6);
  settings.folds = count("folds", settings.folds, 2, 100);
  training.learning_rate = section->number_or("learning_rate", training.learning_rate, {.minimum = 1e-6, .maximum = 1});
  training.weight_decay = section->number_or("weight_decay", training.weight_decay, {.minimum = 0, .maximum = 1e6});
  training.generative = section->number_or("generative", training.generative, {.minimum = 0, .maximum = 100});
  training.discriminative =
      section->number_or("discriminative", training.discriminative, {.minimum = 0, .maximum = 100});
  training.final_learning_rate =
      section->number_or("final_learning_rate", training.final_learning_rate, {.minimum = 0, .maximum = 1});
  training.momentum = section->number_or("momentum", training.momentum, {.minimum = 0, .maximum = 0.999});
  training.rungs = count("rungs", training.rungs, 2, 64);
  training.centred = section->boolean_or("centred", training.centred);
  if (section->has("optimizer"))
    training.optimizer = learning::optimizer_named(section->choice("optimizer", {"adam", "sgd"}));
  if (section->has("gradients"))
    training.gradients = learning::gradient_device_named(section->choice("gradients", {"cpu", "cuda"}));
  if (section->has("negative"))
    training.negative = learning::negative_phase_named(
        section->choice("negative", {"persistent", "contrastive", "tempering", "trajectory", "code_words"}));
  if (training.negative != learning::NegativePhaseKind::persistent && settings.sampler != "block_gibbs")
    section->fail("negative", "only persistent chains can come from the sampler " + settings.sampler);
  settings.importance = section->number_or("importance", settings.importance, {.minimum = 0, .maximum = 1});
  if (section->has("teacher")) settings.teacher = section->number("teacher", {.minimum = 0, .maximum = 100});
  settings.calibrate = section->boolean_or("calibrate", settings.calibrate);
  if (section->has("unknown_inputs"))
    settings.uniform_inputs = section->choice("unknown_inputs", {"prior", "machine"}) == "prior";
  if (section->has("bins")) settings.quantile_bins = section->choice("bins", {"range", "quantile"}) == "quantile";
  if (const auto encoders = section->object_if("encoders")) read_encoders(*encoders, settings);
  section->finish();
  return settings;
}

namespace {

// Of the weights. Beside many trials a teacher needs half of the updates that the trials alone need.
constexpr std::size_t kManyUpdates = 7000, kTaughtUpdates = 3500, kFewUpdates = 4000;

/// Trials of a minibatch. Unless the study gives it, an epoch has at most 32 minibatches.
std::size_t batch_size(const LearningSettings& settings, std::size_t trials) {
  constexpr std::size_t kMaxBatches = 32;
  return settings.given.count("batch") ? settings.training.batch
                                       : std::max(settings.training.batch, trials / kMaxBatches);
}

}  // namespace

LearningSettings settings_for_trials(LearningSettings settings, std::size_t trials, std::size_t others) {
  learning::TrainingSettings& training = settings.training;
  const bool other_rows =
      settings.sampler != "block_gibbs" ||
      (settings.given.count("negative") && training.negative != learning::NegativePhaseKind::code_words);
  if (other_rows) return settings;
  const bool many = trials + others >= kManyTrials;
  // Points of a teacher that share in the joint distribution keep its large weight from blurring the edge.
  const bool is_taught = settings.teacher.value_or(1) > 0 && settings.importance == 1;
  const bool is_followed = many && settings.teacher.value_or(1) > 0;  // the teacher, as closely as the machine can
  const auto set = [&](const char* key, auto& value, auto chosen) {
    if (!settings.given.count(key)) value = chosen;
  };
  set("negative", training.negative, learning::NegativePhaseKind::code_words);
  set("hidden", training.hidden, std::size_t(many ? 48 : 16));
  set("generative", training.generative, is_followed ? 0.3 : many ? 0.1 : is_taught ? 0.6 : 0.07);
  set("weight_decay", training.weight_decay, many ? 0.3 : 1.0);
  set("chains", training.chains, std::size_t(256));
  set("learning_rate", training.learning_rate, 0.03);
  set("calibrate", settings.calibrate, many);
  set("sweeps", training.sweeps, std::size_t(1));
  set("final_learning_rate", training.final_learning_rate, 0.05);
  set("batch", training.batch, std::size_t(is_followed ? 64 : 32));
  set("teacher", settings.teacher, std::optional(many ? 30.0 : 10.0));
  settings.taught_points = is_followed ? 16384 : 2048;
  const std::size_t updates = std::max<std::size_t>(1, trials / batch_size(settings, trials));  // of an epoch
  const std::size_t wanted = is_followed ? kTaughtUpdates : many ? kManyUpdates : kFewUpdates;
  set("epochs", training.epochs, std::max<std::size_t>(1, wanted / updates));
  return settings;
}

learning::TrainingSettings training_settings(const LearningSettings& settings, std::size_t trials, std::size_t others,
                                             std::uint64_t seed) {
  learning::TrainingSettings training = settings_for_trials(settings, trials, others).training;
  training.seed = seed;
  training.batch = batch_size(settings, trials);
  return training;
}

Json to_json(const LearningSettings& settings) {
  const learning::TrainingSettings& training = settings.training;
  Json json = Json::object(), encoders = Json::object();
  json["sampler"] = settings.sampler;
  json["hidden"] = Json(std::uint64_t(training.hidden));
  json["epochs"] = Json(std::uint64_t(training.epochs));
  json["batch"] = settings.given.count("batch") ? Json(std::uint64_t(training.batch)) : Json("auto");
  json["learning_rate"] = training.learning_rate;
  json["weight_decay"] = training.weight_decay;
  json["generative"] = training.generative;
  json["discriminative"] = training.discriminative;
  json["final_learning_rate"] = training.final_learning_rate;
  json["momentum"] = training.momentum;
  json["rungs"] = Json(std::uint64_t(training.rungs));
  json["centred"] = training.centred;
  json["optimizer"] = learning::optimizer_name(training.optimizer);
  json["negative"] = learning::negative_phase_name(training.negative);
  json["chains"] = Json(std::uint64_t(training.chains));
  json["sweeps"] = Json(std::uint64_t(training.sweeps));
  json["folds"] = Json(std::uint64_t(settings.folds));
  json["importance"] = settings.importance;
  json["teacher"] = settings.teacher ? Json(*settings.teacher) : Json("auto");
  json["calibrate"] = settings.calibrate;
  json["unknown_inputs"] = settings.uniform_inputs ? "prior" : "machine";
  json["gpu"] = settings.gpu ? "auto" : "never";
  json["gradients"] = learning::gradient_device_name(training.gradients);
  if (settings.sampler == learning::kEmulator) json["emulator"] = to_json(settings.emulator);
  if (settings.sampler == "command") {
    json["command"] = Json(settings.command);
    json["stand_in"] = settings.stand_in;
  }
  json["bins"] = settings.quantile_bins ? "quantile" : "range";
  for (const auto& [name, spec] : settings.encoders) {
    Json entry;
    entry["code"] = spec.code;
    if (const auto edges = settings.edges.find(name); edges != settings.edges.end())
      entry["edges"] = Json(edges->second);
    else
      entry["bits"] = spec.bits;
    encoders[name] = std::move(entry);
  }
  json["encoders"] = std::move(encoders);
  return json;
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "with";
constexpr const char* kFile = "dataset.h5";

fs::path find_trials(const Config& section, const std::string& name) {
  fs::path file = section.file().parent_path() / name;
  if (fs::is_regular_file(file)) return file;
  std::vector<std::string> names;
  for (const fs::path& folder : shipped_data_folders(kFile)) {
    if (folder.filename() == name) return folder / kFile;
    names.push_back(folder.filename().string());
  }
  if (name.find('/') != std::string::npos || fs::path(name).extension() == ".h5")
    section.fail(kKey, "\"" + name + "\": there is no file " + file.string() + "; name a dataset.h5 that exists");
  if (names.empty()) section.fail(kKey, "\"" + name + "\": no trials ship beside this program; name a file");
  section.fail(kKey, "\"" + name + "\": no shipped trials have that name (did you mean \"" + nearest_word(name, names) +
                         "\"?); there are: " + join_words(names));
}

}  // namespace

std::vector<fs::path> named_trials(const std::optional<Config>& section) {
  std::vector<fs::path> files;
  if (!section || !section->has(kKey)) return files;
  for (const std::string& name : section->texts(kKey)) {
    fs::path file = find_trials(*section, name);
    const bool is_twice =
        std::any_of(files.begin(), files.end(), [&](const fs::path& other) { return fs::equivalent(other, file); });
    if (is_twice) section->fail(kKey, "\"" + name + "\" is given twice; name each dataset once");
    files.push_back(std::move(file));
  }
  return files;
}

fs::path shipped_trials(const std::string& hash) {
  for (const fs::path& folder : shipped_data_folders(kFile))
    if (file_hash(folder / kFile) == hash) return folder / kFile;
  return {};
}

}  // namespace gonogo::outcome
