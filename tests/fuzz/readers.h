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
  bool is_sealed = false;      // it holds a hash of itself: what is read is what was written
};

/// Of rasters, shapes and tables.
const std::vector<Reader>& file_readers();

/// Of files that this project writes and that hold a hash of themselves.
const std::vector<Reader>& sealed_readers();

/// All, with those of files that people write in formats of this project.
const std::vector<Reader>& readers();

}  // namespace gonogo::fuzz
