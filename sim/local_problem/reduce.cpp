#include <Eigen/SparseLU>

#include "base/error.h"
#include "sim/local_problem/read.h"

namespace gonogo::sim {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

Sparse to_eigen(const std::string& name, const char* what, const TripletMatrix& a) {
  std::vector<Eigen::Triplet<double>> entry;
  for (const Triplet& t : a.entry) {
    if (!std::isfinite(t.value))
      throw InputError(name + ": " + what + "(" + std::to_string(t.row) + ", " + std::to_string(t.column) +
                       ") is not a finite number");
    entry.emplace_back(t.row, t.column, t.value);
  }
  Sparse matrix(a.rows, a.columns);
  matrix.setFromTriplets(entry.begin(), entry.end());
  return matrix;
}

void require_sizes(const std::string& name, const GlobalProblem& p) {
  const auto require = [&](const std::string& what, std::size_t found, std::size_t needed) {
    if (found != needed)
      throw InputError(name + ": " + what + " is " + std::to_string(found) + "; " + std::to_string(needed) +
                       " is needed");
  };
  require("the number of columns of M", std::size_t(p.m.columns), std::size_t(p.m.rows));
  require("the number of rows of H", std::size_t(p.h.rows), std::size_t(p.m.rows));
  require("the number of columns of H", std::size_t(p.h.columns), p.mu.size() * std::size_t(p.dimension));
  require("the length of f", p.f.size(), std::size_t(p.m.rows));
  require("the length of w", p.w.size(), std::size_t(p.h.columns));
}

}  // namespace

LocalProblem reduce_to_local(const std::string& name, const GlobalProblem& problem) {
  require_sizes(name, problem);
  const Sparse m = to_eigen(name, "M", problem.m), h = to_eigen(name, "H", problem.h);
  Eigen::SparseLU<Sparse> lu(m);
  if (lu.info() != Eigen::Success)
    throw InputError(name + ": M is singular (" + lu.lastErrorMessage() + "); every freedom needs a mass");
  const Eigen::Map<const Eigen::VectorXd> f(problem.f.data(), Eigen::Index(problem.f.size()));
  const Eigen::VectorXd free_velocity = lu.solve(f);
  const Sparse w = (h.transpose() * Sparse(lu.solve(h))).pruned(1.0, 0.0);
  std::vector<Triplet> entry;
  for (Eigen::Index column = 0; column < w.cols(); ++column)
    for (Sparse::InnerIterator it(w, column); it; ++it) entry.push_back({Index(it.row()), Index(column), it.value()});
  Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(problem.w.data(), Eigen::Index(problem.w.size()));
  q += h.transpose() * free_velocity;
  return make_problem(name, problem.dimension, entry, std::vector<double>(q.begin(), q.end()), problem.mu,
                      problem.mu_roll);
}

}  // namespace gonogo::sim
