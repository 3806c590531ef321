// Opens files of GDAL's formats that hold what they show. Formats that name hosts, databases or raw bytes of other
// files stay closed. Only for the .cpp files of terrain/raster.
#pragma once
#include <filesystem>
#include <string>

#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {

enum class FileKind { raster, vector };

/// Registers GDAL's drivers once. In a process whose GDAL nobody used before, only those of the lists are left, so that
/// no file leads to another format either; where a host program has registered drivers, its own stay.
void register_drivers();

/// Opens a regular file, a folder that is a format of its own, or what a .zip holds, for reading. A virtual raster is
/// opened if every source that it names is such a file; a header that names a file of values in another folder is
/// refused. With network_allowed() any format is opened.
/// Throws InputError: no such file, a format that is not on the list, a damaged file, more than a minute without an
/// answer; Cancelled while it waits.
DatasetHandle open_file(const std::filesystem::path& path, FileKind kind);

}  // namespace gonogo::terrain
