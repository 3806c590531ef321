#include "pipeline/campaign/engine/campaign.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

Json counts_json(const campaign::Counts& counts) {
  Json json = Json::object();
  for (const auto& [name, count] : counts) json[name] = std::uint64_t(count);
  return json;
}

/// `worker`: the words that start Python with gonogo.worker, in the place of the program and its command.
std::string run_campaign(const std::string& study, const std::string& folder, const std::vector<std::string>& worker,
                         std::optional<int> workers, std::optional<int> places, std::optional<std::string> device,
                         std::size_t trials_per_shard) {
  return long_call([&] {
    campaign::ComputeRequest compute;
    compute.workers = workers;
    compute.places = places;
    compute.device = device;
    campaign::CampaignRequest request = campaign::plan_study_campaign(campaign::read_study(study), folder, compute);
    constexpr std::ptrdiff_t kProgramWords = 3;  // <program> campaign worker
    auto& words = request.worker_command;
    words.erase(words.begin(), words.begin() + kProgramWords);
    words.insert(words.begin(), worker.begin(), worker.end());
    request.trials_per_shard = trials_per_shard;
    const campaign::CampaignSummary done = campaign::run_campaign(request);
    Json json;
    json["dataset"] = done.dataset.string();
    json["trials"] = std::uint64_t(done.trials);
    json["computed"] = std::uint64_t(done.computed);
    json["reused"] = std::uint64_t(done.reused);
    json["verdicts"] = counts_json(done.by_verdict);
    json["reasons"] = counts_json(done.by_reason);
    return json.dump();
  });
}

std::string status(const std::string& folder) {
  return long_call([&] {
    const campaign::CampaignStatus now = campaign::campaign_status(folder);
    Json json;
    json["trials"] = std::uint64_t(now.trials);
    json["done"] = std::uint64_t(now.done);
    json["running"] = now.use != campaign::FolderUse::none;
    json["trials_per_second"] = now.rate;
    json["seconds_left"] = now.seconds_left;
    json["verdicts"] = counts_json(now.by_verdict);
    json["reasons"] = counts_json(now.by_reason);
    return json.dump();
  });
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
                const std::string& checkpoints, double checkpoint_every) {
  campaign::WorkerOptions options;
  options.device = device == "cuda" ? sim::Backend::cuda : sim::Backend::cpu;
  options.places = places;
  options.gpu = gpu;
  options.checkpoints = checkpoints;
  options.checkpoint_every = checkpoint_every;
  long_call([&] { campaign::run_study_worker(study, options); });
}

}  // namespace

void bind_campaign(nb::module_& m) {
  using namespace nb::literals;
  m.def("run_campaign", &run_campaign, "study"_a, "folder"_a, "worker"_a, "workers"_a.none(), "places"_a.none(),
        "device"_a.none(), "trials_per_shard"_a, "Computes what is missing. Returns JSON of the summary.");
  m.def("campaign_status", &status, "folder"_a, "JSON of the progress; may be called while a campaign runs.");
  m.def("design", &design, "study"_a, "Points of a study's design [trial_count, variable_count].");
  m.def("run_worker", &run_worker, "study"_a, "device"_a, "places"_a, "gpu"_a, "checkpoints"_a, "checkpoint_every"_a,
        "A worker process of a campaign: points from standard input, trials to standard output.");
}

}  // namespace gonogo::python
