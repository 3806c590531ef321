#include "learning/qubo/dimod.h"

#include <algorithm>
#include <cmath>

#include "learning/qubo/json_reader.h"
#include "learning/qubo/label_json.h"
#include "learning/qubo/python_json.h"

namespace gonogo::learning {
namespace {

/// dimod writes whole floating-point numbers of arrays as integers.
Json number_json(double x) {
  constexpr double exact = 0x1p63;
  if (x == std::floor(x) && std::abs(x) < exact) return Json(std::int64_t(x));
  return Json(x);
}

Json array_json(Json data, const char* data_type, const std::vector<std::size_t>& shape) {
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

void check_version(const JsonReader& reader, const std::string& key, const std::string& at_least,
                   const std::string& below) {
  const std::string version = reader.object("version").text(key);
  if (version < at_least || version >= below)
    reader.fail("version." + key,
                "version " + version + " is not readable; " + at_least + " up to, not including, " + below + " are");
}

std::vector<Coupling> read_couplings(const JsonReader& reader, std::size_t variable_count) {
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
JsonReader read_array(const JsonReader& reader, const std::string& key, const std::vector<std::size_t>& shape) {
  JsonReader array = reader.object(key);
  array.expect_text("type", "array");
  array.expect_no_bytes();
  const auto extents = array.integers("shape", 0, INT32_MAX);
  const bool no_rows = extents.size() == shape.size() && shape[0] == 0 && extents[0] == 0;  // dimod then packs no words
  if (!no_rows && !std::equal(extents.begin(), extents.end(), shape.begin(), shape.end(),
                              [](std::int64_t a, std::size_t b) { return std::size_t(a) == b; }))
    array.fail("shape", "does not fit num_rows and num_variables");
  array.expect_size("data", array.list("data").size(), shape[0]);
  return array;
}

std::vector<std::int8_t> read_rows(const JsonReader& reader, std::size_t rows, std::size_t variables, Vartype vartype) {
  const Json& packed_json = reader.at("sample_packed");
  if (!packed_json.is_bool()) reader.fail("sample_packed", "expected true or false");
  const bool packed = packed_json.boolean();
  const std::size_t width = packed ? (variables + 31) / 32 : variables;
  const JsonReader array = read_array(reader, "sample_data", {rows, width});
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
  return python_json(json, JsonSpaces::compact);
}

Problem problem_from_dimod_json(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader reader(json, source, "");
  reader.expect_text("type", "BinaryQuadraticModel");
  check_version(reader, "bqm_schema", "2.0.0", "4");
  reader.expect_no_bytes();
  Problem problem;
  problem.vartype = vartype_from_json(reader, "variable_type");
  problem.linear = reader.numbers("linear_biases");
  if (reader.find("num_variables"))
    reader.expect_size("linear_biases", problem.linear.size(), reader.count("num_variables"));
  problem.labels = labels_from_json(reader, "variable_labels", problem.linear.size());
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
  return python_json(json, JsonSpaces::compact);
}

SampleSet samples_from_dimod_json(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader reader(json, source, "");
  reader.expect_text("type", "SampleSet");
  check_version(reader, "sampleset_schema", "3.1.0", "4");
  SampleSet samples;
  samples.vartype = vartype_from_json(reader, "variable_type");
  const std::size_t rows = reader.count("num_rows"), variables = reader.count("num_variables");
  samples.labels = labels_from_json(reader, "variable_labels", variables);
  samples.values = read_rows(reader, rows, variables, samples.vartype);
  const JsonReader vectors = reader.object("vectors");
  samples.energies = read_array(vectors, "energy", {rows}).numbers("data");
  samples.occurrences = read_array(vectors, "num_occurrences", {rows}).integers("data", 1, INT64_MAX / 2);
  samples.info = reader.at("info");
  return samples;
}

}  // namespace gonogo::learning
