#include "pipeline/app/run/run.h"

#include <cstdio>
#include <map>

#include "base/file.h"
#include "base/lock.h"
#include "base/nearest.h"
#include "base/progress.h"
#include "base/version.h"
#include "learning/model/model.h"
#include "pipeline/app/run/stage.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/learn/training/other_fidelity.h"
#include "pipeline/learn/training/train_model.h"
#include "pipeline/map/region/area.h"
#include "pipeline/map/write/map_record.h"
#include "pipeline/map/write/map_request.h"

namespace gonogo::app {
namespace {

std::string program() { return std::string(program_version()) + " (" + program_revision() + ")"; }

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
  return learn::finest_first(files);
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
  inputs["program"] = program();
  inputs["dataset.h5"] = path_hash(plan.dataset());
  for (const auto& file : plan.with) inputs["with"].push_back(path_hash(file));
  inputs["seed"] = plan.study.seed;
  Json& learning = inputs["learning"] = learn::to_json(plan.learning);
  learning["given"] = section_json(plan.study, "learning");  // the other settings follow the number of trials
  inputs["design"] = section_json(plan.study, "design");
  return {.name = "train", .outputs = {"model.h5"}, .inputs = inputs, .work = [&plan, &files] {
            learn::train_model({.dataset = files.front(),
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
  inputs["program"] = program();
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

/// What was made from what, read back from the files themselves: the same after a first and after a second run.
Json make_record(const RunPlan& plan) {
  Json record = Json::object();
  record["schema"] = "gonogo/run/1";
  record["study"] = plan.study.name;
  record["program"] = program();
  record["dataset_hash"] = path_hash(plan.dataset());
  record["model_hash"] = path_hash(plan.model());
  record["map_hash"] = path_hash(plan.map_folder());
  record["trials"] = campaign::to_json(campaign::summarise(campaign::read_dataset(plan.dataset()).records));
  record["model"] = learning::read_model(plan.model()).provenance;
  record["map"] = Json::read(plan.map_folder() / "map.json");
  return record;
}

std::string trials_line(const Json& trials) {
  std::map<std::string, std::size_t> by_verdict, by_reason;
  for (const auto& [name, count] : trials.at("verdicts").members()) by_verdict[name] = std::size_t(count.integer());
  for (const auto& [name, count] : trials.at("reasons").members()) by_reason[name] = std::size_t(count.integer());
  return std::to_string(trials.at("trials").integer()) + ": " + campaign::counts_line(by_verdict, by_reason);
}

std::string score_line(const Json& model) {
  const Json& scores = model.at("cross_validation");
  char text[160];
  std::snprintf(text, sizeof text, "Brier score of P(go) on unseen trials %.4f (base rate %.4f), accuracy %.3f",
                scores.at("model").at("brier").number(), scores.at("base_rate").at("brier").number(),
                scores.at("model").at("accuracy").number());
  return text;
}

std::string area_line(const Json& map) {
  const map::AreaCount area = map::AreaCount::from_json(map.at("area"));
  char text[64];
  std::snprintf(text, sizeof text, "%.2f km2:", map.at("area_km2").number());
  std::string line = text;
  for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts) {
    std::snprintf(text, sizeof text, " %.1f %% %s,", 100 * area.share(campaign::Verdict(verdict.code)),
                  verdict.label.c_str());
    line += text;
  }
  line.pop_back();
  return line;
}

}  // namespace

RunSummary run_study(const RunRequest& request) {
  const RunPlan plan = plan_run(request);
  const FolderLock lock(plan.out);
  RunSummary summary;
  const auto run = [&](const Stage& stage) {
    if (run_stage(plan.out, stage)) summary.done.push_back(stage.name);
  };
  run(campaign_stage(plan));
  const std::vector<std::filesystem::path> files = learned_trials(plan);
  run(training_stage(plan, files));
  run(map_stage(plan, files.front()));
  summary.map_folder = plan.map_folder();
  summary.record = make_record(plan);
  write_file_atomically(plan.out / "run.json", summary.record.dump(2) + "\n");
  return summary;
}

std::string to_text(const RunSummary& summary) {
  const Json& record = summary.record;
  std::string text = summary.done.empty() ? "nothing had changed: no stage was done again\n"
                                          : "stages done: " + join_words(summary.done) + "\n";
  text += "trials  " + trials_line(record.at("trials")) + "\n";
  text += "model   " + score_line(record.at("model")) + "\n";
  text += "area    " + area_line(record.at("map")) + "\n";
  return text + "map     " + (summary.map_folder / "index.html").string() + "\n";
}

}  // namespace gonogo::app
