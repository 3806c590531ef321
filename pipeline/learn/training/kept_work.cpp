#include "pipeline/learn/training/kept_work.h"

#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/hdf5/hdf5.h"
#include "base/progress.h"

namespace gonogo::learn {

namespace fs = std::filesystem;

KeptWork::KeptWork(const fs::path& model, std::string key)
    : folder_(model.string() + ".unfinished"), key_(std::move(key)) {
  if (!fs::is_directory(folder_)) return;
  for (const auto& entry : fs::directory_iterator(folder_))
    if (entry.path().filename().string().rfind(key_ + ".", 0) != 0) fs::remove(entry.path());
}

fs::path KeptWork::part(const std::string& name) const { return folder_ / (key_ + "." + name); }

std::optional<learning::FoldResult> KeptWork::fold(std::size_t fold) const {
  const fs::path path = part("fold" + std::to_string(fold) + ".h5");
  if (!fs::exists(path)) return std::nullopt;
  try {
    const Hdf5Reader in(path);
    learning::FoldResult result;
    result.probability = in.array<double>("probability");
    const auto epoch = in.array<double>("epoch"), loss = in.array<double>("training_loss", Shape{epoch.size()});
    for (std::size_t r = 0; r < epoch.size(); ++r) result.log.push_back({epoch[r], loss[r], NAN});
    return result;
  } catch (const InputError& damaged) {
    log_line("train", std::string(damaged.what()) + "; the fold is trained again");
    return std::nullopt;
  }
}

void KeptWork::keep_fold(std::size_t fold, const learning::FoldResult& result) const {
  std::vector<double> epoch, loss;
  for (const learning::EpochLog& entry : result.log) {
    epoch.push_back(entry.epoch);
    loss.push_back(entry.training_loss);
  }
  Hdf5Writer out;
  out.array("probability", result.probability);
  out.array("epoch", epoch);
  out.array("training_loss", loss);
  create_folder(folder_);
  out.save(part("fold" + std::to_string(fold) + ".h5"));
}

std::optional<ProcessAnswers> KeptWork::process(std::size_t fold) const {
  const fs::path path = part("process" + std::to_string(fold) + ".h5");
  if (!fs::exists(path)) return std::nullopt;
  try {
    const Hdf5Reader in(path);
    return ProcessAnswers{in.array<double>("held_out"), in.array<double>("taught")};
  } catch (const InputError& damaged) {
    log_line("train", std::string(damaged.what()) + "; the Gaussian process is fitted again");
    return std::nullopt;
  }
}

void KeptWork::keep_process(std::size_t fold, const ProcessAnswers& answers) const {
  Hdf5Writer out;
  out.array("held_out", answers.held_out);
  out.array("taught", answers.taught);
  create_folder(folder_);
  out.save(part("process" + std::to_string(fold) + ".h5"));
}

bool KeptWork::has_member(const fs::path& file) const {
  const fs::path record = part(file.filename().string() + ".hash");
  return fs::exists(record) && fs::exists(file) && read_file(record) == file_hash(file);
}

void KeptWork::keep_member(const fs::path& file) const {
  write_file_atomically(part(file.filename().string() + ".hash"), file_hash(file));
}

void KeptWork::remove() const { fs::remove_all(folder_); }

}  // namespace gonogo::learn
