// Checkpoint files: the Snapshot of a world on disk, exact to the bit. HDF5, so that h5py and h5dump can look into one.
// A file holds the hash of the scene and the numerics it belongs to and a hash of its own arrays; one that is
// truncated, altered, of another version or of another scene is refused with InputError and never half taken over.
#pragma once
#include <filesystem>
#include <string>

#include "base/hdf5/hdf5.h"
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// Names a world at its start together with the settings of its steps: two that could go on differently from the same
/// snapshot have different hashes. 32 hexadecimal digits.
std::string scene_hash(const SceneWorld& world, const StepSettings& settings);

/// Writes a checkpoint, whole or not at all. Throws DeviceError when the disk refuses.
void save_checkpoint(const std::filesystem::path& path, const Snapshot& snapshot, const std::string& scene);

/// Reads a checkpoint of this scene.
Snapshot load_checkpoint(const std::filesystem::path& path, const std::string& scene);

/// The same inside a file that holds more, such as the measures of a trial.
void store_snapshot(Hdf5Writer& out, const Snapshot& snapshot, const std::string& scene);
Snapshot read_snapshot(const Hdf5Reader& in, const std::string& scene);

}  // namespace gonogo::sim
