// A running trial on disk: its attempt and phase, its bed, its world and the monitors' sums. A killed trial goes on
// from there and ends with the bits of one that was never killed.
#pragma once
#include <filesystem>
#include <string>

#include "base/hdf5/hdf5.h"
#include "pipeline/campaign/trial/drive.h"

namespace gonogo::campaign {

/// A trial to be saved. The hashes (sim/io/checkpoint.h) are those of the world of its first phase and of its present
/// world.
struct RunState {
  std::uint64_t attempt = 1;
  std::string bed_scene, scene;    // hashes
  const TiltedBed* bed = nullptr;  // at the end of the first phase; null during it
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
