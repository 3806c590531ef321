// Checkpoints by parts: each rank of a divided world writes the state of its own bodies into a file beside that of the
// checkpoint, which names these files. Any number of ranks continues from them, with the same bits. A part's file is
// named by its content, so that a new state is written beside the old one and counts once the checkpoint names it.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/hdf5/hdf5.h"
#include "sim/simulation/parts/divided.h"

namespace gonogo::sim {

/// Writes the files of all parts: those of processes at the same time, those of threads one after the other, since HDF5
/// has no locks. All ranks call it. Returns the names of the files, by part. Throws DeviceError when the disk refuses.
std::vector<std::string> write_parts(const std::filesystem::path& checkpoint, InParts& world, const std::string& scene);

/// Names the files in the checkpoint's own.
void store_parts(Hdf5Writer& out, const std::vector<std::string>& names);

/// Whether a checkpoint names files of parts.
bool has_parts(const Hdf5Reader& checkpoint);

/// The state of the whole world. Throws InputError for files that are missing, damaged or of another scene.
Snapshot read_parts(const Hdf5Reader& checkpoint, const std::string& scene);

/// Removes files of parts of this checkpoint but those that are named.
void remove_parts_but(const std::vector<std::string>& names, const std::filesystem::path& checkpoint);

/// A checkpoint that holds a divided world and nothing else. All ranks call it; the first one writes the file that
/// names the others.
void save_checkpoint_by_parts(const std::filesystem::path& path, InParts& world, const std::string& scene, bool first);

}  // namespace gonogo::sim
