#include "pipeline/campaign/engine/replay.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/cores.h"
#include "base/error.h"
#include "base/file.h"
#include "pipeline/campaign/engine/plan.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/campaign/trial/batch.h"
#include "sim/simulation/device.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

class TemporaryPlace {
 public:
  TemporaryPlace() {
    std::string name = (fs::temp_directory_path() / "gonogo-replay-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw DeviceError(name + ": cannot make a temporary folder");
    folder_ = name;
  }
  ~TemporaryPlace() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  TemporaryPlace(const TemporaryPlace&) = delete;
  TemporaryPlace& operator=(const TemporaryPlace&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

const TrialRecord& find_trial(const Dataset& dataset, std::uint64_t index) {
  for (const TrialRecord& record : dataset.records)
    if (record.point.index == index) return record;
  throw InputError("trial " + std::to_string(index) + " is not in this dataset of " +
                   std::to_string(dataset.records.size()) + " trials");
}

/// The study's file as it was, but for the places of the files it names.
fs::path write_study(const Dataset& dataset, const fs::path& folder) {
  if (dataset.provenance.files.empty())
    throw InputError(
        "this dataset does not hold the files that its trials depend on: it was made by a program before " +
        std::string("they were stored; run its campaign again"));
  Json study = Json::parse(dataset.provenance.study, "study stored in the dataset");
  for (const auto& [name, text] : dataset.provenance.files) {
    write_file_atomically(folder / (name + ".json"), text);
    if (name == "vehicle") study["vehicle"] = name + ".json";
    if (name == "calibration") study["soil"]["calibration"] = name + ".json";
  }
  write_file_atomically(folder / "study.json", study.dump(2) + "\n");
  return folder / "study.json";
}

TrialRecord compute(const TrialSetup& setup, const DesignPoint& point, sim::Backend device, int threads) {
  TrialBatch batch(setup, {device, 1, threads});
  batch.start(point);
  while (batch.running() > 0)
    if (std::vector<TrialRecord> ended = batch.advance(); !ended.empty()) return std::move(ended.front());
  throw DeviceError("the trial ended without a record");
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
  const TemporaryPlace place;
  const TrialSetup setup =
      read_trial_setup(read_study(write_study(dataset, place.folder())), default_packing_folder(), device);
  const int all = threads_or_all(threads);
  prepare_trials(setup, std::span(&stored.point, 1), all);
  Replay replay;
  replay.record = compute(setup, stored.point, device, all);
  replay.same_program = dataset.provenance.program_version == campaign_program();
  replay.differences =
      difference({.records = {stored}, .provenance = {}}, {.records = {replay.record}, .provenance = {}}).rows;
  return replay;
}

}  // namespace gonogo::campaign
