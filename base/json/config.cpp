#include "base/json/config.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"

namespace gonogo {
namespace {

std::string show(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

std::string show(Range range) {
  const bool low = std::isfinite(range.minimum), high = std::isfinite(range.maximum);
  if (low && high) return "between " + show(range.minimum) + " and " + show(range.maximum);
  if (low) return "at least " + show(range.minimum);
  if (high) return "at most " + show(range.maximum);
  return "any number";
}

}  // namespace

struct Config::Document {
  std::filesystem::path file;
  Json root;
};

Config::Config(std::shared_ptr<const Document> document, const Json* value, std::string where)
    : document_(std::move(document)),
      value_(value),
      where_(std::move(where)),
      asked_(std::make_shared<std::vector<std::string>>()) {
  if (!value_->is_object()) fail("", "expected an object { }, found " + value_->type_name() + " " + value_->dump());
}

Config Config::read(const std::filesystem::path& path) { return parse(read_file(path), path.string()); }

Config Config::parse(std::string_view text, const std::string& name) {
  auto document = std::make_shared<Document>();
  document->file = name;
  document->root = Json::parse(text, name);
  const Json* root = &document->root;
  return Config(std::move(document), root, "");
}

const std::filesystem::path& Config::file() const { return document_->file; }

void Config::fail(const std::string& key, const std::string& message) const {
  std::string where = where_;
  if (!key.empty()) where += (where.empty() || key[0] == '[' ? "" : ".") + key;
  const std::string file = document_->file.string();
  throw PlacedInputError(file + ": " + (where.empty() ? "" : where + ": ") + message, {.file = file, .path = where});
}

const Json* Config::find(const std::string& key) const {
  asked_->push_back(key);
  return value_->find(key);
}

const Json& Config::get(const std::string& key) const {
  if (const Json* value = find(key)) return *value;
  fail(key, "missing; add it");
}

bool Config::has(const std::string& key) const { return find(key) != nullptr; }

Config Config::child(const Json& value, const std::string& where) const {
  const bool indexed = !where.empty() && where[0] == '[';
  return Config(document_, &value, where_ + (where_.empty() || indexed ? "" : ".") + where);
}

double Config::checked_number(const Json& value, const std::string& key, Range range) const {
  if (!value.is_number())
    fail(key, "expected a number " + show(range) + ", found " + value.type_name() + " " + value.dump());
  if (!range.contains(value.number()))
    fail(key, "value " + value.dump() + " is outside the allowed range: " + show(range));
  return value.number();
}

double Config::number(const std::string& key, Range range) const { return checked_number(get(key), key, range); }

double Config::number_or(const std::string& key, double fallback, Range range) const {
  const Json* value = find(key);
  return value ? checked_number(*value, key, range) : fallback;
}

std::int64_t Config::integer(const std::string& key, Range range) const {
  const Json& value = get(key);
  checked_number(value, key, range);
  if (!value.is_integer()) fail(key, "expected a whole number " + show(range) + ", found " + value.dump());
  return value.integer();
}

std::int64_t Config::integer_or(const std::string& key, std::int64_t fallback, Range range) const {
  return has(key) ? integer(key, range) : fallback;
}

bool Config::boolean_or(const std::string& key, bool fallback) const {
  const Json* value = find(key);
  if (!value) return fallback;
  if (!value->is_bool()) fail(key, "expected true or false, found " + value->type_name() + " " + value->dump());
  return value->boolean();
}

std::string Config::text(const std::string& key) const {
  const Json& value = get(key);
  if (!value.is_string()) fail(key, "expected text in quotes, found " + value.type_name() + " " + value.dump());
  return value.string();
}

std::string Config::text_or(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::string Config::choice(const std::string& key, const std::vector<std::string>& allowed) const {
  std::string value = text(key);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end())
    fail(key, "\"" + value + "\" is not one of: " + join_words(allowed));
  return value;
}

std::vector<double> Config::numbers(const std::string& key, Range range) const {
  const Json& value = get(key);
  if (!value.is_array()) fail(key, "expected a list of numbers, found " + value.type_name() + " " + value.dump());
  std::vector<double> result;
  for (const Json& item : value.items())
    result.push_back(checked_number(item, key + "[" + std::to_string(result.size()) + "]", range));
  return result;
}

std::vector<std::string> Config::texts(const std::string& key) const {
  const Json& value = get(key);
  if (!value.is_array()) fail(key, "expected a list of texts, found " + value.type_name() + " " + value.dump());
  std::vector<std::string> result;
  for (const Json& item : value.items()) {
    if (!item.is_string())
      fail(key + "[" + std::to_string(result.size()) + "]", "expected text in quotes, found " + item.dump());
    result.push_back(item.string());
  }
  return result;
}

std::filesystem::path Config::path(const std::string& key) const {
  const std::filesystem::path given = text(key);
  return given.is_absolute() ? given : document_->file.parent_path() / given;
}

Config Config::object(const std::string& key) const { return child(get(key), key); }

std::optional<Config> Config::object_if(const std::string& key) const {
  const Json* value = find(key);
  return value ? std::optional<Config>(child(*value, key)) : std::nullopt;
}

std::vector<Config> Config::objects(const std::string& key) const {
  const Json& value = get(key);
  if (!value.is_array()) fail(key, "expected a list, found " + value.type_name() + " " + value.dump());
  std::vector<Config> result;
  for (const Json& item : value.items()) result.push_back(child(item, key + "[" + std::to_string(result.size()) + "]"));
  return result;
}

std::vector<std::pair<std::string, Config>> Config::members() const {
  std::vector<std::pair<std::string, Config>> result;
  for (const auto& [key, value] : value_->members()) {
    asked_->push_back(key);
    result.emplace_back(key, child(value, key));
  }
  return result;
}

void Config::finish() const {
  for (const auto& [key, value] : value_->members()) {
    if (std::find(asked_->begin(), asked_->end(), key) != asked_->end()) continue;
    std::vector<std::string> known(*asked_);
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    if (known.empty()) fail(key, "unknown key; this object takes none");
    fail(key, "unknown key; did you mean \"" + nearest_word(key, known) + "\"? Known keys: " + join_words(known));
  }
}

}  // namespace gonogo
