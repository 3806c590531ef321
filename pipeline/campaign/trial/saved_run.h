// A running trial on disk: which attempt it is and in which phase, its bed, its world and what its monitor has seen. A
// trial that was killed goes on from there and ends with the bits of one that was not.
#pragma once
#include <filesystem>
#include <string>

#include "base/hdf5/hdf5.h"
#include "pipeline/campaign/trial/drive.h"

namespace gonogo::campaign {

/// A trial now. `bed_scene` and `scene` are the hashes (sim/io/checkpoint.h) of the world of its first phase and of its
/// present one; `bed` is that at the end of the first phase, null as long as that has not ended.
struct RunState {
  std::uint64_t attempt;
  std::string bed_scene, scene;
  const TiltedBed* bed;
  sim::Snapshot world;
};

/// Writes the file, whole or not at all.
void save_run(const std::filesystem::path& path, const RunState& state);

/// The file read back, in the order in which a trial can check it. Everything throws InputError for a damaged file and
/// one of another trial.
class SavedRun {
 public:
  explicit SavedRun(const std::filesystem::path& path);

  std::uint64_t attempt() const;
  /// Whether the first phase was over.
  bool driving() const;
  TiltedBed bed(const std::string& bed_scene) const;
  sim::Snapshot world(const std::string& scene) const;

 private:
  Hdf5Reader in_;
};

}  // namespace gonogo::campaign
