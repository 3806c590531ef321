#include "pipeline/campaign/engine/study_campaign.h"

#include <gnu/libc-version.h>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/parallel/for_each.h"
#include "base/progress.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/worker.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/campaign/trial/trial.h"
#include "sim/simulation/simulation.h"

namespace gonogo::campaign {
namespace {

constexpr const char* kSections[] = {"soil", "trial", "design"};

/// Leaves of a JSON value by path: {"trial.step_s": "0.001", ...}, so that a change can be named.
void add_leaves(const std::string& path, const Json& value, Dependencies& leaves) {
  if (!value.is_object()) {
    leaves.emplace_back(path, value.dump());
    return;
  }
  const std::string prefix = path + ".";
  for (const auto& [key, member] : value.members()) add_leaves(prefix + key, member, leaves);
}

/// The parts of the study that trials depend on.
Json relevant_study(const Study& study) {
  Json relevant = Json::object();
  relevant["study"] = study.name;
  relevant["seed"] = study.seed;
  if (study.gravity != kGravity) relevant["gravity"] = study.gravity;
  for (const char* section : kSections)
    if (const Json* value = study.config.json().find(section)) relevant[section] = *value;
  return relevant;
}

Dependencies dependencies(const Study& study, const Provenance& provenance) {
  Dependencies result{{"program", provenance.program_version},
                      {"backend", provenance.backend},
                      {"contract", provenance.contract_hash},
                      {"seed", std::to_string(study.seed)}};
  for (const auto& [name, version] : provenance.libraries) result.emplace_back(name, version);
  for (const auto& [name, hash] : provenance.inputs) result.emplace_back("content of " + name, hash);
  for (const char* section : kSections) {
    const Json* value = study.config.json().find(section);
    if (value) add_leaves(section, *value, result);
  }
  if (study.gravity != kGravity) result.emplace_back("gravity", number_text(study.gravity, 6));
  std::erase_if(result, [](const auto& entry) { return entry.first == "design.points"; });
  return result;
}

}  // namespace

CampaignRequest plan_campaign(const Study& study, const std::filesystem::path& folder, int workers,
                              const InputFiles& inputs, const std::string& backend) {
  CampaignRequest request;
  request.folder = folder;
  request.design = make_design(read_design(study.section("design"), study.seed));
  Provenance& provenance = request.provenance;
  provenance.study = relevant_study(study).dump(2);
  provenance.contract_hash = content_hash(contract_text());
  provenance.program_version = campaign_program();
  provenance.backend = backend;
  const auto add_input = [&](const std::string& name, const std::filesystem::path& path) {
    provenance.inputs.emplace_back(name, file_hash(path));
    provenance.files.emplace_back(name, read_file(path));
  };
  if (!study.vehicle.empty()) add_input("vehicle", study.vehicle);
  for (const auto& [name, path] : inputs) add_input(name, path);
  provenance.libraries = {{"compiler", __VERSION__}, {"libc", gnu_get_libc_version()}};
  request.depends_on = dependencies(study, provenance);
  request.workers = workers;
  request.worker_command = {"/proc/self/exe", "campaign", "worker", study.file.string()};
  return request;
}

namespace {

/// Enough worlds to keep a GPU busy with trials of some ten thousand contacts.
constexpr int kPlacesOfGpu = 64;

struct ComputeSettings {
  sim::Backend device = sim::Backend::cpu;
  std::string backend = "cpu";  // as results name it: "cpu", or "cuda" and the name of the devices
  int places = 1;               // trials that a worker computes side by side
  int workers = 1;
  int gpus = 0;                  // that the workers share; 0 for the cpu
  double checkpoint_every = 30;  // running trials are saved [s of the wall clock]; 0: never
  double course_every = 0;       // simulated time between two lines of a trial's course [s]; 0: none is written
  int threads = 1;               // for what the host does itself
};

ComputeRequest read_compute_section(const Study& study) {
  ComputeRequest s;
  const auto c = study.config.object_if("compute");
  if (!c) return s;
  if (c->has("device")) s.device = c->choice("device", {"cpu", "cuda"});
  if (c->has("places")) s.places = int(c->integer("places", {1, 4096}));
  if (c->has("gpus")) s.gpus = int(c->integer("gpus", {1, 64}));
  if (c->has("workers")) s.workers = int(c->integer("workers", {1, 4096}));
  if (c->has("checkpoint_s")) s.checkpoint_every = c->number("checkpoint_s", {0, 1e6});
  if (c->has("course_s")) s.course_every = c->number("course_s", {0, 1e3});
  c->finish();
  return s;
}

void use_gpus(ComputeSettings& s, std::optional<int> count) {
  const std::vector<std::string> names = alike_gpus(sim::cuda_device_names(), count);
  s.device = sim::Backend::cuda;
  s.backend = "cuda, " + names.front();
  s.gpus = int(names.size());
}

/// A number of GPUs means the device cuda.
bool names_gpus(const ComputeRequest& r) {
  if (r.gpus && r.device == "cpu")
    throw InputError("a number of GPUs is given, and the device is to be cpu; leave one of them out, or take cuda");
  return r.gpus || r.device == "cuda";
}

/// The command line's device or number of GPUs, else the study's.
bool wants_gpus(const ComputeRequest& request, const ComputeRequest& section) {
  const bool in_study = names_gpus(section);
  return request.gpus || request.device ? names_gpus(request) : in_study;
}

/// Throws InputError for numbers out of range, and for a device that this build or machine lacks.
ComputeSettings read_compute(const Study& study, const ComputeRequest& request) {
  const ComputeRequest section = read_compute_section(study);
  ComputeSettings s;
  s.threads = threads_or_all(request.threads);
  if (wants_gpus(request, section)) use_gpus(s, request.gpus ? request.gpus : section.gpus);
  const bool on_gpu = s.gpus > 0;
  const auto chosen = [](const auto& first, const auto& second, auto otherwise) {
    return first ? *first : second.value_or(otherwise);
  };
  s.places = chosen(request.places, section.places, on_gpu ? kPlacesOfGpu : 1);
  s.workers = chosen(request.workers, section.workers, on_gpu ? s.gpus : s.threads);
  s.checkpoint_every = chosen(request.checkpoint_every, section.checkpoint_every, s.checkpoint_every);
  s.course_every = chosen(request.course_every, section.course_every, s.course_every);
  return s;
}

class BatchEngine : public TrialEngine {
 public:
  BatchEngine(const TrialSetup& setup, const WorkerOptions& options)
      : options_(options), batch_(setup, {options.device, options.places, 1}) {}

  bool has_room() const override { return batch_.free_places() > 0; }
  bool is_running() const override { return batch_.running() > 0; }
  void start(const DesignPoint& point) override { batch_.start(point, watch(point), checkpoint(point)); }

  std::vector<TrialRecord> advance() override {
    std::vector<TrialRecord> ended = batch_.advance();
    for (const TrialRecord& record : ended) write_course(record.point.index);
    return ended;
  }

 private:
  TrialWatch watch(const DesignPoint& point) {
    if (options_.courses.empty()) return {};
    std::string& course = course_[point.index];
    return {.start = [&course] { course = kSampleColumns; },
            .sample = [&course](const TrialSample& s) { course += csv_line(s); },
            .sample_interval = options_.course_every,
            .shares = {},
            .frame = {}};
  }

  void write_course(std::uint64_t trial) {
    const auto course = course_.extract(trial);
    if (course) write_file_atomically(options_.courses / (std::to_string(trial) + ".csv"), course.mapped());
  }

  TrialCheckpoint checkpoint(const DesignPoint& point) const {
    if (options_.checkpoints.empty()) return {};
    return {saved_trial_path(options_.checkpoints, point.index), options_.checkpoint_every, true};
  }

  const WorkerOptions& options_;
  std::map<std::uint64_t, std::string> course_;  // of running trials, by index; must outlive the batch
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

std::vector<std::string> alike_gpus(std::vector<std::string> names, std::optional<int> count) {
  if (names.empty())
    throw InputError("the study is to be computed on a GPU, and this build or machine has none; take --device cpu");
  if (count && std::size_t(*count) > names.size())
    throw InputError("the study is to be computed on " + std::to_string(*count) + " GPUs; this machine has " +
                     std::to_string(names.size()));
  if (count) names.resize(std::size_t(*count));
  for (const std::string& name : names)
    if (name != names.front())
      throw InputError("this machine has GPUs of two kinds (" + names.front() + ", " + name +
                       "), whose results may differ in their last bits; name those to use in CUDA_VISIBLE_DEVICES");
  return names;
}

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
  if (compute.course_every > 0)
    request.worker_command.insert(
        request.worker_command.end(),
        {"--courses", course_folder(folder).string(), "--course-every", number_text(compute.course_every, 6)});
  request.prepare = [setup, design = request.design, threads = compute.threads] {
    prepare_trials(*setup, design, threads);
  };
  return request;
}

void run_study_worker(const Study& study, const WorkerOptions& options, WorkerLine* line) {
  const TrialSetup setup = read_trial_setup(study, default_packing_folder(), options.device);
  if (options.device == sim::Backend::cuda) sim::use_cuda_device(options.gpu);
  BatchEngine engine(setup, options);
  line ? run_worker(engine, *line) : run_worker(engine);
}

WorkerOptions worker_options(const Study& study, const std::filesystem::path& folder, const ComputeRequest& asked,
                             int worker) {
  const ComputeSettings compute = read_compute(study, asked);
  WorkerOptions options{.device = compute.device,
                        .places = compute.places,
                        .gpu = compute.gpus > 0 ? worker % compute.gpus : 0,
                        .checkpoints = {},
                        .checkpoint_every = compute.checkpoint_every,
                        .courses = {},
                        .course_every = compute.course_every};
  if (compute.checkpoint_every > 0) options.checkpoints = running_folder(folder);
  if (compute.course_every > 0) options.courses = course_folder(folder);
  return options;
}

namespace {

const TrialRecord& find_trial(const Dataset& dataset, std::uint64_t index) {
  for (const TrialRecord& record : dataset.records)
    if (record.point.index == index) return record;
  throw InputError("trial " + std::to_string(index) + " is not in this dataset of " +
                   std::to_string(dataset.records.size()) + " trials");
}

/// The study as it was, with the files that it names in place of their paths, which it does not keep.
Study stored_study(const Dataset& dataset) {
  if (dataset.provenance.files.empty())
    throw InputError(
        "this dataset does not hold the files that its trials depend on: it was made by a program before " +
        std::string("they were stored; run its campaign again"));
  const char* name = "study stored in the dataset";
  Json json = Json::parse(dataset.provenance.study, name);
  json["vehicle"] = "vehicle";
  json["soil"]["calibration"] = "calibration";
  Study study = read_study(Config::parse(json.dump(), name));
  for (const auto& [file, text] : dataset.provenance.files) study.stored[file] = text;
  return study;
}

sim::Backend device_of(const Dataset& dataset) {
  if (dataset.provenance.backend == "cpu") return sim::Backend::cpu;
  if (sim::cuda_device_names().empty())
    throw InputError("this dataset was computed on \"" + dataset.provenance.backend +
                     "\", and this build or machine has no GPU");
  return sim::Backend::cuda;
}

}  // namespace

Replay replay_trial(const Dataset& dataset, std::uint64_t index, int threads) {
  const TrialRecord& stored = find_trial(dataset, index);
  const sim::Backend device = device_of(dataset);
  const TrialSetup setup = read_trial_setup(stored_study(dataset), default_packing_folder(), device);
  const int all = threads_or_all(threads);
  prepare_trials(setup, std::span(&stored.point, 1), all);
  Replay replay;
  replay.record = run_trial(setup, stored.point, {}, {}, {device, all});
  replay.same_program = dataset.provenance.program_version == campaign_program();
  replay.differences =
      difference({.records = {stored}, .provenance = {}}, {.records = {replay.record}, .provenance = {}}).rows;
  return replay;
}

}  // namespace gonogo::campaign
