// Coordinate text of dimod.serialization.coo: lines "i j value", i <= j, i = j for linear terms, and a first line
// "# vartype=BINARY" or "# vartype=SPIN". It has no offset, only numbers as labels, and no variable without
// coefficients. dimod silently skips lines with exponents, so values are in fixed notation: dimod's six decimals when
// these are exact, otherwise as many digits as identify the value.

#include <charconv>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "learning/formats/format.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

/// "%f" where that is the exact value, otherwise the fewest digits in fixed notation that read back to the same bits.
std::string fixed_number(double x) {
  char text[512];
  std::snprintf(text, sizeof text, "%f", x);
  if (std::strtod(text, nullptr) == x) return text;
  return std::string(text, std::to_chars(text, text + sizeof text, x, std::chars_format::fixed).ptr);
}

void append_coo_line(std::string& text, std::int64_t i, std::int64_t j, double value) {
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

void read_coo_comment(const TextLines& lines, std::optional<Vartype>& vartype) {
  const std::string name = header_vartype(lines.line());
  if (name.empty()) return;
  if (name != "BINARY" && name != "SPIN") lines.fail("vartype " + name + " is neither BINARY nor SPIN");
  const Vartype found = name == "SPIN" ? Vartype::spin : Vartype::binary;
  if (vartype && *vartype != found) lines.fail("vartype " + name + " contradicts what was said before");
  vartype = found;
}

std::string to_coo(const Problem& problem, const FormatOptions&) {
  check_problem(problem, "problem");
  const std::vector<std::int64_t> ids = file_ids(problem);
  const std::vector<Entry> couplings = coupling_entries(problem, ids);
  std::string text = "# vartype=" + vartype_name(problem.vartype) + "\n";
  auto next = couplings.begin();
  for (std::size_t k : by_id(ids)) {
    if (problem.linear[k] != 0) append_coo_line(text, ids[k], ids[k], problem.linear[k]);
    for (; next != couplings.end() && next->i == ids[k]; ++next) append_coo_line(text, next->i, next->j, next->value);
  }
  return text;
}

/// Repeated lines add up, as in dimod. Lines that begin with # are comments. The vartype comes from a comment or from
/// the options; both must agree.
Problem problem_from_coo(const std::string& text, const FormatOptions& options, const std::string& source) {
  std::optional<Vartype> vartype = options.vartype;
  TextLines lines(text, source);
  std::vector<Entry> entries;
  while (lines.next()) {
    if (lines.words()[0][0] == '#') {
      read_coo_comment(lines, vartype);
      continue;
    }
    lines.expect_words(3);
    entries.push_back({lines.integer(0, 0, kMaxId), lines.integer(1, 0, kMaxId), lines.number(2)});
  }
  if (!vartype) throw InputError(source + ": no line \"# vartype=BINARY\" or \"# vartype=SPIN\"; say which one it is");
  return problem_from_entries(*vartype, {}, entries, Repeats::add, source);
}

}  // namespace

extern const Format kCoo = {.name = "coo",
                            .extension = ".coo",
                            .about = "dimod coordinate text",
                            .labels = false,
                            .offset = false,
                            .every_variable = false,
                            .write = to_coo,
                            .read = problem_from_coo};

}  // namespace gonogo::learning
