// Inside base/hdf5 only: owned HDF5 identifiers, element types and the library's error stack as one phrase.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/hdf5/hdf5.h"

namespace gonogo::hdf5 {

/// Silences the library's own error messages for the whole process. Call it first.
void quiet();

/// The deepest message of the library's error stack ("unable to open file: ..."), then clears the stack.
std::string take_error();

/// Owns one identifier. A negative one means that its call failed.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, -1);
      close_ = other.close_;
    }
    return *this;
  }

  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = -1;
  }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// How an element type is stored, how it lies in memory, and what a person calls it.
struct ElementType {
  hid_t stored, memory;
  const char* name;
};
template <class T>
ElementType element_type();

/// Variable-length UTF-8 text.
Handle text_type();

/// "a/b/c" -> {"a", "b", "c"}; empty parts are dropped.
std::vector<std::string> split_path(const std::string& path);

/// Seal at the end of our files: the hash of all bytes before it. Other programs ignore it, since HDF5's own end comes
/// first. HDF5 checks only parts of a file, and damaged files can send it into endless loops.
std::string seal_of(std::string_view content);
/// Bytes of `file` before its seal; all of them in a file by another program, which has none.
std::string_view without_seal(std::string_view file);

std::string to_text(const Shape& shape);
std::size_t element_count(const Shape& shape);

}  // namespace gonogo::hdf5
