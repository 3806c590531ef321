// Every reader of files that come in, with a small whole file for each to be damaged.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace gonogo::fuzz {

struct Reader {
  std::string name;     // "raster_geotiff"
  std::string damaged;  // the file whose bytes change
  std::string opened;   // the file that is read: the same, or one beside it
  std::function<void(const std::filesystem::path& folder)> make;
  /// All that the program sees of the file, as text. Throws InputError for a refused one.
  std::function<std::string(const std::filesystem::path& file)> read;
  bool ends_anywhere = false;  // a file cut at the end of a line is a whole one
};

/// Of rasters, shapes and tables.
const std::vector<Reader>& file_readers();

/// These, and those of files in formats of this project.
const std::vector<Reader>& readers();

}  // namespace gonogo::fuzz
