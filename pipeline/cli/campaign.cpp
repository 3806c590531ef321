#include <memory>

#include "pipeline/campaign/campaign.h"
#include "pipeline/campaign/study_campaign.h"
#include "pipeline/cli/command.h"

namespace gonogo::pipeline::cli {
namespace {

struct Options {
  std::string study, folder;
  int workers = 0, places = 0;
  std::string device;
  double checkpoint_every = -1;
};

/// Options that were not given leave it to the study.
ComputeRequest compute_of(const Options& options, const Globals& globals) {
  ComputeRequest request;
  request.threads = globals.threads;
  if (!options.device.empty()) request.device = options.device;
  if (options.places > 0) request.places = options.places;
  if (options.workers > 0) request.workers = options.workers;
  if (options.checkpoint_every >= 0) request.checkpoint_every = options.checkpoint_every;
  return request;
}

Json counts_json(const std::map<std::string, std::size_t>& counts) {
  Json object = Json::object();
  for (const auto& [name, number] : counts) object[name] = std::uint64_t(number);
  return object;
}

Json as_json(const CampaignSummary& summary) {
  Json result = Json::object();
  result["dataset"] = summary.dataset.string();
  result["trials"] = std::uint64_t(summary.trials);
  result["computed"] = std::uint64_t(summary.computed);
  result["reused"] = std::uint64_t(summary.reused);
  result["damaged"] = std::uint64_t(summary.damaged);
  result["worker_deaths"] = std::uint64_t(summary.worker_deaths);
  result["verdicts"] = counts_json(summary.by_verdict);
  result["reasons"] = counts_json(summary.by_reason);
  return result;
}

std::string as_text(const CampaignSummary& summary) {
  return summary.dataset.string() + ": " + std::to_string(summary.trials) + " trials, " +
         std::to_string(summary.computed) + " computed now: " + counts_line(summary.by_verdict, summary.by_reason);
}

Json as_json(const CampaignStatus& status) {
  Json result = Json::object();
  result["trials"] = std::uint64_t(status.trials);
  result["done"] = std::uint64_t(status.done);
  result["running"] = status.running;
  result["damaged"] = std::uint64_t(status.damaged);
  result["verdicts"] = counts_json(status.by_verdict);
  result["reasons"] = counts_json(status.by_reason);
  return result;
}

std::string as_text(const CampaignStatus& status) {
  std::string text = std::to_string(status.done) + " of " + std::to_string(status.trials) + " trials done, " +
                     (status.running ? "running" : "not running");
  if (status.done > 0) text += ": " + counts_line(status.by_verdict, status.by_reason);
  if (status.damaged > 0) text += "; " + std::to_string(status.damaged) + " unreadable lines";
  return text;
}

void add_run(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("run", "Compute the missing trials of a study and write its dataset");
  auto options = std::make_shared<Options>();
  command->add_option("study", options->study, "Study file (JSON)")->required();
  command->add_option("--out", options->folder, "Folder of the campaign; an interrupted one continues")->required();
  command->add_option("--workers", options->workers, "Worker processes; 0 takes one per core, or per GPU")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_option("--device", options->device, "On what trials are computed; default: the study's, or cpu")
      ->check(CLI::IsMember({"cpu", "cuda"}));
  command
      ->add_option("--places", options->places,
                   "Trials side by side in a worker; default: the study's, or 1 (cuda: 64)")
      ->check(CLI::Range(1, 4096));
  command
      ->add_option("--checkpoint-every", options->checkpoint_every,
                   "Interval at which running trials are saved [s]; default: the study's, or 30; 0: never")
      ->check(CLI::Range(0.0, 1e6));
  command->footer(
      "Examples:\n  gonogo campaign run configs/studies/demo.json --out out/demo --workers 2\n"
      "  gonogo campaign run configs/studies/demo.json --out out/demo_gpu --device cuda --places 64");
  command->callback([options, &globals] {
    const CampaignSummary summary =
        run_campaign(plan_study_campaign(read_study(options->study), options->folder, compute_of(*options, globals)));
    print_result(globals, as_json(summary), as_text(summary));
  });
}

void add_status(CLI::App& parent, const Globals& globals) {
  CLI::App* command = parent.add_subcommand("status", "How far a campaign is; may be asked while it runs");
  auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "Folder of the campaign")->required();
  command->footer("Example:\n  gonogo campaign status out/demo");
  command->callback([options, &globals] {
    const CampaignStatus status = campaign_status(options->folder);
    print_result(globals, as_json(status), as_text(status));
  });
}

/// Hidden: what run starts in each worker process.
void add_worker(CLI::App& parent) {
  CLI::App* command = parent.add_subcommand("worker", "")->group("");
  auto study = std::make_shared<std::string>();
  auto options = std::make_shared<WorkerOptions>();
  command->add_option("study", *study)->required();
  const std::map<std::string, sim::Backend> devices{{"cpu", sim::Backend::cpu}, {"cuda", sim::Backend::cuda}};
  command->add_option("--device", options->device)->transform(CLI::CheckedTransformer(devices));
  command->add_option("--places", options->places)->check(CLI::Range(1, 4096));
  command->add_option("--gpu", options->gpu);
  command->add_option("--checkpoints", options->checkpoints);
  command->add_option("--checkpoint-every", options->checkpoint_every);
  command->callback([study, options] { run_study_worker(*study, *options); });
}

}  // namespace

void add_campaign_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("campaign", "Many trials in worker processes; survives anything, continues");
  command->require_subcommand(1);
  command->footer("Example:\n  gonogo campaign run configs/studies/demo.json --out out/demo --workers 2");
  add_run(*command, globals);
  add_status(*command, globals);
  add_worker(*command);
}

}  // namespace gonogo::pipeline::cli
