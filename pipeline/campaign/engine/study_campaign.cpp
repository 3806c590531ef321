#include "pipeline/campaign/engine/study_campaign.h"

#include <memory>

#include "base/progress.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/plan.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/trial/batch.h"
#include "sim/simulation/device.h"

namespace gonogo::campaign {
namespace {

class BatchEngine : public TrialEngine {
 public:
  BatchEngine(const TrialSetup& setup, const WorkerOptions& options)
      : options_(options), batch_(setup, {options.device, options.places, 1}) {}

  bool has_room() const override { return batch_.free_places() > 0; }
  bool is_running() const override { return batch_.running() > 0; }
  void start(const DesignPoint& point) override { batch_.start(point, {}, checkpoint(point)); }
  std::vector<TrialRecord> advance() override { return batch_.advance(); }

 private:
  TrialCheckpoint checkpoint(const DesignPoint& point) const {
    if (options_.checkpoints.empty()) return {};
    return {saved_trial_path(options_.checkpoints, point.index), options_.checkpoint_every, true};
  }

  const WorkerOptions& options_;
  TrialBatch batch_;
};

/// A friction angle belongs to the numerics of its table.
void warn_of_other_numerics(const TrialSetup& setup) {
  const Json& made = setup.calibration.provenance;
  if (!made.find("step_s") || terrain::read_numerics(made) == setup.numerics) return;
  log_line(
      "soil",
      setup.calibration_file.string() + " was measured with " + terrain::description(terrain::read_numerics(made)) +
          ", the trials take " + terrain::description(setup.numerics) +
          ": their soil differs a little from the table's (gonogo soil calibrate --step ... makes a table for them)");
}

}  // namespace

void check_study(const Study& study) {
  if (study.vehicle.empty() && !study.config.has("trial") && !study.config.has("soil")) return;
  ComputeRequest anywhere;
  anywhere.device = "cpu";  // this machine need not be the one that computes
  read_compute(study, anywhere);
  read_trial_setup(study, default_packing_folder(), sim::Backend::cpu);
}

CampaignRequest plan_study_campaign(const Study& study, const std::filesystem::path& folder,
                                    const ComputeRequest& asked) {
  const ComputeSettings compute = read_compute(study, asked);
  const auto setup =
      std::make_shared<const TrialSetup>(read_trial_setup(study, default_packing_folder(), compute.device));
  warn_of_other_numerics(*setup);
  CampaignRequest request =
      plan_campaign(study, folder, compute.workers, {{"calibration", setup->calibration_file}}, compute.backend);
  request.places = compute.places;
  request.gpus = compute.gpus;
  request.checkpoint_every = compute.checkpoint_every;
  request.worker_command.insert(request.worker_command.end(), {"--device", compute.gpus > 0 ? "cuda" : "cpu",
                                                               "--places", std::to_string(compute.places)});
  request.prepare = [setup, design = request.design, threads = compute.threads] {
    prepare_trials(*setup, design, threads);
  };
  return request;
}

void run_study_worker(const std::filesystem::path& study_file, const WorkerOptions& options) {
  const TrialSetup setup = read_trial_setup(read_study(study_file), default_packing_folder(), options.device);
  if (options.device == sim::Backend::cuda) sim::use_cuda_device(options.gpu);
  BatchEngine engine(setup, options);
  run_worker(engine);
}

void run_study_worker(const Study& study, const WorkerOptions& options, WorkerLine& line) {
  const TrialSetup setup = read_trial_setup(study, default_packing_folder(), options.device);
  if (options.device == sim::Backend::cuda) sim::use_cuda_device(options.gpu);
  BatchEngine engine(setup, options);
  run_worker(engine, line);
}

WorkerOptions worker_options(const Study& study, const std::filesystem::path& folder, const ComputeRequest& asked,
                             int worker) {
  const ComputeSettings compute = read_compute(study, asked);
  WorkerOptions options{.device = compute.device,
                        .places = compute.places,
                        .gpu = compute.gpus > 0 ? worker % compute.gpus : 0,
                        .checkpoints = {},
                        .checkpoint_every = compute.checkpoint_every};
  if (compute.checkpoint_every > 0) options.checkpoints = running_folder(folder);
  return options;
}

}  // namespace gonogo::campaign
