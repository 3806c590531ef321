#include "learning/qubo/bqm_file.h"

#include <algorithm>
#include <bit>
#include <map>

#include "base/error.h"
#include "learning/qubo/bytes.h"
#include "learning/qubo/label_json.h"
#include "learning/qubo/python_json.h"

namespace gonogo::learning {
namespace {

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
struct Shape {
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

Shape read_shape(const JsonReader& header, std::size_t bytes_left) {
  const std::map<std::string, std::size_t> indices = {{"int32", 4}, {"uint32", 4}, {"int64", 8}, {"uint64", 8}};
  const auto sizes = header.integers("shape", 0, INT32_MAX);
  header.expect_size("shape", sizes.size(), 2);
  Shape shape{.variables = std::size_t(sizes[0]),
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
std::vector<Coupling> read_couplings(ByteReader& body, const Shape& shape, const std::vector<std::uint64_t>& start) {
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
  std::sort(lower.begin(), lower.end(),
            [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  const auto same = [](const Coupling& x, const Coupling& y) {
    return x.a == y.a && x.b == y.b && std::bit_cast<std::uint64_t>(x.value) == std::bit_cast<std::uint64_t>(y.value);
  };
  if (!std::equal(upper.begin(), upper.end(), lower.begin(), lower.end(), same))
    body.fail("the two neighbourhoods that hold an interaction do not agree on it");
  return upper;
}

void read_body(ByteReader& body, const Shape& shape, Problem& problem) {
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

}  // namespace

std::string to_bqm_file(const Problem& problem, int version) {
  GONOGO_ASSERT(version == 1 || version == 2);
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

Problem problem_from_bqm_file(std::string_view bytes, const std::string& source) {
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
  const Shape shape = read_shape(header, body.remaining());
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

}  // namespace gonogo::learning
