// Files of ours that hold a hash of themselves: whatever is read from them is what was written.
#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "learning/model/model.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/ledger.h"
#include "pipeline/outcome/qubo/problem_file.h"
#include "sim/io/checkpoint.h"
#include "terrain/soil_test/calibrate.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fuzz/readers.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/scenes.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace gonogo::campaign;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)) + "|";
}

std::string read_model_file(const fs::path& file) {
  const learning::Model m = learning::read_model(file);
  std::string text = m.layout.to_json().dump() + m.provenance.dump() + bytes_of(m.weights.weight) +
                     bytes_of(m.weights.visible_bias) + bytes_of(m.weights.hidden_bias) + bytes_of(m.sampled_lower) +
                     bytes_of(m.sampled_upper) + bytes_of(m.training_points) + bytes_of(m.training_outcomes) +
                     bytes_of(m.training_weights) + bytes_of(m.log) + bytes_of(std::vector{m.calibration_power});
  for (const auto& variable : m.input_prior) text += bytes_of(variable);
  return text;
}

const std::string kScene = "scene";

/// Some grains that fall.
void make_checkpoint(const fs::path& folder) {
  sim::SceneWorld world;
  world.size = {1, 1, 1};
  test::add_plane(world);
  for (int k = 0; k < 27; ++k)
    world.add_sphere(Vec3d{0.2 + 0.3 * (k % 3), 0.2 + 0.3 * (k / 3 % 3), 0.2 + 0.3 * (k / 9)}, 0.1f, 2600, 0);
  const auto simulation = test::simulate(sim::Backend::cpu, world, sim::StepSettings{});
  simulation->advance(100);
  sim::save_checkpoint(folder / "run.h5", simulation->snapshot(0), kScene);
}

std::string read_checkpoint(const fs::path& file) {
  Hdf5Writer out;
  sim::store_snapshot(out, sim::load_checkpoint(file, kScene), kScene);
  return out.image();
}

std::vector<TrialRecord> some_trials() {
  std::vector<TrialRecord> records;
  for (const DesignPoint& point : cheap_campaign("unused", 20).design) records.push_back(closed_form_trial(point));
  return records;
}

std::string text_of(const std::vector<TrialRecord>& records) {
  std::string text;
  for (const TrialRecord& record : records) text += to_row(record) + "\n";
  return text;
}

/// A campaign that sets damaged lines aside says so, which counts as a refusal here.
std::string read_trials_of_journal(const fs::path& file) {
  const JournalContent content = read_journal(file);
  if (content.damaged_count > 0) throw InputError(file.string() + ": damaged lines");
  std::vector<TrialRecord> records;
  for (const auto& [index, record] : content.records) records.push_back(record);
  return text_of(records);
}

constexpr ShardPlan kPlan{.trials = 22, .per_shard = 22};

void make_shard(const fs::path& folder) {
  fs::create_directories(shard_folder(folder));
  commit_shard(folder, 0, some_trials(), cheap_campaign("unused", 20).provenance, "campaign");
}

/// Of the folder of shards/<file>.
std::string read_trials_of_shard(const fs::path& file) {
  const auto records = read_shard(file.parent_path().parent_path(), 0, "campaign");
  if (!records) throw InputError(file.string() + ": is not committed");
  return text_of(*records);
}

void make_problem(const fs::path& folder) {
  learning::Problem problem;
  for (int k = 0; k < 12; ++k) {
    problem.labels.emplace_back("unit " + std::to_string(k));
    problem.linear.push_back(0.5 * k - 2);
    if (k > 0) problem.couplings.push_back({std::uint32_t(k - 1), std::uint32_t(k), 1 - 0.125 * k});
  }
  problem.offset = 3.5;
  outcome::write_problem_file(problem, {}, folder / "a.bqpjson", {});
}

std::string read_problem(const fs::path& file) {
  const outcome::LoadedProblem loaded = outcome::load_problem(file.parent_path() / "a.bqpjson", {});
  if (!loaded.sidecar) throw InputError(file.string() + ": is no sidecar");
  std::string text = bytes_of(loaded.problem.linear) + bytes_of(std::vector{loaded.problem.offset});
  for (const learning::Label& label : loaded.problem.labels) text += learning::label_text(label) + ",";
  for (const learning::Coupling& c : loaded.problem.couplings)
    text += std::to_string(c.a) + "-" + std::to_string(c.b) + bytes_of(std::vector{c.value});
  return text;
}

void make_map_folder(const fs::path& folder) {
  const TemporaryFolder ground_folder;
  test::make_wavy_region(ground_folder, "waves", {40, 60, 37, 53});
  map::MapRequest request = test::request_of_region(ground_folder, "map");
  request.threads = 1;
  map::make_map(request);
  for (const char* name : {"map.json", "go.tif"}) fs::copy_file(ground_folder / "map" / name, folder / name);
}

std::string read_map(const fs::path& file) {
  map::require_whole_map(file.parent_path(), {"go.tif"});
  return Json::read(file.parent_path() / "map.json").dump() + read_file(file.parent_path() / "go.tif");
}

Reader sealed(const std::string& name, const std::string& file, std::function<void(const fs::path&)> make,
              std::function<std::string(const fs::path&)> read) {
  return {.name = name,
          .damaged = file,
          .opened = file,
          .make = std::move(make),
          .read = std::move(read),
          .is_sealed = true};
}

void make_soil_journal(const fs::path& folder) {
  terrain::TestJournal journal(folder / "tests.json", "maker");
  for (const char* test : {"triaxial loose 0.1", "triaxial dense 0.1", "plate 30 mm"})
    journal.add(test, {0.125, 31.25, 1e-9, 4e5});
}

std::string read_soil_journal(const fs::path& file) {
  const terrain::TestJournal journal(file, "maker");
  std::string text;
  for (const char* test : {"triaxial loose 0.1", "triaxial dense 0.1", "plate 30 mm"})
    if (const auto numbers = journal.find(test)) text += bytes_of(*numbers);
  return text;
}

}  // namespace

const std::vector<Reader>& sealed_readers() {
  static const std::vector<Reader> list = [] {
    std::vector<Reader> all = {
        sealed(
            "model", "model.h5",
            [](const fs::path& folder) {
              fs::copy_file(fs::path(GONOGO_SOURCE_DIR) / "data/quarter_wheel_90mm/model.h5", folder / "model.h5");
            },
            read_model_file),
        sealed("checkpoint", "run.h5", make_checkpoint, read_checkpoint),
        sealed(
            "dataset", "dataset.h5",
            [](const fs::path& folder) { write_file_atomically(folder / "dataset.h5", expected_bytes(20)); },
            [](const fs::path& file) { return dataset_image(read_dataset(file)); }),
        sealed(
            "journal", "journal", [](const fs::path& folder) { write_journal(folder / "journal", some_trials()); },
            read_trials_of_journal),
        sealed(
            "campaign", "campaign.json",
            [](const fs::path& folder) { hold_folder(folder, kPlan, cheap_campaign("unused", 20).depends_on); },
            [](const fs::path& file) {
              hold_claimed_folder(file.parent_path(), FolderUse::tasks, kPlan.trials,
                                  cheap_campaign("unused", 20).depends_on);
              return std::to_string(read_claim(file.parent_path()).per_shard);
            }),
        sealed("shard", "shards/shard-0.22.h5", make_shard, read_trials_of_shard),
        sealed("manifest", "shards/shard-0.json", make_shard, read_trials_of_shard),
        sealed("sidecar", "a.bqpjson.sidecar.json", make_problem, read_problem),
        sealed("map_record", "map.json", make_map_folder, read_map),
        sealed("map_layer", "go.tif", make_map_folder, read_map),
        sealed("soil_journal", "tests.json", make_soil_journal, read_soil_journal),
    };
    for (Reader& reader : all) reader.ends_anywhere = reader.name == "journal";  // a trial a line
    return all;
  }();
  return list;
}

}  // namespace gonogo::fuzz
