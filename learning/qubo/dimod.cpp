#include "learning/qubo/dimod.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/json/json.h"

namespace gonogo::learning {
namespace {

Json labels_json(const std::vector<Label>& labels) {
  Json list = Json::array();
  for (const Label& label : labels) std::visit([&](const auto& value) { list.push_back(Json(value)); }, label);
  return list;
}

/// dimod writes whole floating-point numbers of arrays as integers.
Json number_json(double x) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (x == std::floor(x) && std::abs(x) < exact) return Json(std::int64_t(x));
  return Json(x);
}

Json array_json(Json data, const char* data_type, std::vector<std::size_t> shape) {
  Json json;
  json["type"] = "array";
  json["data"] = std::move(data);
  json["data_type"] = data_type;
  Json extents = Json::array();
  for (std::size_t extent : shape) extents.push_back(Json(std::int64_t(extent)));
  json["shape"] = std::move(extents);
  json["use_bytes"] = false;
  return json;
}

/// Reads members of one JSON object with messages that name the file and the place.
class Reader {
 public:
  Reader(const Json& json, std::string source, std::string where)
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
  Reader object(const std::string& key) const {
    return Reader(at(key), source_, where_ + (where_.empty() ? "" : ".") + key);
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
  /// Lists of numbers only: bytes depend on the writer's numpy and are not read.
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

std::vector<Label> read_labels(const Reader& reader, std::size_t count) {
  std::vector<Label> labels;
  for (const Json& item : reader.list("variable_labels")) {
    if (item.is_string())
      labels.emplace_back(item.string());
    else if (item.is_integer())
      labels.emplace_back(item.integer());
    else
      reader.fail("variable_labels", "expected texts or whole numbers, found " + item.dump());
  }
  reader.expect_size("variable_labels", labels.size(), count);
  return labels;
}

Vartype read_vartype(const Reader& reader) {
  const std::string name = reader.text("variable_type");
  if (name == "BINARY") return Vartype::binary;
  if (name == "SPIN") return Vartype::spin;
  reader.fail("variable_type", "expected \"BINARY\" or \"SPIN\", found \"" + name + "\"");
}

void check_version(const Reader& reader, const std::string& key, const std::string& at_least,
                   const std::string& below) {
  const std::string version = reader.object("version").text(key);
  if (version < at_least || version >= below)
    reader.fail("version." + key,
                "version " + version + " is not readable; " + at_least + " up to, not including, " + below + " are");
}

std::vector<Coupling> read_couplings(const Reader& reader, std::size_t variable_count) {
  const std::vector<double> bias = reader.numbers("quadratic_biases");
  const std::int64_t last = std::int64_t(variable_count) - 1;
  const auto head = reader.integers("quadratic_head", 0, last), tail = reader.integers("quadratic_tail", 0, last);
  reader.expect_size("quadratic_head", head.size(), bias.size());
  reader.expect_size("quadratic_tail", tail.size(), bias.size());
  std::vector<Coupling> couplings;
  for (std::size_t k = 0; k < bias.size(); ++k)
    couplings.push_back(
        {std::uint32_t(std::min(head[k], tail[k])), std::uint32_t(std::max(head[k], tail[k])), bias[k]});
  std::sort(couplings.begin(), couplings.end(),
            [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return couplings;
}

/// Contents of an array member: checks its kind and shape, hands back the reader for its "data".
Reader read_array(const Reader& reader, const std::string& key, const std::vector<std::size_t>& shape) {
  const Reader array = reader.object(key);
  array.expect_text("type", "array");
  array.expect_no_bytes();
  const auto extents = array.integers("shape", 0, INT32_MAX);
  if (!std::equal(extents.begin(), extents.end(), shape.begin(), shape.end(),
                  [](std::int64_t a, std::size_t b) { return std::size_t(a) == b; }))
    array.fail("shape", "does not fit num_rows and num_variables");
  array.expect_size("data", array.list("data").size(), shape[0]);
  return array;
}

std::vector<std::int8_t> read_rows(const Reader& reader, std::size_t rows, std::size_t variables, Vartype vartype) {
  const Json& packed_json = reader.at("sample_packed");
  if (!packed_json.is_bool()) reader.fail("sample_packed", "expected true or false");
  const bool packed = packed_json.boolean();
  const std::size_t width = packed ? (variables + 31) / 32 : variables;
  const Reader array = read_array(reader, "sample_data", {rows, width});
  const std::int8_t off = vartype == Vartype::binary ? 0 : -1;
  std::vector<std::int8_t> values;
  values.reserve(rows * variables);
  for (const Json& line : array.list("data")) {
    if (!line.is_array()) array.fail("data", "expected a list for each row");
    array.expect_size("data", line.items().size(), width);
    for (std::size_t k = 0; packed && k < variables; ++k) {
      const std::int64_t word = array.as_integer(line.items()[k / 32], "data", 0, UINT32_MAX);
      values.push_back((word >> (k % 32)) & 1 ? 1 : off);
    }
    for (std::size_t k = 0; !packed && k < variables; ++k) {
      const std::int64_t value = array.as_integer(line.items()[k], "data", off, 1);
      if (value != off && value != 1) array.fail("data", "value " + std::to_string(value) + " is not -1 or 1");
      values.push_back(std::int8_t(value));
    }
  }
  return values;
}

Json rows_json(const SampleSet& samples, bool packed) {
  const std::size_t n = samples.variable_count();
  Json data = Json::array();
  for (std::size_t r = 0; r < samples.row_count(); ++r) {
    Json line = Json::array();
    const auto row = samples.row(r);
    for (std::size_t word = 0; packed && word < n; word += 32) {
      std::uint32_t bits = 0;
      for (std::size_t k = word; k < std::min(n, word + 32); ++k) bits |= std::uint32_t(row[k] > 0) << (k - word);
      line.push_back(Json(bits));
    }
    for (std::size_t k = 0; !packed && k < n; ++k) line.push_back(Json(int(row[k])));
    data.push_back(std::move(line));
  }
  return data;
}

}  // namespace

std::string to_dimod_json(const Problem& problem) {
  check_problem(problem, "problem");
  Json json, linear = Json::array(), quadratic = Json::array(), head = Json::array(), tail = Json::array();
  for (double bias : problem.linear) linear.push_back(Json(bias));
  for (const Coupling& c : problem.couplings) {
    quadratic.push_back(Json(c.value));
    head.push_back(Json(c.a));
    tail.push_back(Json(c.b));
  }
  json["type"] = "BinaryQuadraticModel";
  json["version"]["bqm_schema"] = "3.0.0";
  json["use_bytes"] = false;
  json["index_type"] = "int32";
  json["bias_type"] = "float64";
  json["num_variables"] = Json(std::int64_t(problem.variable_count()));
  json["num_interactions"] = Json(std::int64_t(problem.couplings.size()));
  json["variable_labels"] = labels_json(problem.labels);
  json["variable_type"] = vartype_name(problem.vartype);
  json["offset"] = problem.offset;
  json["info"] = Json::object();
  json["linear_biases"] = std::move(linear);
  json["quadratic_biases"] = std::move(quadratic);
  json["quadratic_head"] = std::move(head);
  json["quadratic_tail"] = std::move(tail);
  return json.dump();
}

Problem problem_from_dimod_json(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const Reader reader(json, source, "");
  reader.expect_text("type", "BinaryQuadraticModel");
  check_version(reader, "bqm_schema", "2.0.0", "4");
  reader.expect_no_bytes();
  Problem problem;
  problem.vartype = read_vartype(reader);
  problem.linear = reader.numbers("linear_biases");
  if (reader.find("num_variables"))
    reader.expect_size("linear_biases", problem.linear.size(), reader.count("num_variables"));
  problem.labels = read_labels(reader, problem.linear.size());
  problem.couplings = read_couplings(reader, problem.linear.size());
  if (reader.find("num_interactions"))
    reader.expect_size("quadratic_biases", problem.couplings.size(), reader.count("num_interactions"));
  problem.offset = reader.number("offset");
  check_problem(problem, source);
  return problem;
}

std::string to_dimod_json(const SampleSet& samples, bool packed) {
  const std::size_t rows = samples.row_count(), n = samples.variable_count(), words = (n + 31) / 32;
  Json json, energies = Json::array(), occurrences = Json::array();
  for (double e : samples.energies) energies.push_back(number_json(e));
  for (std::int64_t count : samples.occurrences) occurrences.push_back(Json(count));
  json["type"] = "SampleSet";
  json["version"]["sampleset_schema"] = "3.2.0";
  json["num_variables"] = Json(std::int64_t(n));
  json["num_rows"] = Json(std::int64_t(rows));
  json["sample_data"] = array_json(rows_json(samples, packed), packed ? "uint32" : "int8", {rows, packed ? words : n});
  json["sample_type"] = "int8";
  json["sample_packed"] = packed;
  json["vectors"]["energy"] = array_json(std::move(energies), "float64", {rows});
  json["vectors"]["num_occurrences"] = array_json(std::move(occurrences), "int64", {rows});
  json["variable_labels"] = labels_json(samples.labels);
  json["variable_type"] = vartype_name(samples.vartype);
  json["info"] = samples.info;
  return json.dump();
}

SampleSet samples_from_dimod_json(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const Reader reader(json, source, "");
  reader.expect_text("type", "SampleSet");
  check_version(reader, "sampleset_schema", "3.1.0", "4");
  SampleSet samples;
  samples.vartype = read_vartype(reader);
  const std::size_t rows = reader.count("num_rows"), variables = reader.count("num_variables");
  samples.labels = read_labels(reader, variables);
  samples.values = read_rows(reader, rows, variables, samples.vartype);
  const Reader vectors = reader.object("vectors");
  samples.energies = read_array(vectors, "energy", {rows}).numbers("data");
  samples.occurrences = read_array(vectors, "num_occurrences", {rows}).integers("data", 1, INT64_MAX / 2);
  samples.info = reader.at("info");
  return samples;
}

}  // namespace gonogo::learning
