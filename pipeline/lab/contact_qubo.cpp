#include "pipeline/lab/contact_qubo.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "sim/local_problem/problem.h"

namespace gonogo::lab {
namespace {

void check(const ContactEncoding& e) {
  if (e.bits < 1 || e.bits > 16)
    throw InputError("bits = " + std::to_string(e.bits) + "; a number from 1 to 16 is needed");
  if (!(e.range >= 0) || !std::isfinite(e.range))
    throw InputError("range = " + number_text(e.range) + "; a finite number, 0 or more, is needed");
  if (!(e.scale >= 0) || !std::isfinite(e.scale))
    throw InputError("scale = " + number_text(e.scale) + "; a finite number, 0 or more, is needed");
}

/// Fills in what was left to us.
ContactEncoding completed(ContactEncoding e, const sim::BoundedProgram& program) {
  const double largest = *std::max_element(program.minimiser.begin(), program.minimiser.end());
  if (e.range == 0) e.range = largest > 0 ? std::exp2(std::floor(std::log2(largest)) + 1) : 1;
  if (e.scale == 0) e.scale = program.minimum < 0 ? 20 / -program.minimum : 1;
  return e;
}

double weight(const ContactEncoding& e, int bit) { return e.range * std::exp2(bit) / (std::exp2(e.bits) - 1); }

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

}  // namespace

std::vector<double> ContactQubo::decode(std::span<const std::int8_t> row) const {
  std::vector<double> x(std::size_t(program.unknowns), 0.0);
  for (std::size_t v = 0; v < row.size(); ++v)
    if (row[v] > 0) x[v / std::size_t(encoding.bits)] += weight(encoding, int(v) % encoding.bits);
  return x;
}

ContactQubo contact_qubo(const sim::LocalProblem& problem, int facets, const ContactEncoding& encoding) {
  check(encoding);
  ContactQubo out;
  out.program = sim::bounded_program(problem, facets);
  out.encoding = completed(encoding, out.program);
  const ContactEncoding& e = out.encoding;
  const std::size_t unknowns = std::size_t(out.program.unknowns), count = unknowns * std::size_t(e.bits);
  const auto entry = [&](std::size_t a, std::size_t b) {  // of the matrix over bits
    const std::size_t i = a / std::size_t(e.bits), j = b / std::size_t(e.bits);
    return e.scale * out.program.m[i * unknowns + j] * weight(e, int(a) % e.bits) * weight(e, int(b) % e.bits);
  };
  for (std::size_t a = 0; a < count; ++a) {
    const std::size_t i = a / std::size_t(e.bits);
    out.problem.labels.emplace_back("x" + std::to_string(i) + "_" + std::to_string(a % std::size_t(e.bits)));
    out.problem.linear.push_back(e.scale * out.program.q[i] * weight(e, int(a) % e.bits) + entry(a, a) / 2);
    for (std::size_t b = a + 1; b < count; ++b)
      if (const double value = entry(a, b); value != 0)
        out.problem.couplings.push_back({std::uint32_t(a), std::uint32_t(b), value});
  }
  return out;
}

ContactAnswer judge(const ContactQubo& qubo, const sim::LocalProblem& problem, const learning::SampleSet& answer) {
  if (answer.row_count() == 0) throw InputError("the answer has no rows; ask for reads");
  const auto best = std::min_element(answer.energies.begin(), answer.energies.end());
  const std::vector<double> x = qubo.decode(answer.row(std::size_t(best - answer.energies.begin())));
  const double depth = std::max(std::abs(qubo.program.minimum), 1e-300);
  ContactAnswer out{.energy_gap = (qubo.program.objective(x) - qubo.program.minimum) / depth,
                    .r = qubo.program.impulses(x)};
  const std::vector<double> exact = qubo.program.impulses(qubo.program.minimiser);
  std::vector<double> difference = out.r;
  for (std::size_t i = 0; i < exact.size(); ++i) difference[i] -= exact[i];
  out.impulse_error = norm(difference) / std::max(norm(exact), 1e-300);
  out.ccp_error = sim::siconos_error(problem, out.r, sim::Target::ccp);
  double hits = 0, reads = 0;
  for (std::size_t k = 0; k < answer.row_count(); ++k) {
    reads += double(answer.occurrences[k]);
    if (answer.energies[k] <= *best + 1e-9 * depth * qubo.encoding.scale) hits += double(answer.occurrences[k]);
  }
  out.hit_share = hits / reads;
  return out;
}

}  // namespace gonogo::lab
