// Inside base/hdf5 only: an HDF5 file that is open for reading.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/hdf5/handle.h"

namespace gonogo::hdf5 {

/// One array or attribute, opened for reading.
struct Source {
  Handle object{}, type{}, space{};
  bool is_attribute = false;
  std::string where;

  bool fetch(hid_t memory, void* target) const {
    return (is_attribute ? H5Aread(object.get(), memory, target)
                         : H5Dread(object.get(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target)) >= 0;
  }
};

bool same_kind(hid_t a, hid_t b);
/// "32-bit signed integers".
std::string kind_name(hid_t type);
Shape shape_of(hid_t space);

/// What Hdf5Reader promises, in the library's terms.
struct OpenFile {
  std::filesystem::path path;  // as messages name it
  Handle file;

  /// Opens the bytes of the disk. Throws InputError unless they are an HDF5 file.
  static OpenFile of_disk(const std::filesystem::path& path);
  /// Opens bytes in memory, which are copied; `path` is where they come from.
  static OpenFile of_memory(const std::filesystem::path& path, const std::string& image);

  [[noreturn]] void fail(const std::string& where, const std::string& message) const;
  bool has(const std::string& name) const;
  std::vector<std::string> members(const std::string& group) const;
  Source open_array(const std::string& name) const;
  Source open_attribute(const std::string& path, const std::string& name) const;
  template <class T>
  std::vector<T> fetch(const Source& source, const std::optional<Shape>& expected) const;
  std::vector<std::string> fetch_texts(const Source& source, bool scalar) const;

 private:
  void check_storage(const Source& source, std::size_t bytes) const;
};

/// Attribute of a copied array that could not be read: the sentence to refuse it with (foreign.h).
extern const char* const kWhyNot;
/// The same for an attribute of an object.
std::string why_not(const std::string& attribute);

}  // namespace gonogo::hdf5
