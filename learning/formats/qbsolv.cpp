// qbsolv's problem text (.qubo): "p qubo 0 maxNodes nNodes nCouplers", nNodes lines "i i w", nCouplers lines "i j w"
// with i < j, "c" comments; minimised over {0, 1}. The comments "c offset : x" and "c scale : x" and all bytes are
// those of bqpjson's bqp2qubo. Also reads qbsolv's answer text.

#include <optional>

#include "base/error.h"
#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

namespace gonogo::learning {
namespace {

void append_qubo_line(std::string& text, std::int64_t i, std::int64_t j, double value) {
  text += std::to_string(i) + " " + std::to_string(j) + " " + python_number(value) + "\n";
}

struct Counts {
  std::int64_t nodes = 0, linear = 0, quadratic = 0;
};

Counts read_program_line(const TextLines& lines) {
  lines.expect_words(6);
  if (lines.words()[1] != "qubo") lines.fail("expected \"p qubo\"");
  if (lines.words()[2] != "0" && lines.words()[2] != "unconstrained")
    lines.fail("topology " + std::string(lines.words()[2]) + " is not readable; 0 and unconstrained are");
  return {lines.integer(3, 0, kMaxId), lines.integer(4, 0, kMaxId), lines.integer(5, 0, kMaxId)};
}

/// "c offset : x" and "c scale : x".
void read_comment(const TextLines& lines, double& offset, double& scale) {
  const auto& words = lines.words();
  if (words.size() != 4 || words[2] != ":") return;
  if (words[1] == "offset") offset = lines.number(3);
  if (words[1] == "scale") scale = lines.number(3);
}

std::size_t string_of_bits(const TextLines& lines) {
  if (lines.words().size() != 1) return 0;
  const std::string_view word = lines.words()[0];
  return word.find_first_not_of("01") == std::string_view::npos ? word.size() : 0;
}

/// The problem must be in {0, 1}. Every variable has a line, also with bias 0.
std::string to_qbsolv(const Problem& problem, const FormatOptions&) {
  check_problem(problem, "problem");
  if (problem.vartype != Vartype::binary) throw InputError("qbsolv: the problem is SPIN; convert it to BINARY first");
  const std::vector<std::int64_t> ids = file_ids(problem);
  const std::vector<std::size_t> order = by_id(ids);
  std::string text = "c id : 0\nc \nc scale : 1.0\nc offset : " + python_number(problem.offset) + "\nc \n";
  text += "p qubo 0 " + std::to_string(order.empty() ? 0 : ids[order.back()] + 1) + " " + std::to_string(ids.size()) +
          " " + std::to_string(problem.couplings.size()) + "\nc linear terms\n";
  for (std::size_t k : order) append_qubo_line(text, ids[k], ids[k], problem.linear[k]);
  text += "c quadratic terms\n";
  for (const Entry& e : coupling_entries(problem, ids)) append_qubo_line(text, e.i, e.j, e.value);
  return text;
}

/// Throws InputError unless counts match, i < j < maxNodes, and each pair is given once (qbsolv takes the last). Offset
/// and scale comments count: E = scale (offset + sum).
Problem problem_from_qbsolv(const std::string& text, const FormatOptions&, const std::string& source) {
  TextLines lines(text, source);
  std::optional<Counts> counts;
  std::int64_t linear = 0;
  std::vector<Entry> entries;
  double offset = 0, scale = 1;
  while (lines.next()) {
    if (lines.words()[0] == "c") {
      read_comment(lines, offset, scale);
    } else if (lines.words()[0] == "p") {
      if (counts) lines.fail("a second line \"p qubo\"");
      counts = read_program_line(lines);
    } else {
      if (!counts) lines.fail("coefficients before the line \"p qubo 0 maxNodes nNodes nCouplers\"");
      lines.expect_words(3);
      const std::int64_t i = lines.integer(0, 0, counts->nodes - 1), j = lines.integer(1, 0, counts->nodes - 1);
      if (i > j)
        lines.fail("node " + std::to_string(i) + " above node " + std::to_string(j) + "; the smaller comes first");
      linear += i == j;
      entries.push_back({i, j, lines.number(2)});
    }
  }
  if (!counts) throw InputError(source + ": no line \"p qubo 0 maxNodes nNodes nCouplers\"");
  const auto quadratic = std::int64_t(entries.size()) - linear;
  if (linear != counts->linear || quadratic != counts->quadratic)
    throw InputError(source + ": " + std::to_string(linear) + " nodes and " + std::to_string(quadratic) +
                     " couplers are given where " + std::to_string(counts->linear) + " and " +
                     std::to_string(counts->quadratic) + " are declared");
  for (Entry& e : entries) e.value *= scale;
  Problem problem = problem_from_entries(Vartype::binary, {}, entries, Repeats::refuse, source);
  problem.offset = scale * offset;
  check_problem(problem, source);
  return problem;
}

/// qbsolv's output: a header, a string of bits for nodes 0, 1, ..., its energy. Gives one row over the problem's
/// variables; bits of other nodes are dropped. The energy has no offset, as qbsolv prints it.
SampleSet samples_from_qbsolv(const std::string& text, const Problem& problem, const std::string& source) {
  TextLines lines(text, source);
  const std::vector<std::int64_t> ids = file_ids(problem);
  SampleSet result;
  result.labels = problem.labels;
  while (lines.next()) {
    const std::size_t bits = string_of_bits(lines);
    if (bits == 0) continue;
    if (!result.values.empty()) lines.fail("a second string of bits; one solution is expected");
    for (std::int64_t id : ids) {
      if (std::size_t(id) >= bits) lines.fail("no bit for node " + std::to_string(id));
      result.values.push_back(
          lines.line()[std::size_t(lines.words()[0].data() - lines.line().data()) + std::size_t(id)] == '1');
    }
    if (!lines.next() || lines.words().size() < 2 || lines.words()[1] != "Energy")
      lines.fail("after the bits, the line \"<energy> Energy of solution\" is expected");
    result.energies.push_back(lines.number(0) + problem.offset);
    result.occurrences.push_back(1);
  }
  if (result.energies.empty()) throw InputError(source + ": no string of bits, no solution");
  return result;
}

}  // namespace

extern const Format kQbsolv = {.name = "qbsolv",
                               .extension = ".qubo",
                               .about = "qbsolv .qubo, as bqp2qubo writes it",
                               .spin = false,
                               .labels = false,
                               .write = to_qbsolv,
                               .read = problem_from_qbsolv,
                               .read_answer = samples_from_qbsolv};

}  // namespace gonogo::learning
