// HDF5 files of named arrays, texts and attributes.
//
//   Hdf5Writer out;
//   out.array("weights/visible", values, {rows, columns});
//   out.attribute("weights/visible", "unit", "m/s");
//   out.save("model.h5");                       // whole or absent; same content, same bytes
//
//   const Hdf5Reader in("model.h5");
//   const auto values = in.array<double>("weights/visible", Shape{rows, columns});
//
// Paths are "group/.../name"; "" or "/" is the root. Element types T: float, double, std::int32_t, std::int64_t,
// std::uint8_t, std::uint32_t, std::uint64_t, stored little-endian on every machine.
// Not thread-safe: HDF5 has no locks. Use these classes from one thread at a time.
#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gonogo {

/// Lengths per dimension, slowest first (row major). {} is a scalar.
using Shape = std::vector<std::size_t>;

/// Builds a new file in memory. The same calls in the same order give the same bytes on every machine, at any time.
/// The file ends with a hash of its content, which Hdf5Reader checks. Only save() touches the disk.
class Hdf5Writer {
 public:
  Hdf5Writer();
  ~Hdf5Writer();
  Hdf5Writer(Hdf5Writer&&) noexcept;
  Hdf5Writer& operator=(Hdf5Writer&&) noexcept;

  /// Creates a group and its parents, unless they exist.
  void group(const std::string& path);

  /// Stores `values`, row major, under a new name, and creates parent groups. Throws InputError when the name exists or
  /// the count does not match the shape.
  template <class T>
  void array(const std::string& path, const std::vector<T>& values, const Shape& shape) {
    array(path, values.data(), values.size(), shape);
  }
  template <class T>
  void array(const std::string& path, const std::vector<T>& values) {
    array(path, values.data(), values.size(), {values.size()});
  }
  template <class T>
  void array(const std::string& path, const T* values, std::size_t count, const Shape& shape);

  /// UTF-8 without zero bytes, as a scalar or a list.
  void text(const std::string& path, const std::string& value);
  void texts(const std::string& path, const std::vector<std::string>& values);

  /// Attributes of the group or array at `path`, which must exist.
  void attribute(const std::string& path, const std::string& name, const std::string& value);
  void attribute(const std::string& path, const std::string& name, const char* value);
  void attribute(const std::string& path, const std::string& name, double value);
  void attribute(const std::string& path, const std::string& name, std::int64_t value);
  void attribute(const std::string& path, const std::string& name, const std::vector<double>& values);
  void attribute(const std::string& path, const std::string& name, const std::vector<std::int64_t>& values);
  void attribute(const std::string& path, const std::string& name, const std::vector<std::string>& values);

  /// The bytes of the file, seal included.
  std::string image() const;

  /// Writes the file atomically. Throws DeviceError naming the path (disk full, no permission).
  void save(const std::filesystem::path& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Time that reading a file without our seal may take, for a small file; 10 s unless set. Tests of many damaged files
/// set less.
void set_foreign_time(std::chrono::milliseconds longest);

/// A file open for reading. A file without our seal, by another program, is read once in a child process, so that
/// damage which crashes the library or sends it into an endless loop is refused in a sentence. Every method throws
/// InputError "file: place: what is wrong; what to do" for a missing name, an unexpected type or shape, and damaged
/// content.
class Hdf5Reader {
 public:
  /// Throws InputError when the file is missing, unreadable, truncated or not HDF5.
  explicit Hdf5Reader(const std::filesystem::path& path);
  ~Hdf5Reader();
  Hdf5Reader(Hdf5Reader&&) noexcept;
  Hdf5Reader& operator=(Hdf5Reader&&) noexcept;

  const std::filesystem::path& path() const;

  /// Whether a group or array of this name exists.
  bool has(const std::string& path) const;
  /// Names directly below a group, sorted.
  std::vector<std::string> members(const std::string& group) const;
  Shape shape(const std::string& path) const;

  /// All elements, row major. The stored type must be T; nothing is converted.
  template <class T>
  std::vector<T> array(const std::string& path, const std::optional<Shape>& expected = std::nullopt) const;
  std::string text(const std::string& path) const;
  std::vector<std::string> texts(const std::string& path) const;

  bool has_attribute(const std::string& path, const std::string& name) const;
  std::string text_attribute(const std::string& path, const std::string& name) const;
  double number_attribute(const std::string& path, const std::string& name) const;
  std::int64_t integer_attribute(const std::string& path, const std::string& name) const;
  std::vector<double> numbers_attribute(const std::string& path, const std::string& name) const;
  std::vector<std::int64_t> integers_attribute(const std::string& path, const std::string& name) const;
  std::vector<std::string> texts_attribute(const std::string& path, const std::string& name) const;

  /// Throws InputError "file: place: message", for callers that find the content unusable.
  [[noreturn]] void fail(const std::string& path, const std::string& message) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gonogo
