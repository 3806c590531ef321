// What file formats are made of: lines of text, lists of coefficients, bytes and base64.
#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// Reads text line by line and word by word. Messages name file and line.
class TextLines {
 public:
  TextLines(std::string_view text, std::string source) : rest_(text), source_(std::move(source)) {}

  /// Advances to the next line with words. False at the end.
  bool next();
  std::string_view line() const { return line_; }  // without line end
  const std::vector<std::string_view>& words() const { return words_; }

  /// Word k as an integer in [low, high], or as a finite number. Throws InputError otherwise.
  std::int64_t integer(std::size_t k, std::int64_t low, std::int64_t high) const;
  double number(std::size_t k) const;
  void expect_words(std::size_t count) const;
  [[noreturn]] void fail(const std::string& message) const;

 private:
  std::string_view rest_, line_;
  std::string source_;
  std::size_t number_ = 0;
  std::vector<std::string_view> words_;
};

/// Parses the whole text as a finite number, with optional sign and exponent. False otherwise.
bool parse_number(std::string_view text, double& value);

inline constexpr std::int64_t kMaxId = INT32_MAX;
inline constexpr std::int64_t kMaxVariables = 10'000'000;  // in formats that declare a count without a list

/// A coefficient of variables i and j; a linear one has i = j.
struct Entry {
  std::int64_t i = 0, j = 0;
  double value = 0;
};

enum class Repeats { add, refuse };

/// Variables are all ids in `ids` and `entries`, ascending, with the id as label. A pair may be in either order. Throws
/// InputError for repeated entries, unless they are allowed.
Problem problem_from_entries(Vartype vartype, std::vector<std::int64_t> ids, const std::vector<Entry>& entries,
                             Repeats repeats, const std::string& source);

/// Id of each variable in formats without labels: the label, when all labels are different integers from 0 to
/// kMaxId; otherwise the position.
std::vector<std::int64_t> file_ids(const Problem& problem);

/// Couplings as (smaller id, larger id, value), sorted.
std::vector<Entry> coupling_entries(const Problem& problem, const std::vector<std::int64_t>& ids);

/// Positions of the variables by ascending id.
std::vector<std::size_t> by_id(const std::vector<std::int64_t>& ids);

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

/// The inverse of base64(). Throws InputError for invalid characters, padding and lengths. Messages begin with `where`.
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
