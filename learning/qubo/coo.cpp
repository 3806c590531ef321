#include "learning/qubo/coo.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "learning/qubo/entries.h"
#include "learning/qubo/text_lines.h"

namespace gonogo::learning {
namespace {

/// "%f" where that is the exact value, otherwise the fewest digits in fixed notation that read back to the same bits.
std::string fixed_number(double x) {
  char text[512];
  std::snprintf(text, sizeof text, "%f", x);
  if (std::strtod(text, nullptr) == x) return text;
  return std::string(text, std::to_chars(text, text + sizeof text, x, std::chars_format::fixed).ptr);
}

void append_line(std::string& text, std::int64_t i, std::int64_t j, double value) {
  text += std::to_string(i) + " " + std::to_string(j) + " " + fixed_number(value) + "\n";
}

/// The word after "vartype=" or "vartype:" in a comment, as dimod's reader finds it; empty when there is none.
std::string header_vartype(std::string_view line) {
  for (std::size_t at = line.find("vartype"); at != std::string_view::npos; at = line.find("vartype", at + 1)) {
    std::size_t from = at + 7;
    if (from >= line.size() || (line[from] != '=' && line[from] != ':')) continue;
    ++from;
    while (from < line.size() && (line[from] == ' ' || line[from] == '\t')) ++from;
    std::size_t to = from;
    while (to < line.size() && (std::isalnum(static_cast<unsigned char>(line[to])) || line[to] == '_')) ++to;
    if (to > from) return std::string(line.substr(from, to - from));
  }
  return "";
}

void read_header(const TextLines& lines, std::optional<Vartype>& vartype) {
  const std::string name = header_vartype(lines.line());
  if (name.empty()) return;
  if (name != "BINARY" && name != "SPIN") lines.fail("vartype " + name + " is neither BINARY nor SPIN");
  const Vartype found = name == "SPIN" ? Vartype::spin : Vartype::binary;
  if (vartype && *vartype != found) lines.fail("vartype " + name + " contradicts what was said before");
  vartype = found;
}

}  // namespace

std::string to_coo(const Problem& problem) {
  check_problem(problem, "problem");
  const std::vector<std::int64_t> ids = file_ids(problem);
  const std::vector<Entry> couplings = coupling_entries(problem, ids);
  std::string text = "# vartype=" + vartype_name(problem.vartype) + "\n";
  auto next = couplings.begin();
  for (std::size_t k : by_id(ids)) {
    if (problem.linear[k] != 0) append_line(text, ids[k], ids[k], problem.linear[k]);
    for (; next != couplings.end() && next->i == ids[k]; ++next) append_line(text, next->i, next->j, next->value);
  }
  return text;
}

Problem problem_from_coo(const std::string& text, std::optional<Vartype> vartype, const std::string& source) {
  TextLines lines(text, source);
  std::vector<Entry> entries;
  while (lines.next()) {
    if (lines.words()[0][0] == '#') {
      read_header(lines, vartype);
      continue;
    }
    lines.expect_words(3);
    entries.push_back({lines.integer(0, 0, kMaxId), lines.integer(1, 0, kMaxId), lines.number(2)});
  }
  if (!vartype) throw InputError(source + ": no line \"# vartype=BINARY\" or \"# vartype=SPIN\"; say which one it is");
  return problem_from_entries(*vartype, {}, entries, Repeats::add, source);
}

}  // namespace gonogo::learning
