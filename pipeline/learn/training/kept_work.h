// Finished parts of a training run, kept in a folder beside the model until the whole run is done. An interrupted run
// that is started again with the same inputs takes them from there.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "learning/rbm/train.h"

namespace gonogo::learn {

/// What a Gaussian process that has not seen a fold says (teacher.h).
struct ProcessAnswers {
  std::vector<double> held_out;  // P(go) of the fold's trials
  std::vector<double> taught;    // P(go) of the taught points; empty where nothing is taught
};

class KeptWork {
 public:
  /// The folder is <model>.unfinished. `key` is a hash of everything that the parts depend on. Parts with another key
  /// are removed.
  KeptWork(const std::filesystem::path& model, std::string key);

  /// A finished fold of the cross-validation. None: it was not kept, or its file is damaged.
  std::optional<learning::FoldResult> fold(std::size_t fold) const;
  void keep_fold(std::size_t fold, const learning::FoldResult& result) const;

  /// The answers of a fold's Gaussian process, likewise.
  std::optional<ProcessAnswers> process(std::size_t fold) const;
  void keep_process(std::size_t fold, const ProcessAnswers& answers) const;

  /// Whether `file` is a member that this run finished, with the bytes it had then.
  bool has_member(const std::filesystem::path& file) const;
  void keep_member(const std::filesystem::path& file) const;

  /// Removes the folder. To be called once the run's files are written.
  void remove() const;

 private:
  std::filesystem::path part(const std::string& name) const;
  std::filesystem::path folder_;
  std::string key_;
};

}  // namespace gonogo::learn
