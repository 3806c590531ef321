#include "base/json/json.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"

namespace gonogo {
namespace {

using Library = nlohmann::ordered_json;

Json from_library(const Library& j) {
  switch (j.type()) {
    case Library::value_t::boolean:
      return j.get<bool>();
    case Library::value_t::number_integer:
      return j.get<std::int64_t>();
    case Library::value_t::number_unsigned: {
      const auto u = j.get<std::uint64_t>();
      return u <= std::uint64_t(INT64_MAX) ? Json(std::int64_t(u)) : Json(u);
    }
    case Library::value_t::number_float:
      return j.get<double>();
    case Library::value_t::string:
      return j.get<std::string>();
    case Library::value_t::array: {
      Json::Array items;
      items.reserve(j.size());
      for (const auto& item : j) items.push_back(from_library(item));
      return items;
    }
    case Library::value_t::object: {
      Json::Object members;
      for (const auto& [key, value] : j.items()) members.emplace_back(key, from_library(value));
      return members;
    }
    default:
      return nullptr;
  }
}

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
    if (json.number() > double(INT64_MAX)) return json.unsigned_integer();
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

std::string Json::dump(int indent) const { return to_library(*this).dump(indent); }

Json Json::parse(std::string_view text, const std::string& name) {
  try {
    return from_library(Library::parse(text));
  } catch (const Library::parse_error& e) {
    std::size_t line = 1;
    for (std::size_t i = 0; i + 1 < e.byte && i < text.size(); ++i) line += text[i] == '\n';
    throw InputError(name + ": line " + std::to_string(line) +
                     ": not valid JSON (a comma, quote or bracket is missing or too many near there)");
  }
}

Json Json::read(const std::filesystem::path& path) { return parse(read_file(path), path.string()); }

}  // namespace gonogo
