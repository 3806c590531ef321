// gonogo run, the main job: from a study to the map of its region.
//
//   <out>/trials/<key>/  finished trials of one set of inputs (campaign.h); changed inputs get a folder of their own
//   <out>/dataset.h5     the trials of this study
//   <out>/model.h5       trained on them, and on those that the study names in learning.with; of the finest fidelity
//   <out>/map/           layers, figure, area table
//   <out>/run.json       what was made from what, and its summary
//   <out>/stamps/        what each stage read and wrote, as hashes; it is done again only when they differ
#include <memory>

#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "learning/model/model.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/app/run/stage.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/map/evaluate/cell.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/outcome/prior/other_trials.h"
#include "pipeline/outcome/settings.h"
#include "pipeline/outcome/training/train_model.h"

namespace gonogo::app {
namespace {

struct RunRequest {
  std::filesystem::path study, out;
};

struct RunPlan {
  campaign::Study study;
  std::filesystem::path out;
  int threads = 0;  // 0: all cores
  campaign::CampaignRequest campaign;
  outcome::LearningSettings learning;
  std::vector<std::filesystem::path> with;  // datasets of other fidelities that the model learns too
  map::Region region;
  map::MapRules map;

  std::filesystem::path dataset() const { return out / "dataset.h5"; }
  std::filesystem::path model() const { return out / "model.h5"; }
  std::filesystem::path map_folder() const { return out / "map"; }
};

constexpr int kKeyLength = 12;

/// Folder name for the trials of one set of inputs.
std::string key_of(const campaign::CampaignRequest& campaign) {
  std::string text;
  for (const auto& [name, value] : campaign.depends_on) text += name + '\n' + value + '\n';
  return content_hash(text).substr(0, kKeyLength);
}

void require_file(const campaign::Study& study, const std::string& key, const std::filesystem::path& file) {
  if (file.empty()) study.config.fail(key, "missing; name the JSON file of the " + key);
}

/// Reads the first, the middle and the last row: a file cut short shows.
void check_readable(const terrain::RasterSource& source) {
  const auto& grid = source.grid();
  for (const int row : {0, grid.rows / 2, grid.rows - 1}) source.read({0, row, grid.columns, 1});
}

/// Opens the rasters and reads in them, so that what cannot be read, and ground of another gravity, is known before
/// hours of simulation.
void check_rasters(const map::Region& region, double gravity) {
  const map::MapSources sources = map::open_sources(region);
  map::require_gravity(region, sources.elevation.grid().body_radius, gravity);
  check_readable(sources.elevation);
  for (const auto* raster : {&sources.soil_class, &sources.land_cover, &sources.moisture, &sources.cone_index})
    if (*raster) check_readable(**raster);
}

/// Trials of other fidelities, checked against what this study is going to simulate.
std::vector<std::filesystem::path> trials_beside(const campaign::Study& study) {
  auto files = outcome::named_trials(study.config.object_if("learning"));
  if (files.empty()) return files;
  campaign::Provenance own;
  own.study = study.config.json().dump();
  own.files = {{"vehicle", read_file(study.vehicle)},
               {"calibration", read_file(study.section("soil").path("calibration"))}};
  outcome::read_other_trials(own, study.file.string(), files);  // throws where they cannot be learned together
  return files;
}

/// Reads the study and every file it names, and opens the rasters. Throws InputError for the first that cannot be used.
/// Writes nothing.
RunPlan plan_run(const RunRequest& request, int threads) {
  campaign::Study study = campaign::read_study(request.study);
  require_file(study, "vehicle", study.vehicle);
  require_file(study, "region", study.region);
  campaign::ComputeRequest compute;
  compute.threads = threads;
  campaign::CampaignRequest campaign = campaign::plan_study_campaign(study, request.out, compute);
  campaign.folder = request.out / "trials" / key_of(campaign);
  RunPlan plan{.study = study,
               .out = request.out,
               .threads = threads,
               .campaign = std::move(campaign),
               .learning = outcome::trainable_settings(study.config.object_if("learning")),
               .with = trials_beside(study),
               .region = map::read_region(study.region),
               .map = map::read_map_rules(study.config.object_if("map"))};
  check_rasters(plan.region, plan.study.gravity);
  if (!plan.map.cone_index_of.empty())
    map::read_cone_index_need(plan.map.cone_index_of);
  else if (plan.region.cone_index)
    study.config.fail("map.cone_index_of",
                      "missing; name the vehicle that the region's cone_index raster is held against");
  return plan;
}

/// A section of the study as it stands in the file; null when it is not there.
Json section_json(const campaign::Study& study, const std::string& key) {
  const Json* section = study.config.json().find(key);
  return section ? *section : Json();
}

Stage campaign_stage(const RunPlan& plan) {
  Json inputs = Json::object();
  for (const auto& [name, value] : plan.campaign.depends_on) inputs[name] = value;
  inputs["trials"] = std::uint64_t(plan.campaign.design.size());
  return {.name = "campaign", .outputs = {"dataset.h5"}, .inputs = inputs, .work = [&plan] {
            const campaign::CampaignSummary summary = campaign::run_campaign(plan.campaign);
            write_file_atomically(plan.dataset(), read_file(summary.dataset));
          }};
}

/// The study's trials and those that it learns beside them, the finest first. The model answers for the first.
std::vector<std::filesystem::path> learned_trials(const RunPlan& plan) {
  std::vector<std::filesystem::path> files{plan.dataset()};
  files.insert(files.end(), plan.with.begin(), plan.with.end());
  return outcome::finest_first(files);
}

/// The section "design" that the trials of this dataset were drawn by.
std::optional<Config> design_of(const RunPlan& plan, const std::filesystem::path& dataset) {
  if (dataset == plan.dataset()) return plan.study.config.object_if("design");
  const std::string text = campaign::read_dataset(dataset).provenance.study;
  return Config::parse(text, dataset.string() + ": study").object_if("design");
}

/// `files`: of learned_trials().
Stage training_stage(const RunPlan& plan, const std::vector<std::filesystem::path>& files) {
  Json inputs = Json::object();
  inputs["program"] = campaign::campaign_program();
  inputs["dataset.h5"] = path_hash(plan.dataset());
  for (const auto& file : plan.with) inputs["with"].push_back(path_hash(file));
  inputs["seed"] = plan.study.seed;
  Json& learning = inputs["learning"] = outcome::to_json(plan.learning);
  learning["given"] = section_json(plan.study, "learning");  // the other settings follow the number of trials
  inputs["design"] = section_json(plan.study, "design");
  return {.name = "train", .outputs = {"model.h5"}, .inputs = inputs, .work = [&plan, &files] {
            outcome::train_model({.dataset = files.front(),
                                  .model = plan.model(),
                                  .seed = plan.study.seed,
                                  .learning = plan.study.config.object_if("learning"),
                                  .design = design_of(plan, files.front()),
                                  .others = {files.begin() + 1, files.end()}});
          }};
}

/// `dataset`: the trials that the model answers for.
Stage map_stage(const RunPlan& plan, const std::filesystem::path& dataset) {
  Json inputs = Json::object();
  inputs["program"] = campaign::campaign_program();
  inputs["model.h5"] = path_hash(plan.model());
  inputs["dataset.h5"] = path_hash(dataset);
  inputs["region"] = path_hash(plan.region.file);
  for (const auto& [role, hash] : map::raster_hashes(plan.region)) inputs[role] = hash;
  inputs["map"] = section_json(plan.study, "map");
  if (!plan.map.cone_index_of.empty()) inputs["cone_index_of"] = path_hash(plan.map.cone_index_of);
  return {.name = "map", .outputs = {"map"}, .inputs = inputs, .work = [&plan, &dataset] {
            map::make_map(map::read_map_request({.model = plan.model(),
                                                 .region = {},
                                                 .study = plan.study.file,
                                                 .dataset = dataset,
                                                 .out = plan.map_folder(),
                                                 .threads = plan.threads}));
          }};
}

struct RunSummary {
  std::vector<std::string> done;  // stages of this call: "campaign", "train", "map"
  std::filesystem::path map_folder;
  campaign::DatasetSummary trials;
  Json model, map;  // provenance of the model, content of map.json
};

/// What was made from what, read from the files themselves: the same after a first and after a second run.
RunSummary summary_of(const RunPlan& plan, const std::vector<std::string>& done) {
  return {.done = done,
          .map_folder = plan.map_folder(),
          .trials = campaign::summarise(campaign::read_dataset(plan.dataset()).records),
          .model = learning::read_model(plan.model()).provenance,
          .map = Json::read(plan.map_folder() / "map.json")};
}

/// The content of run.json.
Json record_of(const RunPlan& plan, const RunSummary& summary) {
  Json record = Json::object();
  record["schema"] = "gonogo/run/1";
  record["study"] = plan.study.name;
  record["program"] = campaign::campaign_program();
  record["dataset_hash"] = path_hash(plan.dataset());
  record["model_hash"] = path_hash(plan.model());
  record["map_hash"] = path_hash(plan.map_folder());
  record["trials"] = campaign::to_json(summary.trials);
  record["model"] = summary.model;
  record["map"] = summary.map;
  return record;
}

std::string score_line(const Json& model) {
  const Json& scores = model.at("cross_validation");
  return line("Brier score of P(go) on unseen trials %.4f (base rate %.4f), accuracy %.3f",
              scores.at("model").at("brier").number(), scores.at("base_rate").at("brier").number(),
              scores.at("model").at("accuracy").number());
}

std::string area_line(const Json& map) {
  const map::AreaCount area = map::AreaCount::from_json(map.at("area"));
  std::string text = line("%.2f km2:", map.at("area_km2").number());
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
    text += line(" %.1f %% %s,", 100 * area.share(campaign::Verdict(verdict.code)), verdict.label.c_str());
  text.pop_back();
  return text;
}

/// For people: trials by verdict, score of the model, area by class, path of the map.
std::string to_text(const RunSummary& summary) {
  const campaign::DatasetSummary& trials = summary.trials;
  std::string text = summary.done.empty() ? "nothing had changed: no stage was done again\n"
                                          : "stages done: " + join_words(summary.done) + "\n";
  text += "trials  " + std::to_string(trials.trials) + ": " +
          campaign::counts_line(trials.by_verdict, trials.by_reason) + "\n";
  text += "model   " + score_line(summary.model) + "\n";
  text += "area    " + area_line(summary.map) + "\n";
  return text + "map     " + (summary.map_folder / "index.html").string() + "\n";
}

/// Does the stages that are not up to date. Throws InputError before any work when something cannot be used,
/// DeviceError when a library or the system fails, Cancelled on Ctrl-C. Finished trials and stages are kept: the same
/// call continues.
void run_study(const Globals& globals, const RunRequest& request) {
  const RunPlan plan = plan_run(request, globals.threads);
  const FileLock lock = lock_folder(plan.out);
  std::vector<std::string> done;
  const auto run = [&](const Stage& stage) {
    if (run_stage(plan.out, stage)) done.push_back(stage.name);
  };
  run(campaign_stage(plan));
  const std::vector<std::filesystem::path> files = learned_trials(plan);
  run(training_stage(plan, files));
  run(map_stage(plan, files.front()));
  const RunSummary summary = summary_of(plan, done);
  const Json record = record_of(plan, summary);
  write_file_atomically(plan.out / "run.json", record.dump(2) + "\n");
  print_result(globals, record, to_text(summary));
}

}  // namespace

void add_run_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("run", "The main job: simulate, learn and map what a study asks for");
  const auto request = std::make_shared<RunRequest>();
  add_named(*command, "study", request->study, kStudy, "JSON file of the study")->required();
  add_named(*command, "--out", request->out, kFolder,
            "Folder for the results; the same folder continues an interrupted run")
      ->required();
  add_examples(*command, {"gonogo run configs/studies/demo.json --out out/demo"},
               "Trials, training and map are each done only when something they depend on has changed.");
  calls<run_study>(*command, globals, request);
}

}  // namespace gonogo::app
