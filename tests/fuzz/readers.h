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

/// A reader of files that hold a hash of themselves.
inline Reader sealed(const std::string& name, const std::string& file,
                     std::function<void(const std::filesystem::path&)> make,
                     std::function<std::string(const std::filesystem::path&)> read) {
  return {.name = name,
          .damaged = file,
          .opened = file,
          .make = std::move(make),
          .read = std::move(read),
          .is_sealed = true};
}

/// Of files that people and other programs write in formats of this project, and of annealing problems and answers.
const std::vector<Reader>& format_readers();

/// Of HDF5 files without the seal that this program adds: nothing tells damage, and HDF5's own reader sees all of it,
/// in a process of its own.
const std::vector<Reader>& unsealed_readers();

/// Of models, campaigns and problems that this project writes.
const std::vector<Reader>& sealed_readers();

/// Of simulations, maps and soil tests.
const std::vector<Reader>& made_readers();

/// All of these.
const std::vector<Reader>& readers();

}  // namespace gonogo::fuzz
