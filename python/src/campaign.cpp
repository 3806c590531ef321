// Campaigns and their datasets.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/study/contract.h"
#include "python/src/binding.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

nb::dict counts_of(const campaign::Counts& counts) {
  nb::dict result;
  for (const auto& [name, count] : counts) result[name.c_str()] = count;
  return result;
}

/// `worker`: the words that start Python with gonogo.worker, in the place of the program and its command.
Members run_campaign(const std::string& study, const std::string& folder, const std::vector<std::string>& worker,
                     std::optional<int> workers, std::optional<int> places, std::optional<std::string> device,
                     std::size_t trials_per_shard, std::optional<int> gpus) {
  const campaign::CampaignSummary done = long_call([&] {
    campaign::ComputeRequest compute;
    compute.workers = workers;
    compute.places = places;
    compute.device = device;
    compute.gpus = gpus;
    campaign::CampaignRequest request = campaign::plan_study_campaign(campaign::read_study(study), folder, compute);
    constexpr std::ptrdiff_t kProgramWords = 3;  // <program> campaign worker
    auto& words = request.worker_command;
    words.erase(words.begin(), words.begin() + kProgramWords);
    words.insert(words.begin(), worker.begin(), worker.end());
    request.trials_per_shard = trials_per_shard;
    return campaign::run_campaign(request);
  });
  Members summary;
  summary["dataset"] = done.dataset.string();
  summary["trials"] = done.trials;
  summary["computed"] = done.computed;
  summary["reused"] = done.reused;
  summary["verdicts"] = counts_of(done.by_verdict);
  summary["reasons"] = counts_of(done.by_reason);
  return summary;
}

Members status(const std::string& folder) {
  const campaign::CampaignStatus now = long_call([&] { return campaign::campaign_status(folder); });
  Members status;
  status["trials"] = now.trials;
  status["done"] = now.done;
  status["running"] = now.use != campaign::FolderUse::none;
  status["trials_per_second"] = to_python(now.rate);
  status["seconds_left"] = to_python(now.seconds_left);
  status["verdicts"] = counts_of(now.by_verdict);
  status["reasons"] = counts_of(now.by_reason);
  return status;
}

/// Points of a study's design [trial_count, variable_count].
Array<double> design(const std::string& study_file) {
  std::vector<double> points;
  std::size_t count = 0;
  long_call([&] {
    const campaign::Study study = campaign::read_study(study_file);
    const auto design = campaign::make_design(campaign::read_design(study.section("design"), study.seed));
    count = design.size();
    for (const campaign::DesignPoint& p : design) points.insert(points.end(), p.variables.begin(), p.variables.end());
  });
  return array_of(std::move(points), {count, campaign::contract().variables.size()});
}

void run_worker(const std::string& study, const std::string& device, int places, int gpu,
                const std::string& checkpoints, double checkpoint_every, const std::string& courses,
                double course_every) {
  campaign::WorkerOptions options;
  options.device = device == "cuda" ? sim::Backend::cuda : sim::Backend::cpu;
  options.places = places;
  options.gpu = gpu;
  options.checkpoints = checkpoints;
  options.checkpoint_every = checkpoint_every;
  options.courses = courses;
  options.course_every = course_every;
  long_call([&] { campaign::run_study_worker(campaign::read_study(study), options); });
}

}  // namespace

void bind_campaign(nb::module_& m) {
  using namespace nb::literals;
  m.def("run_campaign", &run_campaign, "study"_a, "folder"_a, "worker"_a, "workers"_a.none(), "places"_a.none(),
        "device"_a.none(), "trials_per_shard"_a, "gpus"_a.none() = nb::none(),
        "Computes what is missing. Returns the summary.");
  m.def("campaign_status", &status, "folder"_a, "The progress; may be called while a campaign runs.");
  m.def("design", &design, "study"_a, "Points of a study's design [trial_count, variable_count].");
  m.def("run_worker", &run_worker, "study"_a, "device"_a, "places"_a, "gpu"_a, "checkpoints"_a, "checkpoint_every"_a,
        "courses"_a, "course_every"_a,
        "A worker process of a campaign: points from standard input, trials to standard output.");
}

namespace {

/// Column name -> array [rows], in the order of the program's CSV.
Members columns_of(const campaign::Dataset& dataset) {
  campaign::TrialColumns columns(dataset.records.size());
  for (const campaign::TrialRecord& record : dataset.records) columns.append(record);
  const campaign::Contract& contract = campaign::contract();
  const bool with_task = campaign::has_task_values(dataset.records);
  nb::dict result;
  result["index"] = array_of(std::move(columns.index));
  result["seed"] = array_of(std::move(columns.seed));
  result["replicate_of"] = array_of(std::move(columns.replicate_of));
  result["proposal_density"] = array_of(std::move(columns.proposal_density));
  for (std::size_t v = 0; v < contract.variables.size(); ++v)
    if (campaign::has_column(contract.variables[v], with_task))
      result[contract.variables[v].name.c_str()] = array_of(std::move(columns.variables[v]));
  result["verdict"] = array_of(std::move(columns.verdict));
  result["reason"] = array_of(std::move(columns.reason));
  result["attempts"] = array_of(std::move(columns.attempts));
  result["failed_checks"] = array_of(std::move(columns.failed_checks));
  for (std::size_t k = 0; k < contract.measures.size(); ++k)
    if (campaign::has_column(contract.measures[k], with_task))
      result[contract.measures[k].name.c_str()] = array_of(std::move(columns.measures[k]));
  return result;
}

Members provenance_of(const campaign::Dataset& dataset) {
  const campaign::Provenance& p = dataset.provenance;
  const auto object = [](const campaign::Provenance::Pairs& pairs) {
    Json json = Json::object();
    for (const auto& [name, value] : pairs) json[name] = value;
    return json;
  };
  Json json;
  json["study"] = Json::parse(p.study.empty() ? "null" : p.study, "study");
  json["contract_hash"] = p.contract_hash;
  json["program_version"] = p.program_version;
  json["backend"] = p.backend;
  json["inputs"] = object(p.inputs);
  json["libraries"] = object(p.libraries);
  return members_of(json);
}

}  // namespace

void bind_dataset(nb::module_& m) {
  m.def("names_of_checks", &campaign::names_of_checks, nb::arg("bits"), "\"residual+energy\", or \"none\".");
  nb::class_<campaign::Dataset>(m, "Dataset", "Trials of a campaign, one row each.")
      .def_static(
          "read", [](const std::string& path) { return long_call([&] { return campaign::read_dataset(path); }); },
          nb::arg("path"))
      .def("__len__", [](const campaign::Dataset& d) { return d.records.size(); })
      .def("columns", &columns_of, "Column name -> array [rows].")
      .def(
          "csv", [](const campaign::Dataset& d) { return long_call([&] { return campaign::to_csv(d); }); },
          "Header and one line per trial.")
      .def(
          "write",
          [](const campaign::Dataset& d, const std::string& path) {
            long_call([&] { campaign::write_dataset(path, d); });
          },
          nb::arg("path"), "Writes the HDF5 file.")
      .def(
          "summary",
          [](const campaign::Dataset& d) { return members_of(campaign::to_json(campaign::summarise(d.records))); },
          "Counts, ranges and the agreement of replicates.")
      .def("provenance", &provenance_of, "What the rows depend on.");
}

}  // namespace gonogo::python
