// Synthetic trials on disk, and the model that most tests of learning ask, trained once per program.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/outcome/training/train_model.h"
#include "tests/pipeline/outcome/synthetic_trials.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::outcome {
using namespace campaign;

inline const std::filesystem::path& scratch() {
  static const TemporaryFolder folder;
  return folder.path();
}

inline std::filesystem::path dataset_file(const std::string& name, std::size_t trials, std::uint64_t seed) {
  std::filesystem::path path = scratch() / name;
  write_dataset(path, {synthetic_trials(trials, seed), {}});
  return path;
}

/// What the model below is trained on.
inline const std::filesystem::path& model_dataset() {
  static const std::filesystem::path path = dataset_file("dataset.h5", 120, 1);
  return path;
}

inline const std::filesystem::path& model_file() {
  static const std::filesystem::path path = [] {
    std::filesystem::path file = scratch() / "model.h5";
    train_model({.dataset = model_dataset(), .model = file, .seed = 3, .learning = {}, .design = {}});
    return file;
  }();
  return path;
}

inline std::vector<double> middle_point() {
  std::vector<double> point = {12, 0, 33, 10, 0.5, 1500, 0.65, 0.3, 2};
  point.resize(contract().variables.size(), 0);
  return point;
}

}  // namespace gonogo::outcome
