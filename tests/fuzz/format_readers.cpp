// Files that people and other programs write in formats of this project, and problems and answers of annealers.
#include "base/error.h"
#include "base/files/file.h"
#include "learning/formats/dimod.h"
#include "learning/formats/format.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/study/study.h"
#include "pipeline/map/region/region.h"
#include "pipeline/outcome/qubo/problem_file.h"
#include "pipeline/outcome/settings.h"
#include "terrain/soil/soil.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fuzz/ground.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/texts.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::fuzz {
namespace {

namespace fs = std::filesystem;

std::function<void(const fs::path&)> copying(const std::string& file, const std::string& shipped) {
  return writing(file, read_file(fs::path(GONOGO_SOURCE_DIR) / shipped));
}

std::string read_region_file(const fs::path& file) {
  const map::Region region = map::read_region(file);
  return std::to_string(region.values.size()) + region.elevation.files.name();
}

void make_region(const fs::path& folder) {
  test::make_raster(folder / "elevation.tif", ground());
  write_file_atomically(folder / "region.json",
                        R"({"schema": "gonogo/region/1", "region": "r", "rasters": [{"role": "elevation",)"
                        R"( "file": "elevation.tif", "source": "s", "licence": "l"}],)"
                        R"( "values": {"friction_angle": {"range": [25, 35], "source": "s"}}})");
}

/// Frame, design and learning: sections that cost no bed. Designs of more points than a campaign has are not made.
std::string read_study_file(const fs::path& file) {
  constexpr std::uint64_t kMostTrials = 10000;
  const campaign::Study study = campaign::read_study(file);
  std::string text = study.name + "|" + std::to_string(study.seed) + bytes_of(std::vector{study.gravity}) +
                     study.vehicle.filename().string() + study.region.filename().string();
  const campaign::DesignSpec spec = campaign::read_design(study.section("design"), study.seed);
  text += std::to_string(campaign::trial_count(spec));
  if (campaign::trial_count(spec) <= kMostTrials)
    for (const campaign::DesignPoint& point : campaign::make_design(spec)) text += bytes_of(point.variables);
  const std::optional<Config> learning = study.config.object_if("learning");
  return text + outcome::to_json(outcome::read_learning_settings(learning)).dump();
}

constexpr int kVariables = 12;

/// Of whole numbers for variables, as formats without labels have them.
learning::Problem some_problem() {
  learning::Problem problem;
  for (int k = 0; k < kVariables; ++k) {
    problem.labels.emplace_back(std::int64_t(k));
    problem.linear.push_back(0.5 * k - 2);
    if (k > 0) problem.couplings.push_back({std::uint32_t(k - 1), std::uint32_t(k), 1 - 0.125 * k});
  }
  return problem;
}

/// A problem without its sidecar, as other programs write it.
Reader problem(const std::string& name, const std::string& file, bool ends_anywhere = false) {
  const auto make = [file](const fs::path& folder) {
    outcome::write_problem_file(some_problem(), {}, folder / file, {});
    fs::remove(learning::sidecar_path(folder / file));
  };
  const auto read = [](const fs::path& path) { return text_of(outcome::load_problem(path, {}).problem); };
  return {name, file, file, make, read, ends_anywhere};
}

learning::SampleSet some_answer() {
  const learning::Problem problem = some_problem();
  learning::SampleSet answer{.vartype = problem.vartype, .labels = problem.labels};
  for (int row = 0; row < 5; ++row) {
    for (int k = 0; k < kVariables; ++k) answer.values.push_back(std::int8_t((k + row) % 3 == 0));
    answer.energies.push_back(
        learning::energy(problem, std::span(answer.values).subspan(std::size_t(row) * kVariables, kVariables)));
    answer.occurrences.push_back(row + 1);
  }
  return answer;
}

/// Verified against its problem: an answer that reads otherwise has rows of other values.
Reader answer(const std::string& name, const std::string& file, const std::string& format, const std::string& text,
              bool ends_anywhere = false) {
  const auto read = [format](const fs::path& path) {
    const learning::Problem problem = some_problem();
    const learning::SampleSet rows = learning::check_answer(
        problem, learning::read_answer(read_file(path), learning::answer_format_named(format), problem, path.string()),
        path.string());
    return bytes_of(rows.values) + bytes_of(rows.energies) + bytes_of(rows.occurrences);
  };
  return {name, file, file, writing(file, text), read, ends_anywhere};
}

/// A whole HDF5 file less its seal.
std::string unsealed(const std::string& whole) { return whole.substr(0, whole.rfind("\ngonogo seal ")); }

void make_unsealed_dataset(const fs::path& folder) {
  write_file_atomically(folder / "dataset.h5", unsealed(campaign::expected_bytes(20)));
}

void make_unsealed_model(const fs::path& folder) {
  const fs::path shipped = fs::path(GONOGO_SOURCE_DIR) / "data/quarter_wheel_90mm/model.h5";
  write_file_atomically(folder / "model.h5", unsealed(read_file(shipped)));
}

}  // namespace

const std::vector<Reader>& format_readers() {
  static const std::vector<Reader> list = {
      {"region", "region.json", "region.json", make_region, read_region_file},
      {"soil", "sand.json", "sand.json", copying("sand.json", "configs/soils/lete_sand.json"),
       [](const fs::path& file) { return std::to_string(terrain::read_soil(file).states.size()); }},
      {"vehicle", "v.json", "v.json", copying("v.json", "configs/vehicles/hmmwv.json"),
       [](const fs::path& file) { return std::to_string(vehicle::read_any_vehicle(file).wheel.size()); }},
      {"study", "study.json", "study.json", copying("study.json", "configs/studies/demo.json"), read_study_file},
      problem("problem_json", "a.json"),
      problem("problem_bqpjson", "a.bqpjson"),
      problem("problem_coo", "a.coo", true),
      answer("answer_json", "answer.json", "dimod_json", learning::to_dimod_json(some_answer())),
      answer("answer_csv", "answer.csv", "csv", learning::samples_csv(some_answer()), true),
  };
  return list;
}

const std::vector<Reader>& unsealed_readers() {
  static const std::vector<Reader> list = {
      {"dataset_unsealed", "dataset.h5", "dataset.h5", make_unsealed_dataset,
       [](const fs::path& file) { return campaign::dataset_image(campaign::read_dataset(file)); }},
      {"model_unsealed", "model.h5", "model.h5", make_unsealed_model,
       [](const fs::path& file) { return text_of(learning::read_model(file)); }},
  };
  return list;
}

}  // namespace gonogo::fuzz
