// bqpjson 1.0.0 of Los Alamos (github.com/lanl-ansi/bqpjson): value = scale (offset + linear + quadratic), variables
// are numbers, domains "spin" and "boolean".

#include <set>

#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

Json terms_json(const std::vector<Entry>& entries, bool linear) {
  Json list = Json::array();
  for (const Entry& e : entries) {
    Json term;
    term["coeff"] = e.value;
    if (linear) {
      term["id"] = Json(e.i);
    } else {
      term["id_head"] = Json(e.j);
      term["id_tail"] = Json(e.i);
    }
    list.push_back(std::move(term));
  }
  return list;
}

std::vector<std::int64_t> read_ids(const JsonReader& reader) {
  std::vector<std::int64_t> ids = reader.integers("variable_ids", 0, kMaxId);
  std::set<std::int64_t> seen;
  for (std::int64_t id : ids)
    if (!seen.insert(id).second) reader.fail("variable_ids", std::to_string(id) + " is listed twice");
  return ids;
}

/// Reads terms; `tail` = `head` for linear ones.
void read_terms(const JsonReader& reader, const std::string& key, const char* tail, const char* head,
                const std::set<std::int64_t>& ids, std::vector<Entry>& entries) {
  std::set<std::pair<std::int64_t, std::int64_t>> seen;
  for (std::size_t k = 0; k < reader.list(key).size(); ++k) {
    const JsonReader term = reader.item(key, k);
    const Entry entry{term.integer(tail, 0, kMaxId), term.integer(head, 0, kMaxId), term.number("coeff")};
    for (std::int64_t id : {entry.i, entry.j})
      if (!ids.count(id)) term.fail("", "variable " + std::to_string(id) + " is not among variable_ids");
    if (std::string(tail) != head && entry.i == entry.j) term.fail("", "couples a variable to itself");
    if (!seen.emplace(entry.i, entry.j).second) term.fail("", "the same term is given twice");
    entries.push_back(entry);
  }
}

/// The bytes of json.dumps(data, sort_keys=True) and a newline. Every variable has a linear term.
std::string to_bqpjson(const Problem& problem, const FormatOptions&) {
  check_problem(problem, "problem");
  const std::vector<std::int64_t> ids = file_ids(problem);
  std::vector<Entry> linear;
  Json variable_ids = Json::array();
  for (std::size_t k : by_id(ids)) {
    linear.push_back({ids[k], ids[k], problem.linear[k]});
    variable_ids.push_back(Json(ids[k]));
  }
  Json json;
  json["id"] = 0;
  json["linear_terms"] = terms_json(linear, true);
  json["metadata"] = Json::object();
  json["offset"] = problem.offset;
  json["quadratic_terms"] = terms_json(coupling_entries(problem, ids), false);
  json["scale"] = 1.0;
  json["variable_domain"] = problem.vartype == Vartype::spin ? "spin" : "boolean";
  json["variable_ids"] = std::move(variable_ids);
  json["version"] = "1.0.0";
  return python_json(json, JsonSpaces::after) + "\n";
}

/// As strict as bqpjson's validate(), and checks the version, which its schema does not. A pair given in both orders
/// adds up. The scale is multiplied in. Solutions in the file are ignored.
Problem problem_from_bqpjson(const std::string& text, const FormatOptions&, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader reader(json, source, "");
  reader.expect_text("version", "1.0.0");
  const std::string domain = reader.text("variable_domain");
  if (domain != "spin" && domain != "boolean")
    reader.fail("variable_domain", "expected \"spin\" or \"boolean\", found \"" + domain + "\"");
  reader.integer("id", 0, INT64_MAX / 2);
  reader.object("metadata");
  const double scale = reader.number("scale");
  if (scale < 0) reader.fail("scale", "must not be negative");
  const std::vector<std::int64_t> ids = read_ids(reader);
  const std::set<std::int64_t> known(ids.begin(), ids.end());
  std::vector<Entry> entries;
  read_terms(reader, "linear_terms", "id", "id", known, entries);
  read_terms(reader, "quadratic_terms", "id_tail", "id_head", known, entries);
  for (Entry& e : entries) e.value *= scale;
  Problem problem =
      problem_from_entries(domain == "spin" ? Vartype::spin : Vartype::binary, ids, entries, Repeats::add, source);
  problem.offset = scale * reader.number("offset");
  check_problem(problem, source);
  return problem;
}

}  // namespace

extern const Format kBqpjson = {.name = "bqpjson",
                                .extension = ".bqpjson",
                                .about = "LANL bqpjson 1.0.0",
                                .labels = false,
                                .write = to_bqpjson,
                                .read = problem_from_bqpjson};

}  // namespace gonogo::learning
