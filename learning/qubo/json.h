// JSON that other programs write and read: a strict reader, text with the bytes of Python, labels as dimod has them.
#pragma once
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/json/json.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// Strict reader of one JSON object. Messages name the file and the place. Unlike Config it allows unknown keys,
/// because writers add their own.
class JsonReader {
 public:
  JsonReader(const Json& json, std::string source, std::string where)
      : json_(json), source_(std::move(source)), where_(std::move(where)) {
    if (!json_.is_object()) fail("", "expected an object { }, found " + json_.type_name());
  }

  [[noreturn]] void fail(const std::string& key, const std::string& message) const {
    const std::string place = where_ + (where_.empty() || key.empty() ? "" : ".") + key;
    throw InputError(source_ + ": " + (place.empty() ? "" : place + ": ") + message);
  }
  const Json* find(const std::string& key) const { return json_.find(key); }
  const Json& at(const std::string& key) const {
    if (const Json* value = json_.find(key)) return *value;
    fail(key, "missing");
  }
  JsonReader object(const std::string& key) const {
    return JsonReader(at(key), source_, where_ + (where_.empty() ? "" : ".") + key);
  }
  /// The k-th entry of a list of objects.
  JsonReader item(const std::string& key, std::size_t k) const {
    return JsonReader(list(key).at(k), source_,
                      where_ + (where_.empty() ? "" : ".") + key + "[" + std::to_string(k) + "]");
  }
  std::int64_t integer(const std::string& key, std::int64_t low, std::int64_t high) const {
    return as_integer(at(key), key, low, high);
  }
  const Json::Array& list(const std::string& key) const {
    if (!at(key).is_array()) fail(key, "expected a list, found " + at(key).type_name());
    return at(key).items();
  }
  std::string text(const std::string& key) const {
    if (!at(key).is_string()) fail(key, "expected text, found " + at(key).type_name());
    return at(key).string();
  }
  double number(const std::string& key) const { return as_number(at(key), key); }
  std::size_t count(const std::string& key) const { return std::size_t(as_integer(at(key), key, 0, INT32_MAX)); }
  std::vector<double> numbers(const std::string& key) const {
    std::vector<double> result;
    for (const Json& item : list(key)) result.push_back(as_number(item, key));
    return result;
  }
  std::vector<std::int64_t> integers(const std::string& key, std::int64_t low, std::int64_t high) const {
    std::vector<std::int64_t> result;
    for (const Json& item : list(key)) result.push_back(as_integer(item, key, low, high));
    return result;
  }
  std::int64_t as_integer(const Json& item, const std::string& key, std::int64_t low, std::int64_t high) const {
    if (!item.is_integer() || item.number() < double(low) || item.number() > double(high))
      fail(key, "expected whole numbers between " + std::to_string(low) + " and " + std::to_string(high) + ", found " +
                    item.dump());
    return item.integer();
  }
  void expect_text(const std::string& key, const std::string& wanted) const {
    if (text(key) != wanted) fail(key, "expected \"" + wanted + "\", found \"" + text(key) + "\"");
  }
  void expect_size(const std::string& key, std::size_t found, std::size_t wanted) const {
    if (found != wanted) fail(key, std::to_string(found) + " entries where " + std::to_string(wanted) + " belong");
  }
  /// Throws InputError for byte arrays, whose layout depends on the writer's numpy. Lists are required.
  void expect_no_bytes() const {
    const Json* bytes = find("use_bytes");
    if (!bytes || !bytes->is_bool() || bytes->boolean())
      fail("use_bytes", "expected false; write the file with use_bytes=False");
  }

 private:
  double as_number(const Json& item, const std::string& key) const {
    if (!item.is_number() || !std::isfinite(item.number())) fail(key, "expected finite numbers, found " + item.dump());
    return item.number();
  }
  const Json& json_;
  std::string source_, where_;
};

/// Python's repr(x): the fewest digits that read back to the same bits, with an exponent below 1e-4 and from 1e16 on.
std::string python_number(double x);

enum class JsonSpaces { compact, after };  // "," and ":"; or ", " and ": ", Python's default

/// The bytes of Python's json.dumps, because annealing tools are written in Python, and hashes and test files compare
/// bytes: ASCII, numbers as in repr(). One line, keys in their order. NaN and infinities are null, as in Json::dump().
std::string python_json(const Json& json, JsonSpaces spaces);

Json labels_json(const std::vector<Label>& labels);

/// Throws InputError for what dimod could not have written, and for another count.
std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count);

/// "BINARY" or "SPIN".
Vartype vartype_from_json(const JsonReader& reader, const std::string& key);

}  // namespace gonogo::learning
