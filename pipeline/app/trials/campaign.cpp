#include <cmath>
#include <memory>

#include "base/error.h"
#include "base/format.h"
#include "pipeline/app/cli/work.h"
#include "pipeline/app/trials/numerics_options.h"
#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/cluster/slurm.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/outcome/active/active_run.h"

#ifdef GONOGO_WITH_MPI
#include "pipeline/campaign/engine/cluster/mpi_crew.h"
#endif

namespace gonogo::app {
namespace {

struct CampaignOptions {
  std::string study, folder;
  int workers = 0, places = 0, gpus = 0;
  std::string device, engine = "local";
  double checkpoint_every = -1, course_every = -1;
  std::size_t trials_per_shard = 256;
  std::uint64_t task = 0, tasks = 1;
  int max_tasks = 0;
  std::vector<std::string> sbatch;
};

/// CampaignOptions that were not given stay as the study has them.
campaign::ComputeRequest compute_of(const CampaignOptions& options, const Globals& globals) {
  campaign::ComputeRequest request;
  request.threads = globals.threads;
  if (!options.device.empty()) request.device = options.device;
  if (options.places > 0) request.places = options.places;
  if (options.gpus > 0) request.gpus = options.gpus;
  if (options.workers > 0) request.workers = options.workers;
  if (options.checkpoint_every >= 0) request.checkpoint_every = options.checkpoint_every;
  if (options.course_every >= 0) request.course_every = options.course_every;
  return request;
}

Json campaign_json(const campaign::CampaignSummary& summary) {
  Json result = Json::object();
  result["dataset"] = summary.dataset.string();
  result["trials"] = std::uint64_t(summary.trials);
  result["computed"] = std::uint64_t(summary.computed);
  result["reused"] = std::uint64_t(summary.reused);
  result["damaged"] = std::uint64_t(summary.damaged);
  result["worker_deaths"] = std::uint64_t(summary.worker_deaths);
  result["verdicts"] = campaign::counts_json(summary.by_verdict);
  result["reasons"] = campaign::counts_json(summary.by_reason);
  return result;
}

std::string campaign_text(const campaign::CampaignSummary& summary) {
  return summary.dataset.string() + ": " + std::to_string(summary.trials) + " trials, " +
         std::to_string(summary.computed) +
         " computed now: " + campaign::counts_line(summary.by_verdict, summary.by_reason);
}

Json as_json(const campaign::CampaignStatus& status) {
  Json result = Json::object();
  result["trials"] = std::uint64_t(status.trials);
  result["done"] = std::uint64_t(status.done);
  result["running"] = status.use != campaign::FolderUse::none;
  result["shards"] = std::uint64_t(status.shards);
  result["committed_shards"] = std::uint64_t(status.committed_shards);
  result["trials_per_second"] = status.rate;
  result["seconds_left"] = status.seconds_left;
  result["damaged"] = std::uint64_t(status.damaged);
  result["verdicts"] = campaign::counts_json(status.by_verdict);
  result["reasons"] = campaign::counts_json(status.by_reason);
  return result;
}

std::string use_text(campaign::FolderUse use) {
  switch (use) {
    case campaign::FolderUse::coordinator:
      return "running";
    case campaign::FolderUse::tasks:
      return "tasks are running";
    default:
      return "not running";
  }
}

std::string as_text(const campaign::CampaignStatus& status) {
  std::string text =
      std::to_string(status.done) + " of " + std::to_string(status.trials) + " trials done, " + use_text(status.use);
  if (status.done > 0) text += ": " + campaign::counts_line(status.by_verdict, status.by_reason);
  if (status.rate > 0) text += line("; %.3g trials/s, about %.0f s left", status.rate, std::ceil(status.seconds_left));
  if (status.damaged > 0) text += "; " + std::to_string(status.damaged) + " unreadable lines or shards";
  return text;
}

campaign::CampaignRequest plan(const CampaignOptions& options, const Globals& globals) {
  campaign::CampaignRequest request =
      campaign::plan_study_campaign(campaign::read_study(options.study), options.folder, compute_of(options, globals));
  request.trials_per_shard = options.trials_per_shard;
  return request;
}

void print_summary(const Globals& globals, const campaign::CampaignSummary& summary) {
  print_result(globals, campaign_json(summary), campaign_text(summary));
}

#ifdef GONOGO_WITH_MPI
/// Every rank comes here. All but the first are workers until they are told to stop, and print nothing.
void run_with_mpi(const CampaignOptions& options, const Globals& globals) {
  const campaign::MpiJob job;
  if (job.rank() > 0) {
    const std::unique_ptr<campaign::WorkerLine> line = job.worker_line();
    const campaign::Study study = campaign::read_study(options.study);
    return campaign::run_study_worker(
        study, campaign::worker_options(study, options.folder, compute_of(options, globals), job.rank() - 1),
        line.get());
  }
  campaign::CampaignRequest request = plan(options, globals);
  request.crew = job.crew_maker();
  print_summary(globals, campaign::run_campaign(request));
}
#else
void run_with_mpi(const CampaignOptions&, const Globals&) {
  throw InputError(
      "the mpi engine was left out of this build; configure it with -DGONOGO_MPI=ON, or take --engine local");
}
#endif

void add_study_options(CLI::App& command, CampaignOptions& options) {
  add_named(command, "study", options.study, kStudy, "Study file (JSON)")->required();
  add_named(command, "--out", options.folder, kFolder, "Folder of the campaign; an interrupted one continues")
      ->required();
}

void add_compute_options(CLI::App& command, CampaignOptions& options) {
  add_number(command, "--workers", options.workers, {0, 4096}, "Worker processes; 0 takes one per core, or per GPU");
  command.add_option("--device", options.device, "Device that computes trials; default: the study's, or cpu")
      ->check(CLI::IsMember({"cpu", "cuda"}));
  command
      .add_option("--gpus", options.gpus, "Number of GPUs that the workers share; implies --device cuda; default: all")
      ->check(CLI::Range(1, 64));
  command
      .add_option("--places", options.places, "Trials side by side in a worker; default: the study's, or 1, on cuda 64")
      ->check(CLI::Range(1, 4096));
  command
      .add_option("--checkpoint-every", options.checkpoint_every,
                  "Interval at which running trials are saved [s]; default: the study's, or 30; 0: never")
      ->check(CLI::Range(0.0, 1e6));
  command
      .add_option("--course-every", options.course_every,
                  "Writes courses/TRIAL.csv, a line per so much simulated time [s]; default: the study's, or 0: none")
      ->check(CLI::Range(0.0, 1e3));
}

void add_shard_option(CLI::App& command, CampaignOptions& options) {
  add_number(command, "--trials-per-shard", options.trials_per_shard, {1, 1000000},
             "Trials that are committed together, set by the first run in a folder");
}

void add_run(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("run", "Compute the missing trials of a study and write its dataset");
  auto options = std::make_shared<CampaignOptions>();
  add_study_options(*command, *options);
  add_compute_options(*command, *options);
  add_shard_option(*command, *options);
  command->add_option("--engine", options->engine, "local: processes of this machine; mpi: ranks of an mpirun")
      ->check(CLI::IsMember({"local", "mpi"}))
      ->capture_default_str();
  add_examples(*command, {"gonogo campaign run configs/studies/demo.json --out out/demo --workers 2",
                          "gonogo campaign run configs/studies/demo.json --out out/demo_gpu --gpus 2 --places 64",
                          "mpirun -n 4 gonogo campaign run configs/studies/demo.json --out out/demo --engine mpi"});
  command->callback([options, &globals] {
    if (options->engine == "mpi") return run_with_mpi(*options, globals);
    print_summary(globals, campaign::run_campaign(plan(*options, globals)));
  });
}

/// Command line of a task, with this program's path: the job runs on another machine.
std::vector<std::string> task_command(const CampaignOptions& options) {
  namespace fs = std::filesystem;
  std::vector<std::string> words{fs::read_symlink("/proc/self/exe").string(),
                                 "campaign",
                                 "task",
                                 fs::absolute(options.study).string(),
                                 "--out",
                                 fs::absolute(options.folder).string(),
                                 "--workers",
                                 std::to_string(options.workers)};
  if (!options.device.empty()) words.insert(words.end(), {"--device", options.device});
  if (options.gpus > 0) words.insert(words.end(), {"--gpus", std::to_string(options.gpus)});
  if (options.places > 0) words.insert(words.end(), {"--places", std::to_string(options.places)});
  if (options.checkpoint_every >= 0)
    words.insert(words.end(), {"--checkpoint-every", std::to_string(options.checkpoint_every)});
  if (options.course_every >= 0) words.insert(words.end(), {"--course-every", std::to_string(options.course_every)});
  return words;
}

void add_submit(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("submit", "Give the missing trials to Slurm as a job array");
  auto options = std::make_shared<CampaignOptions>();
  add_study_options(*command, *options);
  add_compute_options(*command, *options);
  add_shard_option(*command, *options);
  add_number(*command, "--tasks", options->max_tasks, {0, 1000},
             "Max tasks of the array; 0: one per shard, at most 1000");
  add_named(*command, "--sbatch", options->sbatch, "OPTION",
            "Further option for sbatch, once for each: --sbatch=--time=2:00:00");
  add_examples(*command,
               {"gonogo campaign submit configs/studies/demo.json --out out/demo --trials-per-shard 16 \\\n"
                "      --workers 2 --sbatch=--cpus-per-task=2",
                "gonogo campaign status out/demo", "gonogo campaign collect configs/studies/demo.json --out out/demo"});
  command->callback([options, &globals] {
    const campaign::Submission done = campaign::submit_campaign(
        plan(*options, globals),
        {.tasks = options->max_tasks, .task_command = task_command(*options), .options = options->sbatch});
    Json result = Json::object();
    result["job"] = done.job;
    result["shards"] = std::uint64_t(done.shards);
    result["tasks"] = std::uint64_t(done.tasks);
    print_result(globals, result,
                 done.job.empty() ? "no trial is missing; gonogo campaign collect writes the dataset"
                                  : "job " + done.job + ": " + std::to_string(done.tasks) + " tasks compute " +
                                        std::to_string(done.shards) + " shards");
  });
}

/// Hidden: started by the job script.
void add_task(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("task", "")->group("");
  auto options = std::make_shared<CampaignOptions>();
  add_study_options(*command, *options);
  add_compute_options(*command, *options);
  command->add_option("--task", options->task)->required();
  command->add_option("--tasks", options->tasks)->required()->check(CLI::PositiveNumber);
  command->callback([options, &globals] {
    const campaign::CampaignSummary summary =
        campaign::run_campaign_task(plan(*options, globals), options->task, options->tasks);
    print_result(globals, campaign_json(summary),
                 std::to_string(summary.trials) + " trials, " + std::to_string(summary.computed) +
                     " computed now: " + campaign::counts_line(summary.by_verdict, summary.by_reason));
  });
}

struct ActiveOptions {
  std::filesystem::path study, folder;
  campaign::ComputeRequest compute;
  std::uint64_t seeds = 64, batch = 32, max_points = 1000;
  double confidence = 0.95, space_filling = 0.25;
  FamilyChoice family;
};

std::shared_ptr<const outcome::Forecast> forecast_of(const ActiveOptions& options, const campaign::Study& study) {
  if (!options.family.from_family) return nullptr;
  if (study.vehicle.empty())
    throw InputError(options.study.string() + ": names no vehicle, for which --from-family asks its family; name one");
  const auto trial = study.config.object_if("trial");
  return map::family_forecast(options.family.model, vehicle::read_vehicle(study.vehicle),
                              trial && trial->boolean_or("compliant_tyres", false), study.gravity);
}

void run_active(const Globals& globals, const ActiveOptions& options) {
  const campaign::Study study = campaign::read_study(options.study);
  const outcome::ActiveSummary done = outcome::run_active({.study = study,
                                                           .folder = options.folder,
                                                           .compute = options.compute,
                                                           .seeds = options.seeds,
                                                           .batch = options.batch,
                                                           .max_points = options.max_points,
                                                           .confidence = options.confidence,
                                                           .forecast = forecast_of(options, study),
                                                           .space_filling = options.space_filling});
  Json result = campaign_json(done.campaign);
  result["points"] = done.points;
  result["confidence"] = done.confidence;
  result["reached"] = done.reached;
  print_result(
      globals, result,
      campaign_text(done.campaign) + line("\n%llu points; the model expects to be right in %.1f %% of the box",
                                          static_cast<unsigned long long>(done.points), 100 * done.confidence));
}

void add_active(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand(
      "active", "Let a study choose its own trials, batch by batch, until its model is sure enough");
  const auto options = std::make_shared<CampaignOptions>();
  const auto active = std::make_shared<ActiveOptions>();
  add_study_options(*command, *options);
  add_compute_options(*command, *options);
  add_number(*command, "--seeds", active->seeds, {2, 1000000}, "Points of the first batch");
  add_number(*command, "--batch", active->batch, {1, 1000000}, "Points of each further batch");
  command->add_option("--max-points", active->max_points, "Max points in all")->capture_default_str();
  add_number(*command, "--confidence", active->confidence, {0.5, 1.0},
             "Stop when the model expects to be right in this share");
  add_number(*command, "--space-filling", active->space_filling, {0.01, 1.0},
             "Share of a batch that is uniform over the box");
  add_family(*command, active->family,
             "Start from the forecast of the model of the vehicle's family: first trials and models");
  add_examples(*command, {"gonogo campaign active configs/studies/demo.json --out out/active --confidence 0.95",
                          "gonogo campaign active buggy_study.json --out out/buggy --from-family"});
  command->callback([options, active, command, &globals] {
    active->study = options->study;
    active->folder = options->folder;
    active->compute = compute_of(*options, globals);
    do_work<run_active>(*command, globals, *active);
  });
}

void add_collect(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("collect", "Check and merge what the tasks of a job computed");
  auto options = std::make_shared<CampaignOptions>();
  add_study_options(*command, *options);
  add_compute_options(*command, *options);
  add_examples(*command, {"gonogo campaign collect configs/studies/demo.json --out out/demo"});
  command->callback(
      [options, &globals] { print_summary(globals, campaign::collect_campaign(plan(*options, globals))); });
}

void add_status(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("status", "Progress of a campaign, also while it runs");
  auto options = std::make_shared<CampaignOptions>();
  add_named(*command, "folder", options->folder, kFolder, "Folder of the campaign")->required();
  add_examples(*command, {"gonogo campaign status out/demo"});
  command->callback([options, &globals] {
    const campaign::CampaignStatus status = campaign::campaign_status(options->folder);
    const std::string slurm = campaign::slurm_state(options->folder);
    Json result = as_json(status);
    result["slurm"] = slurm;
    print_result(globals, result, as_text(status) + (slurm.empty() ? "" : "\nSlurm: " + slurm));
  });
}

void add_snapshot(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand(
      "snapshot", "The trials done so far as a dataset, up to the first missing one, also while it runs");
  auto options = std::make_shared<CampaignOptions>();
  auto out = std::make_shared<std::string>();
  add_named(*command, "folder", options->folder, kFolder, "Folder of the campaign")->required();
  add_named(*command, "--out", *out, kFile, "File to write (HDF5)")->required();
  add_examples(*command, {"gonogo campaign snapshot out/demo --out so_far.h5"});
  command->callback([options, out, &globals] {
    const campaign::Dataset dataset = campaign::campaign_snapshot(options->folder);
    campaign::write_dataset(*out, dataset);
    Json result;
    result["dataset"] = *out;
    result["trials"] = std::uint64_t(dataset.records.size());
    print_result(globals, result, *out + ": " + std::to_string(dataset.records.size()) + " trials");
  });
}

/// Hidden: each worker process of a run.
void add_worker(CLI::App& parent) {
  CLI::App* command = parent.add_subcommand("worker", "")->group("");
  auto study = std::make_shared<std::string>();
  auto options = std::make_shared<campaign::WorkerOptions>();
  command->add_option("study", *study)->type_name(kStudy)->required();
  add_choice(*command, "--device", options->device, kBackends, "");
  command->add_option("--places", options->places)->check(CLI::Range(1, 4096));
  command->add_option("--gpu", options->gpu);
  command->add_option("--checkpoints", options->checkpoints);
  command->add_option("--checkpoint-every", options->checkpoint_every);
  command->add_option("--courses", options->courses);
  command->add_option("--course-every", options->course_every);
  command->callback([study, options] { campaign::run_study_worker(campaign::read_study(*study), *options); });
}

}  // namespace

void add_campaign_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("campaign", "Many trials in worker processes; an interrupted campaign continues");
  command->require_subcommand(1);
  add_examples(*command, {"gonogo campaign run configs/studies/demo.json --out out/demo --workers 2"});
  add_run(*command, globals);
  add_submit(*command, globals);
  add_status(*command, globals);
  add_snapshot(*command, globals);
  add_collect(*command, globals);
  add_task(*command, globals);
  add_active(*command, globals);
  add_worker(*command);
}

}  // namespace gonogo::app
