#include "sim/local_problem/methods/bounded_program.h"

#include "base/error.h"
#include "sim/local_problem/methods/faceted.h"

namespace gonogo::sim {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::vector<double> values(const RowMajor& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

}  // namespace

double BoundedProgram::objective(const std::vector<double>& x) const {
  double sum = 0;
  for (Index i = 0; i < unknowns; ++i) {
    double image = 0;
    for (Index j = 0; j < unknowns; ++j)
      image += m[std::size_t(i) * std::size_t(unknowns) + std::size_t(j)] * x[std::size_t(j)];
    sum += x[std::size_t(i)] * (0.5 * image + q[std::size_t(i)]);
  }
  return sum;
}

std::vector<double> BoundedProgram::impulses(const std::vector<double>& x) const {
  std::vector<double> r(generators.size() / std::size_t(unknowns), 0.0);
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = 0; j < x.size(); ++j) r[i] += generators[i * x.size() + j] * x[j];
  return r;
}

BoundedProgram bounded_program(const LocalProblem& problem, int facets) {
  constexpr Eigen::Index kMost = 400;
  const FacetedProblem faceted(problem, Target::ccp, facets);
  if (faceted.generator_count() > kMost)
    throw InputError(problem.name + ": " + std::to_string(faceted.generator_count()) + " unknowns; at most " +
                     std::to_string(kMost) + " are possible, take fewer facets or contacts");
  if (!faceted.is_symmetric())
    throw InputError(problem.name + ": W is not symmetric; a quadratic program needs a symmetric one");
  const Lcp lcp = faceted.generator_form();
  const LcpSolution exact = solve_qp(lcp, {1e-12, 0});
  if (exact.status == LcpStatus::ray || exact.error > 1e-8)
    throw InputError(problem.name + ": the relaxation has no solution; check that the contacts can be kept apart");
  BoundedProgram program{
      .unknowns = Index(lcp.size()), .m = values(RowMajor(lcp.m)), .q = {lcp.q.begin(), lcp.q.end()}};
  RowMajor generators(Eigen::Index(problem.q.size()), lcp.size());
  for (Eigen::Index j = 0; j < lcp.size(); ++j) {
    const auto column = faceted.scaled().impulses(faceted.impulses_of_generators(Eigen::VectorXd::Unit(lcp.size(), j)));
    generators.col(j) = Eigen::Map<const Eigen::VectorXd>(column.data(), generators.rows());
  }
  program.generators = values(generators);
  program.minimiser = {exact.x.begin(), exact.x.end()};
  program.minimum = program.objective(program.minimiser);
  return program;
}

}  // namespace gonogo::sim
