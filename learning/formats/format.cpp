#include "learning/formats/format.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "learning/formats/dimod.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {

extern const Format kDimodJson, kDimodBqm, kDimodBqm1, kBqpjson, kCoo, kQbsolv, kMqlib, kBiqMac, kRudy, kSapi, kCsv;

namespace {

/// All formats, in the order of lists for people.
const Format* const kFormats[] = {&kDimodJson, &kDimodBqm, &kDimodBqm1, &kBqpjson, &kCoo, &kQbsolv,
                                  &kMqlib,     &kBiqMac,   &kRudy,      &kSapi,    &kCsv};

bool has_text_labels(const Problem& problem) {
  return std::any_of(problem.labels.begin(), problem.labels.end(),
                     [](const Label& label) { return !std::holds_alternative<std::int64_t>(label); });
}

/// Drops what the format would lose silently when read back: zero couplings and the sign of zeros.
void normalise(Problem& problem, const Format& format, std::vector<std::string>& notes) {
  if (format.labels) return;
  problem.offset += 0.0;
  for (double& bias : problem.linear) bias += 0.0;
  for (Coupling& c : problem.couplings) c.value += 0.0;
  if (format.zeros) return;
  const std::size_t dropped = std::erase_if(problem.couplings, [](const Coupling& c) { return c.value == 0; });
  if (dropped > 0) notes.push_back(std::to_string(dropped) + " couplings of value 0 are left out");
}

std::size_t isolated_count(const Problem& problem) {
  std::vector<bool> seen(problem.variable_count(), false);
  for (const Coupling& c : problem.couplings) seen[c.a] = seen[c.b] = true;
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) count += !seen[i] && problem.linear[i] == 0;
  return count;
}

void note_losses(const Problem& problem, const Format& format, std::vector<std::string>& notes) {
  const std::string name = format.name;
  if (!format.offset && problem.offset != 0)
    notes.push_back(name + " has no place for the offset; the sidecar keeps it");
  if (!format.labels && has_text_labels(problem))
    notes.push_back(name + " numbers its variables; the sidecar keeps their labels");
  const std::size_t isolated = format.every_variable ? 0 : isolated_count(problem);
  if (isolated > 0)
    notes.push_back(name + " has no place for " + std::to_string(isolated) +
                    " variables without coefficients; the sidecar keeps them");
}

std::vector<std::int64_t> ids_for(const Problem& problem, const Format& format) {
  if (format.labels) return {};
  if (!format.from_one) return file_ids(problem);
  std::vector<std::int64_t> ids(problem.variable_count());  // read back as the number less one
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = std::int64_t(i);
  return ids;
}

std::vector<const Format*> formats_with(bool (*has)(const Format&)) {
  std::vector<const Format*> found;
  for (const Format* format : kFormats)
    if (has(*format)) found.push_back(format);
  return found;
}

const Format& named(const std::vector<const Format*>& formats, const std::string& name, const std::string& what) {
  for (const Format* format : formats)
    if (format->name == name) return *format;
  throw InputError(what + " \"" + name + "\" does not exist; use one of " + join_words(names_of(formats)));
}

}  // namespace

const std::vector<const Format*>& problem_formats() {
  static const auto formats = formats_with([](const Format& f) { return f.write != nullptr; });
  return formats;
}

const std::vector<const Format*>& answer_formats() {
  static const auto formats = formats_with([](const Format& f) { return f.read_answer != nullptr; });
  return formats;
}

std::vector<std::string> names_of(const std::vector<const Format*>& formats) {
  std::vector<std::string> names;
  for (const Format* format : formats) names.emplace_back(format->name);
  return names;
}

const Format& format_named(const std::string& name) { return named(problem_formats(), name, "format"); }

const Format& answer_format_named(const std::string& name) { return named(answer_formats(), name, "answer format"); }

const Format* format_of_file(const std::string& file_name) {
  const Format* best = nullptr;  // ".sapi.json" wins over ".json"
  for (const Format* format : problem_formats())
    if (file_name.ends_with(format->extension) &&
        (!best || std::string_view(format->extension).size() > std::string_view(best->extension).size()))
      best = format;
  return best;
}

WrittenProblem write_problem(const Problem& problem, const Format& format, const FormatOptions& options) {
  WrittenProblem result;
  result.problem = problem;
  const bool holds = problem.vartype == Vartype::binary ? format.binary : format.spin;
  if (!holds) {
    const Vartype other = problem.vartype == Vartype::binary ? Vartype::spin : Vartype::binary;
    result.problem = to_vartype(problem, other);
    result.notes.push_back("converted to " + vartype_name(other) + ", the only kind " + format.name + " holds");
  }
  normalise(result.problem, format, result.notes);
  note_losses(result.problem, format, result.notes);
  result.ids = ids_for(result.problem, format);
  result.text = format.write(result.problem, options);
  return result;
}

Problem read_problem(const std::string& text, const Format& format, const FormatOptions& options,
                     const std::string& source) {
  refuse_foreign_file(text, source);
  return format.read(text, options, source);
}

SampleSet read_answer(const std::string& text, const Format& format, const Problem& problem,
                      const std::string& source) {
  refuse_foreign_file(text, source);
  return format.read_answer(text, problem, source);
}

std::string problem_hash(const Problem& problem) { return content_hash(to_dimod_json(problem)); }

namespace {

/// Column of the answer that holds each variable of the problem.
std::vector<std::size_t> answer_columns(const Problem& problem, const SampleSet& answer, const std::string& source) {
  std::map<Label, std::size_t> column;
  for (std::size_t k = 0; k < answer.labels.size(); ++k) column.emplace(answer.labels[k], k);
  if (column.size() != problem.variable_count() || answer.labels.size() != problem.variable_count())
    throw InputError(source + ": the answer has " + std::to_string(answer.labels.size()) + " variables, the problem " +
                     std::to_string(problem.variable_count()) + "; give the answer to this very problem");
  std::vector<std::size_t> result;
  for (const Label& label : problem.labels) {
    const auto found = column.find(label);
    if (found == column.end())
      throw InputError(source + ": the answer has no variable " + label_text(label) +
                       "; give the answer to this very problem");
    result.push_back(found->second);
  }
  return result;
}

void check_hash(const Problem& problem, const SampleSet& answer, const std::string& source) {
  const Json* hash = answer.info.is_object() ? answer.info.find("problem_hash") : nullptr;
  if (hash && hash->is_string() && hash->string() != problem_hash(problem))
    throw InputError(source + ": info.problem_hash: this answer was made for another problem (" + hash->string() + ")");
}

double energy_scale(const Problem& problem) {
  double scale = std::abs(problem.offset);
  for (double bias : problem.linear) scale += std::abs(bias);
  for (const Coupling& c : problem.couplings) scale += std::abs(c.value);
  return std::max(scale, 1e-300);
}

}  // namespace

SampleSet check_answer(const Problem& problem, const SampleSet& answer, const std::string& source) {
  check_hash(problem, answer, source);
  const std::vector<std::size_t> column = answer_columns(problem, answer, source);
  SampleSet result{
      .vartype = problem.vartype, .labels = problem.labels, .occurrences = answer.occurrences, .info = answer.info};
  const double tolerance = 1e-6 * energy_scale(problem);
  const std::size_t n = problem.variable_count();
  for (std::size_t r = 0; r < answer.row_count(); ++r) {
    for (std::size_t i = 0; i < n; ++i) {
      const std::int8_t value = answer.row(r)[column[i]];
      if (answer.vartype == problem.vartype)
        result.values.push_back(value);
      else
        result.values.push_back(problem.vartype == Vartype::binary ? value > 0 : (value > 0 ? 1 : -1));
    }
    const double expected = energy(problem, std::span(result.values).subspan(r * n, n));
    if (!(std::abs(expected - answer.energies[r]) <= tolerance)) {
      std::ostringstream text;
      text << source << ": row " << r << ": energy " << answer.energies[r] << " does not match the problem's "
           << expected << "; the answer is for another problem, or was scaled";
      throw InputError(text.str());
    }
    result.energies.push_back(expected);
  }
  return result;
}

namespace {

struct ForeignKind {
  std::string_view magic, name, remedy;
};

constexpr ForeignKind kForeignKinds[] = {
    {"DIMODCQM", "a constrained quadratic model (CQM) of dimod", "convert it with dimod.cqm_to_bqm and write that"},
    {"DIMODDQM", "a discrete quadratic model (DQM) of dimod", "give each case a binary variable and write a BQM"},
    {"DIMODQM", "a quadratic model (QM) of dimod", "write it as a BQM, of variables that are all BINARY or all SPIN"},
    {"PK\x03\x04", "a ZIP archive", "unpack it and give the problem inside"},
    {"\x89HDF\r\n", "an HDF5 file", "give a problem file, as gonogo qubo export writes it"},
};

/// Python's pickle: protocols 2 to 5 begin with 0x80 and their number, and end with a full stop.
bool is_pickle(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == '\x80' && bytes[1] >= 2 && bytes[1] <= 5 && bytes.back() == '.';
}

/// The first word that is not in a comment (LP comments begin with a backslash).
std::string first_word(std::string_view text) {
  std::size_t at = 0;
  while (at < text.size()) {
    if (std::isspace(static_cast<unsigned char>(text[at])))
      ++at;
    else if (text[at] == '\\')
      at = std::min(text.find('\n', at), text.size());
    else
      break;
  }
  std::string word;
  for (; at < text.size() && std::isalpha(static_cast<unsigned char>(text[at])) && word.size() < 16; ++at)
    word += char(std::tolower(static_cast<unsigned char>(text[at])));
  return word;
}

bool is_lp(std::string_view text) {
  const std::string word = first_word(text);
  return word == "minimize" || word == "maximize" || word == "minimise" || word == "maximise" || word == "minimum" ||
         word == "maximum";
}

}  // namespace

void refuse_foreign_file(std::string_view bytes, const std::string& source) {
  const auto refuse = [&](std::string_view name, std::string_view remedy) {
    throw InputError(source + ": is " + std::string(name) + ", not a binary quadratic problem; " + std::string(remedy));
  };
  for (const ForeignKind& kind : kForeignKinds)
    if (bytes.starts_with(kind.magic)) refuse(kind.name, kind.remedy);
  if (is_pickle(bytes)) refuse("a pickle of Python", "write it with to_file() or to_serializable() of dimod instead");
  if (is_lp(bytes))
    refuse("a linear program (LP file)", "read it with dimod.lp.load and convert it with dimod.cqm_to_bqm");
}

namespace {

constexpr const char* kSidecarFormat = "gonogo/sidecar/3";

Json embedding_json(const EmbeddingRecord& embedding) {
  Json json, chains = Json::array(), uncoupled = Json::array();
  for (const auto& chain : embedding.chains) chains.push_back(Json(chain));
  for (const auto& [a, b] : embedding.uncoupled) uncoupled.push_back(Json(Json::Array{Json(a), Json(b)}));
  json["graph"] = embedding.graph;
  json["chains"] = std::move(chains);
  json["chain_strength"] = embedding.chain_strength;
  json["uncoupled"] = std::move(uncoupled);
  json["source"] = dimod_json(embedding.source);
  return json;
}

EmbeddingRecord embedding_from_json(const Config& config) {
  EmbeddingRecord embedding{.graph = config.text("graph"),
                            .chain_strength = config.number("chain_strength", {.minimum = 0})};
  embedding.source = dimod_problem(config.object("source").json(), config.file().string() + ": embedding.source");
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
std::vector<std::ptrdiff_t> sidecar_places(const Problem& read, const ProblemSidecar& sidecar,
                                           const std::string& source) {
  std::map<Label, std::ptrdiff_t> place;
  for (std::size_t i = 0; i < read.labels.size(); ++i) place[read.labels[i]] = std::ptrdiff_t(i);
  std::vector<std::ptrdiff_t> result;
  std::size_t found = 0;
  for (std::size_t k = 0; k < sidecar.labels.size(); ++k) {
    const Label name = sidecar.ids.empty() ? sidecar.labels[k] : Label(sidecar.ids[k]);
    const auto at = place.find(name);
    if (at == place.end() && sidecar.format->every_variable)
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

ProblemSidecar sidecar_of(const WrittenProblem& written, const Format& format) {
  ProblemSidecar sidecar;
  sidecar.problem_hash = problem_hash(written.problem);
  sidecar.format = &format;
  sidecar.vartype = written.problem.vartype;
  sidecar.offset = written.problem.offset;
  sidecar.labels = written.problem.labels;
  sidecar.ids = written.ids;
  return sidecar;
}

std::filesystem::path sidecar_path(const std::filesystem::path& problem) { return problem.string() + ".sidecar.json"; }

Json to_json(const ProblemSidecar& sidecar) {
  Json json;
  json["format"] = kSidecarFormat;
  json["problem_hash"] = sidecar.problem_hash;
  json["problem_format"] = sidecar.format->name;
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
  if (config.text("format") != kSidecarFormat)
    config.fail("format", std::string("expected \"") + kSidecarFormat + "\"; export the problem again");
  const JsonReader reader(config.json(), config.file().string(), "");
  ProblemSidecar sidecar;
  sidecar.problem_hash = config.text("problem_hash");
  sidecar.format = &format_named(config.choice("problem_format", names_of(problem_formats())));
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
  const std::vector<std::ptrdiff_t> place = sidecar_places(read, sidecar, source);
  Problem problem;
  problem.vartype = read.vartype;
  problem.labels = sidecar.labels;
  problem.offset = sidecar.format->offset ? read.offset : sidecar.offset;
  std::vector<std::uint32_t> position(read.variable_count());
  for (std::size_t k = 0; k < place.size(); ++k) {
    problem.linear.push_back(place[k] < 0 ? 0.0 : read.linear[std::size_t(place[k])]);
    if (place[k] >= 0) position[std::size_t(place[k])] = std::uint32_t(k);
  }
  for (const Coupling& c : read.couplings)
    problem.couplings.push_back(
        {std::min(position[c.a], position[c.b]), std::max(position[c.a], position[c.b]), c.value});
  sort_couplings(problem.couplings);
  check_problem(problem, source);
  if (problem.vartype != sidecar.vartype || problem.offset != sidecar.offset ||
      problem_hash(problem) != sidecar.problem_hash)
    throw InputError(source +
                     ": problem_hash: the sidecar belongs to another problem; keep problem and sidecar "
                     "together, unchanged");
  return problem;
}

}  // namespace gonogo::learning
