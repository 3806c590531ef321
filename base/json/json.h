// JSON values and text. nlohmann-json does the parsing and printing; its types stay in json.cpp.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace gonogo {

/// A JSON value. Objects keep the order of their keys, so that output is reproducible to the byte.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json() : value_(nullptr) {}
  Json(std::nullptr_t) : value_(nullptr) {}
  Json(bool b) : value_(b) {}
  Json(int i) : value_(std::int64_t(i)) {}
  Json(std::int64_t i) : value_(i) {}
  Json(std::uint64_t u) : value_(u) {}
  Json(unsigned u) : value_(std::int64_t(u)) {}
  Json(double x) : value_(x) {}
  Json(const char* s) : value_(std::string(s)) {}
  Json(std::string s) : value_(std::move(s)) {}
  Json(Array a) : value_(std::move(a)) {}
  Json(Object o) : value_(std::move(o)) {}
  template <class T>
  Json(const std::vector<T>& items) : value_(Array(items.begin(), items.end())) {}
  static Json object() { return Object{}; }
  static Json array() { return Array{}; }

  bool is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }
  bool is_bool() const { return std::holds_alternative<bool>(value_); }
  bool is_integer() const {
    return std::holds_alternative<std::int64_t>(value_) || std::holds_alternative<std::uint64_t>(value_);
  }
  bool is_number() const { return is_integer() || std::holds_alternative<double>(value_); }
  bool is_string() const { return std::holds_alternative<std::string>(value_); }
  bool is_array() const { return std::holds_alternative<Array>(value_); }
  bool is_object() const { return std::holds_alternative<Object>(value_); }

  /// The value as this type. Throws InputError when it is another type.
  bool boolean() const;
  std::int64_t integer() const;
  std::uint64_t unsigned_integer() const;
  double number() const;
  const std::string& string() const;
  const Array& items() const;
  const Object& members() const;

  /// Member of an object, or null when absent.
  const Json* find(std::string_view key) const;
  /// Member of an object; throws InputError when absent.
  const Json& at(std::string_view key) const;
  /// Member of an object, appended when absent. Turns null into an object.
  Json& operator[](std::string_view key);
  void push_back(Json item);

  std::string type_name() const;  ///< "number", "text", "list", ... as a person would say it
  /// JSON text; on one line when indent < 0. Doubles print with the fewest digits that read back to the same bits.
  /// NaN and infinities print as null.
  std::string dump(int indent = -1) const;

  /// Parses text. Throws PlacedInputError for a syntax error, a key given twice in one object, a number beyond double
  /// range, and nesting deeper than 512 levels. `name`, usually the file, begins its message.
  static Json parse(std::string_view text, const std::string& name);
  static Json read(const std::filesystem::path& path);

 private:
  std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object> value_;
};

}  // namespace gonogo
