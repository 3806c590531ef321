// Little-endian bytes in memory, and base64 of RFC 4648 (section 4, with padding).
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace gonogo::learning {

static_assert(std::endian::native == std::endian::little, "binary formats are written as they are in memory");

template <class T>
void append_bytes(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  out.append(bytes, sizeof(T));
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// Reads a buffer from front to end. Throws InputError when it ends too early.
class ByteReader {
 public:
  ByteReader(std::string_view bytes, std::string source) : bytes_(bytes), source_(std::move(source)) {}
  std::size_t position() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  std::string_view take(std::size_t count, const std::string& what) {
    if (count > remaining())
      fail("the file ends inside " + what + ": " + std::to_string(count) + " bytes are declared, " +
           std::to_string(remaining()) + " are left");
    const std::string_view part = bytes_.substr(at_, count);
    at_ += count;
    return part;
  }
  template <class T>
  T number(const std::string& what) {
    T value;
    std::memcpy(&value, take(sizeof(T), what).data(), sizeof(T));
    return value;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(source_ + ": byte " + std::to_string(at_) + ": " + message);
  }

 private:
  std::string_view bytes_;
  std::string source_;
  std::size_t at_ = 0;
};

std::string base64(std::string_view bytes);
/// Throws InputError for invalid characters, padding and lengths. Messages begin with `where`.
std::string from_base64(std::string_view text, const std::string& where);

/// Numbers from base64 of their little-endian bytes. Throws InputError for an incomplete number.
template <class T>
std::vector<T> numbers_from_base64(std::string_view text, const std::string& where) {
  const std::string bytes = from_base64(text, where);
  if (bytes.size() % sizeof(T) != 0)
    throw InputError(where + ": " + std::to_string(bytes.size()) + " bytes are no whole number of " +
                     std::to_string(sizeof(T)) + "-byte values");
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace gonogo::learning
