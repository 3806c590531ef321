#include "learning/qubo/sidecar.h"

#include <algorithm>
#include <map>

#include "base/error.h"
#include "learning/qubo/dimod.h"
#include "learning/qubo/label_json.h"

namespace gonogo::learning {
namespace {

constexpr const char* kFormat = "gonogo/sidecar/2";

Json embedding_json(const EmbeddingRecord& embedding) {
  Json json, chains = Json::array(), uncoupled = Json::array();
  for (const auto& chain : embedding.chains) chains.push_back(Json(chain));
  for (const auto& [a, b] : embedding.uncoupled) uncoupled.push_back(Json(Json::Array{Json(a), Json(b)}));
  json["graph"] = embedding.graph;
  json["chains"] = std::move(chains);
  json["chain_strength"] = embedding.chain_strength;
  json["uncoupled"] = std::move(uncoupled);
  json["source"] = Json::parse(to_dimod_json(embedding.source), "source");
  return json;
}

EmbeddingRecord embedding_from_json(const Config& config) {
  EmbeddingRecord embedding;
  embedding.graph = config.text("graph");
  embedding.chain_strength = config.number("chain_strength", {.minimum = 0});
  const std::string source = config.file().string() + ": embedding.source";
  embedding.source = problem_from_dimod_json(config.object("source").json().dump(), source);
  for (const char* key : {"chains", "uncoupled"})  // read below, by JsonReader
    if (!config.has(key)) config.fail(key, "missing");
  const JsonReader reader(config.json(), config.file().string(), "embedding");
  const std::size_t n = embedding.source.variable_count();
  for (const Json& item : reader.list("chains")) {
    if (!item.is_array() || item.items().empty()) reader.fail("chains", "expected lists of at least one qubit");
    auto& chain = embedding.chains.emplace_back();
    for (const Json& qubit : item.items()) chain.push_back(reader.as_integer(qubit, "chains", 0, INT32_MAX));
  }
  reader.expect_size("chains", embedding.chains.size(), n);
  for (const Json& item : reader.list("uncoupled")) {
    if (!item.is_array() || item.items().size() != 2) reader.fail("uncoupled", "expected pairs of positions");
    embedding.uncoupled.emplace_back(
        std::uint32_t(reader.as_integer(item.items()[0], "uncoupled", 0, std::int64_t(n) - 1)),
        std::uint32_t(reader.as_integer(item.items()[1], "uncoupled", 0, std::int64_t(n) - 1)));
  }
  config.finish();
  return embedding;
}

/// Position in `read` of each variable of the sidecar; -1 for those the format dropped.
std::vector<std::ptrdiff_t> places(const Problem& read, const ProblemSidecar& sidecar, const std::string& source) {
  std::map<Label, std::ptrdiff_t> place;
  for (std::size_t i = 0; i < read.labels.size(); ++i) place[read.labels[i]] = std::ptrdiff_t(i);
  std::vector<std::ptrdiff_t> result;
  std::size_t found = 0;
  for (std::size_t k = 0; k < sidecar.labels.size(); ++k) {
    const Label name = sidecar.ids.empty() ? sidecar.labels[k] : Label(sidecar.ids[k]);
    const auto at = place.find(name);
    if (at == place.end() && facts(sidecar.format).every_variable)
      throw InputError(source + ": variable " + label_text(name) +
                       " of the sidecar is missing; keep problem and sidecar together, unchanged");
    result.push_back(at == place.end() ? -1 : at->second);
    found += at != place.end();
  }
  if (found != read.variable_count())
    throw InputError(source + ": has variables that the sidecar does not know; keep problem and sidecar together");
  return result;
}

}  // namespace

ProblemSidecar sidecar_of(const WrittenProblem& written, ProblemFormat format) {
  ProblemSidecar sidecar;
  sidecar.problem_hash = problem_hash(written.problem);
  sidecar.format = format;
  sidecar.vartype = written.problem.vartype;
  sidecar.offset = written.problem.offset;
  sidecar.labels = written.problem.labels;
  sidecar.ids = written.ids;
  return sidecar;
}

std::filesystem::path sidecar_path(const std::filesystem::path& problem) { return problem.string() + ".sidecar.json"; }

Json to_json(const ProblemSidecar& sidecar) {
  Json json;
  json["format"] = kFormat;
  json["problem_hash"] = sidecar.problem_hash;
  json["problem_format"] = facts(sidecar.format).name;
  json["vartype"] = vartype_name(sidecar.vartype);
  json["offset"] = sidecar.offset;
  json["scale"] = sidecar.scale;
  json["beta"] = sidecar.beta;
  json["labels"] = labels_json(sidecar.labels);
  if (!sidecar.ids.empty()) json["ids"] = Json(sidecar.ids);
  if (!sidecar.gauge.empty()) {
    Json gauge = Json::array();
    for (std::int8_t sign : sidecar.gauge) gauge.push_back(Json(int(sign)));
    json["gauge"] = std::move(gauge);
  }
  if (sidecar.embedding) json["embedding"] = embedding_json(*sidecar.embedding);
  return json;
}

ProblemSidecar sidecar_from_json(const Config& config) {
  if (config.text("format") != kFormat) config.fail("format", std::string("expected \"") + kFormat + "\"");
  const JsonReader reader(config.json(), config.file().string(), "");
  ProblemSidecar sidecar;
  sidecar.problem_hash = config.text("problem_hash");
  std::vector<std::string> names;
  for (const FormatFacts& format : problem_formats()) names.push_back(format.name);
  sidecar.format = format_named(config.choice("problem_format", names)).format;
  sidecar.vartype = config.choice("vartype", {"BINARY", "SPIN"}) == "SPIN" ? Vartype::spin : Vartype::binary;
  sidecar.offset = config.number("offset");
  sidecar.scale = config.number("scale", {.minimum = 1e-300});
  sidecar.beta = config.number("beta", {.minimum = 1e-300});
  config.has("labels");
  sidecar.labels = labels_from_json(reader, "labels", reader.list("labels").size());
  if (config.has("ids")) {
    sidecar.ids = reader.integers("ids", 0, INT32_MAX);
    reader.expect_size("ids", sidecar.ids.size(), sidecar.labels.size());
  }
  if (config.has("gauge")) {
    for (std::int64_t sign : reader.integers("gauge", -1, 1)) {
      if (sign == 0) reader.fail("gauge", "expected -1 and 1");
      sidecar.gauge.push_back(std::int8_t(sign));
    }
    reader.expect_size("gauge", sidecar.gauge.size(), sidecar.labels.size());
  }
  if (config.has("embedding")) sidecar.embedding = embedding_from_json(config.object("embedding"));
  return sidecar;
}

Problem restore(const Problem& read, const ProblemSidecar& sidecar, const std::string& source) {
  const std::vector<std::ptrdiff_t> place = places(read, sidecar, source);
  Problem problem;
  problem.vartype = read.vartype;
  problem.labels = sidecar.labels;
  problem.offset = facts(sidecar.format).offset ? read.offset : sidecar.offset;
  std::vector<std::uint32_t> position(read.variable_count());
  for (std::size_t k = 0; k < place.size(); ++k) {
    problem.linear.push_back(place[k] < 0 ? 0.0 : read.linear[std::size_t(place[k])]);
    if (place[k] >= 0) position[std::size_t(place[k])] = std::uint32_t(k);
  }
  for (const Coupling& c : read.couplings)
    problem.couplings.push_back(
        {std::min(position[c.a], position[c.b]), std::max(position[c.a], position[c.b]), c.value});
  std::sort(problem.couplings.begin(), problem.couplings.end(),
            [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  check_problem(problem, source);
  if (problem.vartype != sidecar.vartype || problem.offset != sidecar.offset ||
      problem_hash(problem) != sidecar.problem_hash)
    throw InputError(source +
                     ": problem_hash: the sidecar belongs to another problem; keep problem and sidecar "
                     "together, unchanged");
  return problem;
}

}  // namespace gonogo::learning
