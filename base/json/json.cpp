#include "base/json/json.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/files/file.h"

namespace gonogo {
namespace {

using Library = nlohmann::ordered_json;

constexpr std::size_t kMaxDepth = 512;  // of nested lists and objects: deeper text is an attack or an accident

/// Where the token starts whose last byte is the text's `position`th; the library counts bytes from 1. Its `token` is
/// whole for strings alone: other tokens may carry what stood before them.
std::size_t token_start(std::string_view text, std::size_t position, const std::string& token) {
  const std::string_view read = text.substr(0, position);
  if (read.empty()) return 0;
  if (read.back() == '"' && read.ends_with(token)) return read.size() - token.size();
  const auto in_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+';
  };
  std::size_t at = position > text.size() ? text.size() : position - 1;  // beyond the end: the text stops too early
  while (at > 0 && at < text.size() && in_word(text[at]) && in_word(text[at - 1])) --at;
  return at;
}

/// Receives the parts of a text from the library's parser and builds the value. Strict where the library is not:
/// a key that appears twice in one object is an error, because one of the two values would be lost.
class Builder : public nlohmann::json_sax<Library> {
 public:
  Builder(std::string_view text, const std::string& name) : text_(text), name_(name) {}
  Json take() { return std::move(root_); }

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(std::int64_t(value)); }
  bool number_unsigned(number_unsigned_t value) override {
    return add(value <= std::uint64_t(INT64_MAX) ? Json(std::int64_t(value)) : Json(std::uint64_t(value)));
  }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(true); }
  bool start_array(std::size_t) override { return open(false); }
  bool key(string_t& key) override {
    const bool first = open_.back().seen.insert(key).second;
    open_.back().key = key;
    if (!first) refuse("the key \"" + key + "\" appears twice in one object; remove one of them", {.path = path()});
    return true;
  }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception& e) override {
    const InputPlace place = place_of(position, token);
    if (e.id == kOutOfRange) refuse("the number " + token + " is too large to represent", place);
    refuse("not valid JSON (a comma, quote or bracket is missing or too many near there)", place);
  }

 private:
  static constexpr int kOutOfRange = 406;  // the library's identifier of a number that overflows

  struct Open {
    bool is_object = false;
    Json::Object members{};
    Json::Array items{};
    std::string key{};
    std::set<std::string> seen{};
  };

  [[noreturn]] void refuse(const std::string& message, InputPlace place) const {
    place.file = name_;
    std::string where;
    if (place.line > 0)
      where = "line " + std::to_string(place.line) + ", column " + std::to_string(place.column) + ": ";
    throw PlacedInputError(name_ + ": " + where + message, std::move(place));
  }

  InputPlace place_of(std::size_t position, const std::string& token) const {
    const std::string_view before = text_.substr(0, token_start(text_, position, token));
    const std::string_view in_line = before.substr(before.rfind('\n') + 1);  // npos + 1 is 0
    const auto starts_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    return {.line = 1 + std::size_t(std::count(before.begin(), before.end(), '\n')),
            .column = 1 + std::size_t(std::count_if(in_line.begin(), in_line.end(), starts_character))};
  }

  /// Of the value that is being read, "bed.size_m[2]".
  std::string path() const {
    std::string path;
    for (const Open& level : open_) {
      if (level.is_object)
        path += (path.empty() ? "" : ".") + level.key;
      else
        path += "[" + std::to_string(level.items.size()) + "]";
    }
    return path;
  }

  bool open(bool is_object) {
    if (open_.size() == kMaxDepth)
      refuse("lists and objects are nested deeper than " + std::to_string(kMaxDepth) + " levels", {});
    open_.push_back({.is_object = is_object});
    return true;
  }
  bool close() {
    Open done = std::move(open_.back());
    open_.pop_back();
    return done.is_object ? add(std::move(done.members)) : add(std::move(done.items));
  }
  bool add(Json value) {
    if (open_.empty())
      root_ = std::move(value);
    else if (open_.back().is_object)
      open_.back().members.emplace_back(std::move(open_.back().key), std::move(value));
    else
      open_.back().items.push_back(std::move(value));
    return true;
  }

  std::string_view text_;
  const std::string& name_;
  Json root_;
  std::vector<Open> open_;
};

Library to_library(const Json& json) {
  if (json.is_bool()) return json.boolean();
  if (json.is_string()) return json.string();
  if (json.is_array()) {
    Library out = Library::array();
    for (const Json& item : json.items()) out.push_back(to_library(item));
    return out;
  }
  if (json.is_object()) {
    Library out = Library::object();
    for (const auto& [key, value] : json.members()) out[key] = to_library(value);
    return out;
  }
  if (json.is_integer()) {
    if (json.number() >= double(INT64_MAX)) return json.unsigned_integer();
    return json.integer();
  }
  if (json.is_number()) return json.number();
  return nullptr;
}

[[noreturn]] void wrong_type(const Json& json, const char* wanted) {
  throw InputError(std::string("expected a ") + wanted + ", found " + json.type_name() + " " + json.dump());
}

}  // namespace

bool Json::boolean() const {
  if (!is_bool()) wrong_type(*this, "true or false");
  return std::get<bool>(value_);
}
std::int64_t Json::integer() const {
  if (const auto* u = std::get_if<std::uint64_t>(&value_); u && *u <= std::uint64_t(INT64_MAX)) return std::int64_t(*u);
  if (!std::holds_alternative<std::int64_t>(value_)) wrong_type(*this, "whole number");
  return std::get<std::int64_t>(value_);
}
std::uint64_t Json::unsigned_integer() const {
  if (const auto* u = std::get_if<std::uint64_t>(&value_)) return *u;
  if (!is_integer() || integer() < 0) wrong_type(*this, "whole number >= 0");
  return std::uint64_t(integer());
}
double Json::number() const {
  if (const auto* i = std::get_if<std::int64_t>(&value_)) return double(*i);
  if (const auto* u = std::get_if<std::uint64_t>(&value_)) return double(*u);
  if (!std::holds_alternative<double>(value_)) wrong_type(*this, "number");
  return std::get<double>(value_);
}
const std::string& Json::string() const {
  if (!is_string()) wrong_type(*this, "text");
  return std::get<std::string>(value_);
}
const Json::Array& Json::items() const {
  if (!is_array()) wrong_type(*this, "list");
  return std::get<Array>(value_);
}
const Json::Object& Json::members() const {
  if (!is_object()) wrong_type(*this, "object");
  return std::get<Object>(value_);
}

const Json* Json::find(std::string_view key) const {
  for (const auto& [name, value] : members())
    if (name == key) return &value;
  return nullptr;
}
const Json& Json::at(std::string_view key) const {
  if (const Json* member = find(key)) return *member;
  throw InputError("\"" + std::string(key) + "\" is missing");
}
Json& Json::operator[](std::string_view key) {
  if (is_null()) value_ = Object{};
  if (!is_object()) wrong_type(*this, "object");
  auto& object = std::get<Object>(value_);
  for (auto& [name, value] : object)
    if (name == key) return value;
  return object.emplace_back(std::string(key), Json()).second;
}
void Json::push_back(Json item) {
  if (is_null()) value_ = Array{};
  if (!is_array()) wrong_type(*this, "list");
  std::get<Array>(value_).push_back(std::move(item));
}

std::string Json::type_name() const {
  if (is_null()) return "null";
  if (is_bool()) return "true/false";
  if (is_number()) return "number";
  if (is_string()) return "text";
  return is_array() ? "list" : "object";
}

std::string Json::dump(int indent) const {
  return to_library(*this).dump(indent, ' ', false, Library::error_handler_t::replace);
}

Json Json::parse(std::string_view text, const std::string& name) {
  Builder builder(text, name);
  Library::sax_parse(text, &builder);
  return builder.take();
}

Json Json::read(const std::filesystem::path& path) { return parse(read_file(path), path.string()); }

}  // namespace gonogo
