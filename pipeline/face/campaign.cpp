#include <gonogo/campaign.h>

#include <algorithm>
#include <optional>

#include "base/files/shipped.h"
#include "base/progress.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/trial/trial.h"
#include "pipeline/face/inside.h"
#include "sim/io/vtk_series.h"

namespace gonogo::api {

using campaign::contract;

struct Trial::Impl {
  campaign::TrialSetup setup;
  campaign::DesignPoint point;
};
struct Dataset::Impl {
  campaign::Dataset dataset;
};

namespace {

campaign::Study study_of(const std::string& name_or_file) {
  return campaign::read_study(shipped_file("studies", "study", name_or_file));
}

Values values_of(const campaign::DesignPoint& point) {
  const bool with_task = campaign::has_task_values(point.variables);
  Values values;
  for (std::size_t v = 0; v < point.variables.size(); ++v)
    if (const campaign::Variable& variable = contract().variables[v]; campaign::has_column(variable, with_task))
      values[variable.name] = point.variables[v];
  return values;
}

TrialResult result_of(const campaign::TrialRecord& record) {
  TrialResult result{.verdict = Verdict(int(record.verdict)),
                     .reason = contract().info(record.reason).name,
                     .variables = values_of(record.point),
                     .index = record.point.index,
                     .seed = record.point.seed,
                     .attempts = int(record.attempts),
                     .failed_checks = campaign::names_of_checks(record.failed_checks)};
  for (std::size_t k = 0; k < record.measures.size(); ++k)
    if (campaign::has_measure(record, k)) result.measures[contract().measures[k].name] = record.measures[k];
  return result;
}

/// The point of a trial with `values` in place of `variables`.
campaign::DesignPoint point_of(std::vector<double> variables, const Values& values, std::uint64_t seed) {
  campaign::DesignPoint point;
  point.seed = seed;
  point.variables = std::move(variables);
  for (const auto& [name, value] : values) campaign::set_value(point.variables, name, value, name);
  return point;
}

TrialMoment moment_of(const campaign::TrialSample& s) {
  return {.time = s.time,
          .x = s.x,
          .y = s.y,
          .sinkage = s.sinkage,
          .speed = s.speed,
          .slip = s.slip,
          .torque = s.torque,
          .residual = s.residual,
          .contacts = s.contacts};
}

/// `series` is made anew where an attempt begins.
campaign::TrialWatch watch_of(const TrialOptions& options, std::optional<sim::VtkSeries>& series) {
  campaign::TrialWatch watch;
  watch.sample = [&](const campaign::TrialSample& sample) {
    stop_if_cancelled();
    if (options.on_step) options.on_step(moment_of(sample));
  };
  if (options.frames.empty()) return watch;
  watch.frame_interval = options.frame_interval;
  watch.start = [&] { series.reset(); };
  watch.frame = [&](const campaign::TrialFrame& frame) {
    if (!series) series.emplace(options.frames, frame.world);
    series->write(sim::capture_world(frame.simulation, frame.place));
  };
  return watch;
}

}  // namespace

std::string name_of(Verdict verdict) { return contract().info(campaign::Verdict(int(verdict))).name; }
std::string label_of(Verdict verdict) { return contract().info(campaign::Verdict(int(verdict))).label; }

std::vector<Quantity> variables() {
  std::vector<Quantity> result;
  for (const campaign::Variable& v : contract().variables)
    result.push_back({v.name, v.unit, v.label, {v.minimum, v.maximum}});
  return result;
}
std::vector<Quantity> measures() {
  std::vector<Quantity> result;
  for (const campaign::Measure& m : contract().measures) result.push_back({m.name, m.unit, m.about, {}});
  return result;
}
std::vector<std::string> outcomes() {
  std::vector<std::string> result;
  for (const campaign::Outcome& outcome : contract().outcomes) result.push_back(outcome.name);
  return result;
}

Trial Trial::of_study(const std::string& study, const Values& values, std::uint64_t seed) {
  return guarded([&] {
    const campaign::Study read = study_of(study);
    Impl trial{campaign::read_trial_setup(read), point_of(campaign::middle_values(read), values, seed)};
    campaign::check_all_given(trial.point.variables, study);
    return Trial(std::make_shared<Impl>(std::move(trial)));
  });
}

Trial Trial::of_vehicle(const std::string& vehicle, const std::string& soil_table, const Values& values,
                        std::uint64_t seed, const std::string& task) {
  return guarded([&] {
    campaign::TrialSetup setup = campaign::vehicle_trial_setup(
        shipped_file("vehicles", "vehicle", vehicle), shipped_file("soils", "calibration", soil_table),
        task.empty() ? campaign::default_task() : campaign::parse_task(task));
    campaign::DesignPoint point = point_of(campaign::usual_values(setup), values, seed);
    return Trial(std::make_shared<Impl>(Impl{std::move(setup), std::move(point)}));
  });
}

Values Trial::variables() const { return values_of(impl_->point); }

TrialResult Trial::run(const TrialOptions& options) const {
  return guarded([&] {
    std::optional<sim::VtkSeries> series;
    const campaign::TrialDevice device{backend_of(options.device), options.threads};
    campaign::TrialCheckpoint checkpoint;
    checkpoint.path = options.checkpoint;
    return result_of(campaign::run_trial(impl_->setup, impl_->point, watch_of(options, series), checkpoint, device));
  });
}

CampaignSummary run_campaign(const CampaignRequest& request) {
  return guarded([&] {
    campaign::ComputeRequest compute;
    if (request.workers > 0) compute.workers = request.workers;
    if (request.places > 0) compute.places = request.places;
    if (request.device) compute.device = *request.device == Device::cuda ? "cuda" : "cpu";
    campaign::CampaignRequest plan = campaign::plan_study_campaign(study_of(request.study), request.folder, compute);
    plan.worker_command.front() = request.program;  // in place of this very program
    const campaign::CampaignSummary done = campaign::run_campaign(plan);
    return CampaignSummary{.dataset = done.dataset,
                           .trials = done.trials,
                           .computed = done.computed,
                           .reused = done.reused,
                           .verdicts = done.by_verdict,
                           .reasons = done.by_reason};
  });
}

CampaignStatus campaign_status(const std::filesystem::path& folder) {
  return guarded([&] {
    const campaign::CampaignStatus now = campaign::campaign_status(folder);
    return CampaignStatus{.trials = now.trials,
                          .done = now.done,
                          .running = now.use != campaign::FolderUse::none,
                          .trials_per_second = now.rate,
                          .seconds_left = now.seconds_left,
                          .verdicts = now.by_verdict,
                          .reasons = now.by_reason};
  });
}

std::vector<Values> design(const std::string& study) {
  return guarded([&] {
    const campaign::Study read = study_of(study);
    std::vector<Values> points;
    for (const campaign::DesignPoint& point :
         campaign::make_design(campaign::read_design(read.section("design"), read.seed)))
      points.push_back(values_of(point));
    return points;
  });
}

Dataset Dataset::read(const std::filesystem::path& file) {
  return guarded([&] { return Dataset(std::make_shared<Impl>(Impl{campaign::read_dataset(file)})); });
}
std::size_t Dataset::size() const { return impl_->dataset.records.size(); }

TrialResult Dataset::trial(std::size_t row) const {
  if (row >= size()) throw InputError("row " + std::to_string(row) + ": the dataset has " + std::to_string(size()));
  return result_of(impl_->dataset.records[row]);
}

std::vector<double> Dataset::column(const std::string& name) const {
  return guarded([&] {
    const auto& measures = contract().measures;
    const auto measure = std::find_if(measures.begin(), measures.end(), [&](const auto& m) { return m.name == name; });
    const bool measured = measure != measures.end();
    const std::size_t k = measured ? std::size_t(measure - measures.begin()) : contract().variable_index(name);
    std::vector<double> column;
    for (const campaign::TrialRecord& r : impl_->dataset.records)
      column.push_back(measured ? r.measures[k] : r.point.variables[k]);
    return column;
  });
}

Counts Dataset::verdicts() const { return campaign::summarise(impl_->dataset.records).by_verdict; }
std::string Dataset::csv() const { return campaign::to_csv(impl_->dataset); }

}  // namespace gonogo::api
