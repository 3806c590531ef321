// Inside base/hdf5 only: files by other programs, which nothing protects from damage.
#pragma once
#include <filesystem>

#include "base/hdf5/open_file.h"

namespace gonogo::hdf5 {

/// Opens a copy in memory of what this program can read of the file: groups, arrays, texts and attributes of the kinds
/// that Hdf5Writer stores. A child process makes it, since HDF5 1.10 crashes or never ends on some damaged files, and
/// what it leaves in memory after an error is not to be trusted. What cannot be read is refused when it is asked for.
/// Links to other files are not followed. Throws InputError for a file that cannot be opened or listed, that crashes
/// HDF5, takes too long or too much memory.
OpenFile open_foreign(const std::filesystem::path& path);

}  // namespace gonogo::hdf5
