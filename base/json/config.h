// Strict reader for configuration files: every message names file, JSON path, value, allowed range and what to do.
//
//   Config study = Config::read("configs/studies/demo.json");
//   const double step = study.number("step_s", {.minimum = 1e-5, .maximum = 5e-3});
//   const Config bed = study.object("bed");
//   ...
//   study.finish();   // throws for keys nobody asked for, with the nearest valid one
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo {

/// Closed interval of allowed values. NaN is never allowed.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool contains(double x) const { return x >= minimum && x <= maximum; }
};

class Config {
 public:
  static Config read(const std::filesystem::path& path);
  static Config parse(std::string_view text, const std::string& name);

  bool has(const std::string& key) const;

  double number(const std::string& key, Range range = {}) const;
  double number_or(const std::string& key, double fallback, Range range = {}) const;
  std::int64_t integer(const std::string& key, Range range = {}) const;
  std::int64_t integer_or(const std::string& key, std::int64_t fallback, Range range = {}) const;
  bool boolean_or(const std::string& key, bool fallback) const;
  std::string text(const std::string& key) const;
  std::string text_or(const std::string& key, const std::string& fallback) const;
  /// Text that must be one of `allowed`.
  std::string choice(const std::string& key, const std::vector<std::string>& allowed) const;
  std::vector<double> numbers(const std::string& key, Range range = {}) const;
  std::vector<std::string> texts(const std::string& key) const;
  /// A path, relative to the folder of this file unless absolute. The file need not exist.
  std::filesystem::path path(const std::string& key) const;

  Config object(const std::string& key) const;
  std::optional<Config> object_if(const std::string& key) const;
  std::vector<Config> objects(const std::string& key) const;
  /// Members of this object in file order; each must be an object. Marks all keys as known.
  std::vector<std::pair<std::string, Config>> members() const;

  /// Throws InputError for the first key of this object, nested ones apart, that nobody asked for.
  void finish() const;
  /// Throws PlacedInputError "file: path: message" about a key of this object; "" means the object itself.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

  const Json& json() const { return *value_; }
  const std::filesystem::path& file() const;

 private:
  struct Document;
  Config(std::shared_ptr<const Document> document, const Json* value, std::string where);
  const Json& get(const std::string& key) const;
  const Json* find(const std::string& key) const;
  Config child(const Json& value, const std::string& where) const;
  double checked_number(const Json& value, const std::string& key, Range range) const;

  std::shared_ptr<const Document> document_;
  const Json* value_;
  std::string where_;                                // JSON path, "bed.size_m[2]"
  std::shared_ptr<std::vector<std::string>> asked_;  // keys asked for: known to the reader
};

}  // namespace gonogo
