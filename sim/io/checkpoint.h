// Checkpoint files: the Snapshot of a world in HDF5, exact to the bit. A file holds a hash of its scene and numerics
// and a hash of its own arrays. A file that is truncated, altered, of another version or of another scene is refused as
// a whole with InputError.
#pragma once
#include <filesystem>
#include <string>

#include "base/hdf5/hdf5.h"
#include "sim/simulation/simulation.h"

namespace gonogo::sim {

/// Hash of a world at its start and the settings of its steps, 32 hexadecimal digits. Two that could continue
/// differently from the same snapshot have different hashes.
std::string scene_hash(const SceneWorld& world, const StepSettings& settings);

/// Writes a checkpoint, whole or not at all. Throws DeviceError when the disk refuses.
void save_checkpoint(const std::filesystem::path& path, const Snapshot& snapshot, const std::string& scene);

/// Reads a checkpoint of this scene; throws InputError as said above.
Snapshot load_checkpoint(const std::filesystem::path& path, const std::string& scene);

/// The same as part of a file that holds more. The hash of its arrays is returned, or put into `content`.
std::string store_snapshot(Hdf5Writer& out, const Snapshot& snapshot, const std::string& scene);
Snapshot read_snapshot(const Hdf5Reader& in, const std::string& scene, std::string* content = nullptr);

}  // namespace gonogo::sim
