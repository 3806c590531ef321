// Coordinate text of dimod.serialization.coo: lines "i j value", i <= j, i = j for linear terms, and a first line
// "# vartype=BINARY" or "# vartype=SPIN". A second comment of ours, "# 733 coefficients", shows a file that was cut
// off; dimod's files have none. The format has no offset, only numbers as labels, and no variable without coefficients.
// dimod silently skips lines with exponents, so values are in fixed notation: dimod's six decimals when these are
// exact, otherwise as many digits as identify the value.

#include <algorithm>
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

/// The count in a comment "# 733 coefficients"; nothing in other comments.
std::optional<std::size_t> stated_count(const std::vector<std::string_view>& words) {
  if (words.size() != 3 || words[0] != "#" || words[2] != "coefficients") return std::nullopt;
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(words[1].data(), words[1].data() + words[1].size(), count);
  if (error != std::errc() || end != words[1].data() + words[1].size()) return std::nullopt;
  return count;
}

/// Digits behind the point.
std::size_t decimals(std::string_view number) {
  const std::size_t point = number.find('.');
  return point == std::string_view::npos ? 0 : number.size() - point - 1;
}

/// What a file shows of having been cut off. Without a count that is a last number with fewer decimals than all others
/// have, at the end of a line that has no end.
class CutOff {
 public:
  void take(std::string_view number) {
    if (count_++ > 0) fewest_ = std::min(fewest_, last_);
    last_ = decimals(number);
  }
  void check(const std::string& text, std::optional<std::size_t> stated, const std::string& source) const {
    const bool ends = !text.empty() && text.back() == '\n';
    if (stated && (*stated != count_ || !ends))
      throw InputError(source + ": its header states " + std::to_string(*stated) + " coefficients, " +
                       std::to_string(count_) + (ends ? "" : ", the last one cut off,") +
                       " are there; copy or export the file again, or drop the header's count when you changed it");
    if (!stated && !ends && count_ > 1 && last_ < fewest_)
      throw InputError(source + ": ends in a number with " + std::to_string(last_) +
                       " decimals and no line end, where all "
                       "others have at least " +
                       std::to_string(fewest_) + ": it was cut off; copy it again, or end its last line");
  }

 private:
  std::size_t count_ = 0, last_ = 0, fewest_ = std::string::npos;
};

std::string to_coo(const Problem& problem, const FormatOptions&) {
  check_problem(problem, "problem");
  const std::vector<std::int64_t> ids = file_ids(problem);
  const std::vector<Entry> couplings = coupling_entries(problem, ids);
  const std::size_t linear =
      problem.linear.size() - std::size_t(std::count(problem.linear.begin(), problem.linear.end(), 0.0));
  std::string text = "# vartype=" + vartype_name(problem.vartype) + "\n# " + std::to_string(linear + couplings.size()) +
                     " coefficients\n";
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
  std::optional<std::size_t> stated;
  CutOff cut_off;
  while (lines.next()) {
    if (lines.words()[0][0] == '#') {
      read_coo_comment(lines, vartype);
      if (const auto count = stated_count(lines.words())) stated = count;
      continue;
    }
    lines.expect_words(3);
    entries.push_back({lines.integer(0, 0, kMaxId), lines.integer(1, 0, kMaxId), lines.number(2)});
    cut_off.take(lines.words()[2]);
  }
  cut_off.check(text, stated, source);
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
