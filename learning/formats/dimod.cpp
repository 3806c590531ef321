#include "learning/formats/dimod.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "base/error.h"
#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

/// dimod writes whole floating-point numbers of arrays as integers.
Json number_json(double x) {
  constexpr double exact = 0x1p63;
  if (x == std::floor(x) && std::abs(x) < exact) return Json(std::int64_t(x));
  return Json(x);
}

Json array_json(Json data, const char* data_type, const std::vector<std::size_t>& shape) {
  Json json = Json::Object{{"type", "array"}, {"data", std::move(data)}, {"data_type", data_type}};
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
  sort_couplings(couplings);
  return couplings;
}

/// Contents of an array member: checks its kind and shape, returns the reader for its "data".
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

Json dimod_json(const Problem& problem) {
  check_problem(problem, "problem");
  Json json, quadratic = Json::array(), head = Json::array(), tail = Json::array();
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
  json["linear_biases"] = problem.linear;
  json["quadratic_biases"] = std::move(quadratic);
  json["quadratic_head"] = std::move(head);
  json["quadratic_tail"] = std::move(tail);
  return json;
}

std::string to_dimod_json(const Problem& problem) { return python_json(dimod_json(problem), JsonSpaces::compact); }

Problem problem_from_dimod_json(const std::string& text, const std::string& source) {
  return dimod_problem(Json::parse(text, source), source);
}

Problem dimod_problem(const Json& json, const std::string& source) {
  const JsonReader reader(json, source, "");
  reader.expect_text("type", "BinaryQuadraticModel");
  check_version(reader, "bqm_schema", "2.0.0", "4");
  reader.expect_no_bytes();
  Problem problem{.vartype = vartype_from_json(reader, "variable_type"), .linear = reader.numbers("linear_biases")};
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
  Json json, energies = Json::array();
  for (double e : samples.energies) energies.push_back(number_json(e));
  json["type"] = "SampleSet";
  json["version"]["sampleset_schema"] = "3.2.0";
  json["num_variables"] = Json(std::int64_t(n));
  json["num_rows"] = Json(std::int64_t(rows));
  json["sample_data"] = array_json(rows_json(samples, packed), packed ? "uint32" : "int8", {rows, packed ? words : n});
  json["sample_type"] = "int8";
  json["sample_packed"] = packed;
  json["vectors"]["energy"] = array_json(std::move(energies), "float64", {rows});
  json["vectors"]["num_occurrences"] = array_json(samples.occurrences, "int64", {rows});
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

namespace {

// dimod's binary file of a problem (BinaryQuadraticModel.to_file / from_file), which Leap's hybrid solvers accept.
// Layout: docs of dimod, "Format Specification" 1.0 and 2.0 of BinaryQuadraticModel.to_file.
//
//   "DIMODBQM", u8 major, u8 minor, u32 header length, header (JSON, newline, spaces up to a multiple of 64 bytes)
//   offset; for each variable: start of its neighbourhood, linear bias; for each variable: (neighbour, bias) ascending
//   2.0 only, when labels are not 0, 1, 2, ...: "VARS", u32 length, JSON list, spaces up to a multiple of 64 bytes
constexpr std::string_view kMagic = "DIMODBQM", kLabelMagic = "VARS";
constexpr std::size_t kAlignment = 64;

void pad(std::string& bytes, std::size_t from = 0) {
  while ((bytes.size() - from) % kAlignment != 0) bytes += ' ';
}

void set_length(std::string& bytes, std::size_t at) {
  const auto length = std::uint32_t(bytes.size() - at - sizeof(std::uint32_t));
  std::memcpy(bytes.data() + at, &length, sizeof length);
}

bool numbered_in_order(const Problem& problem) {
  for (std::size_t i = 0; i < problem.labels.size(); ++i)
    if (problem.labels[i] != Label(std::int64_t(i))) return false;
  return true;
}

/// Neighbours of every variable with their biases, ascending.
std::vector<std::vector<std::pair<std::int32_t, double>>> neighbourhoods(const Problem& problem) {
  std::vector<std::vector<std::pair<std::int32_t, double>>> result(problem.variable_count());
  for (const Coupling& c : problem.couplings) {  // sorted by (a, b): first all smaller neighbours, then the larger ones
    result[c.a].emplace_back(std::int32_t(c.b), c.value);
    result[c.b].emplace_back(std::int32_t(c.a), c.value);
  }
  for (auto& list : result) std::sort(list.begin(), list.end());
  return result;
}

std::string header(const Problem& problem, int version) {
  Json json;
  json["dtype"] = "float64";
  json["itype"] = "int32";
  json["ntype"] = "int32";
  json["shape"] = Json(Json::Array{std::uint64_t(problem.variable_count()), std::uint64_t(problem.couplings.size())});
  json["type"] = "BinaryQuadraticModel";
  json["variables"] = version == 1 ? labels_json(problem.labels) : Json(!numbered_in_order(problem));
  json["vartype"] = vartype_name(problem.vartype);
  std::string bytes(kMagic);
  bytes += char(version);
  bytes += '\0';
  const std::size_t length_at = bytes.size();
  append_bytes(bytes, std::uint32_t(0));
  bytes += python_json(json, JsonSpaces::after) + "\n";
  pad(bytes);
  set_length(bytes, length_at);
  return bytes;
}

/// What the header says about the bytes that follow.
struct BqmShape {
  std::size_t variables = 0, interactions = 0;
  std::size_t bias_size = 8, index_size = 4, start_size = 4;
  std::size_t body_size() const {
    return bias_size + variables * (start_size + bias_size) + 2 * interactions * (index_size + bias_size);
  }
};

std::size_t type_size(const JsonReader& header, const std::string& key,
                      const std::map<std::string, std::size_t>& known) {
  const auto found = known.find(header.text(key));
  if (found == known.end()) header.fail(key, "\"" + header.text(key) + "\" is not a type this program reads");
  return found->second;
}

BqmShape read_shape(const JsonReader& header, std::size_t bytes_left) {
  const std::map<std::string, std::size_t> indices = {{"int32", 4}, {"uint32", 4}, {"int64", 8}, {"uint64", 8}};
  const auto sizes = header.integers("shape", 0, INT32_MAX);
  header.expect_size("shape", sizes.size(), 2);
  BqmShape shape{.variables = std::size_t(sizes[0]),
                 .interactions = std::size_t(sizes[1]),
                 .bias_size = type_size(header, "dtype", {{"float32", 4}, {"float64", 8}}),
                 .index_size = type_size(header, "itype", indices),
                 .start_size = type_size(header, "ntype", indices)};
  if (shape.body_size() > bytes_left)
    header.fail("shape", std::to_string(shape.variables) + " variables and " + std::to_string(shape.interactions) +
                             " interactions need " + std::to_string(shape.body_size()) + " bytes, " +
                             std::to_string(bytes_left) + " follow the header");
  return shape;
}

double read_bias(ByteReader& body, std::size_t size) {
  return size == 4 ? double(body.number<float>("the biases")) : body.number<double>("the biases");
}

std::uint64_t read_index(ByteReader& body, std::size_t size) {
  return size == 4 ? body.number<std::uint32_t>("the indices") : body.number<std::uint64_t>("the indices");
}

/// Every interaction stands in the neighbourhoods of both its variables, which must agree.
std::vector<Coupling> read_couplings(ByteReader& body, const BqmShape& shape, const std::vector<std::uint64_t>& start) {
  std::vector<Coupling> upper, lower;
  for (std::size_t i = 0; i < shape.variables; ++i) {
    std::uint64_t next = 0;
    for (std::uint64_t k = start[i]; k < start[i + 1]; ++k) {
      const std::uint64_t j = read_index(body, shape.index_size);
      const double value = read_bias(body, shape.bias_size);
      if (j >= shape.variables || j == i || j < next)
        body.fail("neighbour " + std::to_string(j) + " of variable " + std::to_string(i) +
                  ": neighbours must be other variables below " + std::to_string(shape.variables) + ", ascending");
      next = j + 1;
      (j > i ? upper : lower)
          .push_back(
              {std::uint32_t(std::min<std::uint64_t>(i, j)), std::uint32_t(std::max<std::uint64_t>(i, j)), value});
    }
  }
  sort_couplings(lower);
  const auto same = [](const Coupling& x, const Coupling& y) {
    return x.a == y.a && x.b == y.b && std::bit_cast<std::uint64_t>(x.value) == std::bit_cast<std::uint64_t>(y.value);
  };
  if (!std::equal(upper.begin(), upper.end(), lower.begin(), lower.end(), same))
    body.fail("the two neighbourhoods that hold an interaction do not agree on it");
  return upper;
}

void read_body(ByteReader& body, const BqmShape& shape, Problem& problem) {
  problem.offset = read_bias(body, shape.bias_size);
  std::vector<std::uint64_t> start;
  for (std::size_t i = 0; i < shape.variables; ++i) {
    start.push_back(read_index(body, shape.start_size));
    if (start[i] > 2 * shape.interactions || (i == 0 ? start[i] != 0 : start[i] < start[i - 1]))
      body.fail("neighbourhood of variable " + std::to_string(i) + " starts at " + std::to_string(start[i]) +
                "; starts must go up from 0 to at most twice the interactions");
    problem.linear.push_back(read_bias(body, shape.bias_size));
  }
  if (shape.variables == 0 && shape.interactions > 0) body.fail("interactions without variables");
  start.push_back(2 * shape.interactions);
  problem.couplings = read_couplings(body, shape, start);
}

std::vector<Label> read_label_section(ByteReader& body, std::size_t count, const std::string& source) {
  if (body.take(kLabelMagic.size(), "the labels") != kLabelMagic)
    body.fail("expected the section VARS with the labels");
  const std::size_t length = body.number<std::uint32_t>("the labels");
  Json wrapped;
  wrapped["VARS"] = Json::parse(body.take(length, "the labels"), source + ": VARS");
  return labels_from_json(JsonReader(wrapped, source, ""), "VARS", count);
}

/// version: 1 (labels inside the header) or 2. The bytes are those of dimod 0.12 with float64 biases and int32 indices.
template <int version>
std::string to_bqm_file(const Problem& problem, const FormatOptions&) {
  check_problem(problem, "problem");
  std::string bytes = header(problem, version);
  append_bytes(bytes, problem.offset);
  const auto neighbours = neighbourhoods(problem);
  std::int32_t start = 0;
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    append_bytes(bytes, start);
    append_bytes(bytes, problem.linear[i]);
    start += std::int32_t(neighbours[i].size());
  }
  for (const auto& list : neighbours)
    for (const auto& [neighbour, bias] : list) {
      append_bytes(bytes, neighbour);
      append_bytes(bytes, bias);
    }
  if (version == 1 || numbered_in_order(problem)) return bytes;
  const std::size_t section = bytes.size();
  bytes += kLabelMagic;
  append_bytes(bytes, std::uint32_t(0));
  bytes += python_json(labels_json(problem.labels), JsonSpaces::after);
  pad(bytes, section);
  set_length(bytes, section + kLabelMagic.size());
  return bytes;
}

/// Reads 1.0 and 2.0 with float32 or float64 biases and indices of 4 or 8 bytes. Checks sizes before it allocates.
/// Rejects sizes that do not match the file, neighbourhoods that are unsorted or not symmetric, biases that are not
/// finite, and trailing bytes.
Problem problem_from_bqm_file(const std::string& text, const FormatOptions&, const std::string& source) {
  const std::string_view bytes = text;
  ByteReader body(bytes, source);
  if (bytes.substr(0, kMagic.size()) != kMagic)
    throw InputError(source + ": does not begin with DIMODBQM; give a file that dimod's to_file wrote");
  body.take(kMagic.size(), "the magic bytes");
  const int major = body.number<std::uint8_t>("the version"), minor = body.number<std::uint8_t>("the version");
  if (major < 1 || major > 2)
    body.fail("version " + std::to_string(major) + "." + std::to_string(minor) + " is not readable; 1.0 and 2.0 are");
  const std::size_t length = body.number<std::uint32_t>("the header");
  const Json json = Json::parse(body.take(length, "the header"), source + ": header");
  const JsonReader header(json, source, "header");
  header.expect_text("type", "BinaryQuadraticModel");
  Problem problem;
  problem.vartype = vartype_from_json(header, "vartype");
  const BqmShape shape = read_shape(header, body.remaining());
  read_body(body, shape, problem);
  const Json& labels = header.at("variables");
  if (major == 1) {
    problem.labels = labels_from_json(header, "variables", shape.variables);
  } else if (!labels.is_bool()) {
    header.fail("variables", "expected true or false, found " + labels.type_name());
  } else if (labels.boolean()) {
    problem.labels = read_label_section(body, shape.variables, source);
  } else {
    for (std::size_t i = 0; i < shape.variables; ++i) problem.labels.emplace_back(std::int64_t(i));
  }
  if (body.remaining() > 0) body.fail(std::to_string(body.remaining()) + " bytes after the end of the problem");
  check_problem(problem, source);
  return problem;
}

}  // namespace

extern const Format kDimodJson = {
    .name = "dimod_json",
    .extension = ".json",
    .about = "dimod to_serializable, bqm_schema 3.0.0",
    .write = [](const Problem& problem, const FormatOptions&) { return to_dimod_json(problem) + "\n"; },
    .read = [](const std::string& text, const FormatOptions&,
               const std::string& source) { return problem_from_dimod_json(text, source); },
    .read_answer = [](const std::string& text, const Problem&,
                      const std::string& source) { return samples_from_dimod_json(text, source); }};
extern const Format kDimodBqm = {.name = "dimod_bqm",
                                 .extension = ".bqm",
                                 .about = "dimod to_file, version 2; Leap uploads",
                                 .write = to_bqm_file<2>,
                                 .read = problem_from_bqm_file};
extern const Format kDimodBqm1 = {.name = "dimod_bqm_v1",
                                  .extension = ".bqm",
                                  .about = "dimod to_file, version 1",
                                  .write = to_bqm_file<1>,
                                  .read = problem_from_bqm_file};

}  // namespace gonogo::learning
