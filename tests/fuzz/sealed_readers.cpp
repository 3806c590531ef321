// Files of models, campaigns and problems that hold a hash of themselves: whatever is read is what was written.
#include "base/error.h"
#include "base/files/file.h"
#include "learning/model/model.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/engine/ledger.h"
#include "pipeline/outcome/qubo/problem_file.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/texts.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace gonogo::campaign;

std::vector<TrialRecord> some_trials() {
  std::vector<TrialRecord> records;
  for (const DesignPoint& point : cheap_campaign("unused", 20).design) records.push_back(closed_form_trial(point));
  return records;
}

std::string rows_of(const std::vector<TrialRecord>& records) {
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
  return rows_of(records);
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
  return rows_of(*records);
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
  return text_of(loaded.problem);
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
            [](const fs::path& file) { return text_of(learning::read_model(file)); }),
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
    };
    for (Reader& reader : all) reader.ends_anywhere = reader.name == "journal";  // a trial a line
    return all;
  }();
  return list;
}

}  // namespace gonogo::fuzz
