#include "sim/local_problem/banded/spike_preconditioner.h"

#include <Eigen/IterativeLinearSolvers>
#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/cuthill_mckee_ordering.hpp>
#include <chrono>
#include <functional>
#include <utility>

namespace gonogo::sim {

using Sparse = Eigen::SparseMatrix<double>;

std::vector<Eigen::Index> reverse_cuthill_mckee(const Sparse& a) {
  using Graph = boost::adjacency_list<
      boost::vecS, boost::vecS, boost::undirectedS,
      boost::property<boost::vertex_color_t, boost::default_color_type, boost::property<boost::vertex_degree_t, int>>>;
  std::vector<std::pair<Eigen::Index, Eigen::Index>> edges;  // each once, from low to high
  for (Eigen::Index k = 0; k < a.outerSize(); ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it)
      if (it.row() != it.col()) edges.emplace_back(std::minmax(it.row(), it.col()));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Graph graph(edges.begin(), edges.end(), std::size_t(a.rows()));
  std::vector<std::size_t> order(std::size_t(a.rows()));
  boost::cuthill_mckee_ordering(graph, order.rbegin(), get(boost::vertex_color, graph), boost::make_degree_map(graph));
  return {order.begin(), order.end()};
}

Band to_band(const Sparse& a, const std::vector<Eigen::Index>& order, Eigen::Index most_half) {
  std::vector<Eigen::Index> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) place[std::size_t(order[k])] = Eigen::Index(k);
  const auto visit = [&](auto&& use) {
    for (Eigen::Index k = 0; k < a.outerSize(); ++k)
      for (Sparse::InnerIterator it(a, k); it; ++it)
        use(place[std::size_t(it.row())], place[std::size_t(it.col())], it.value());
  };
  Band band;
  visit([&](Eigen::Index i, Eigen::Index j, double) { band.full_half = std::max(band.full_half, std::abs(i - j)); });
  band.matrix = BandedMatrix<double>(a.rows(), std::min(band.full_half, most_half));
  double all = 0, outside = 0;
  visit([&](Eigen::Index i, Eigen::Index j, double value) {
    all += value * value;
    if (std::abs(i - j) <= band.matrix.half)
      band.matrix.at(i, j) += value;
    else
      outside += value * value;
  });
  band.dropped = all > 0 ? std::sqrt(outside / all) : 0;
  return band;
}

using Eigen::VectorXd;

namespace {

class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// What Eigen asks of a preconditioner; without an operator it is the identity.
class Applied {
 public:
  using StorageIndex = Sparse::StorageIndex;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic };

  void use(std::function<VectorXd(const VectorXd&)> apply) { apply_ = std::move(apply); }
  template <class Matrix>
  Applied& analyzePattern(const Matrix&) {
    return *this;
  }
  template <class Matrix>
  Applied& factorize(const Matrix&) {
    return *this;
  }
  template <class Matrix>
  Applied& compute(const Matrix&) {
    return *this;
  }
  template <class Rhs>
  VectorXd solve(const Eigen::MatrixBase<Rhs>& b) const {
    return apply_ ? apply_(b) : VectorXd(b);
  }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  std::function<VectorXd(const VectorXd&)> apply_;
};

template <class Scalar>
VectorXd apply(const Spike<Scalar>& spike, const std::vector<Eigen::Index>& order, const VectorXd& b) {
  const double size = b.lpNorm<Eigen::Infinity>();  // float holds no small residuals: they are scaled
  if (!(size > 0)) return b;
  typename Spike<Scalar>::Vector x(b.size());
  for (Eigen::Index k = 0; k < b.size(); ++k) x[k] = Scalar(b[order[std::size_t(k)]] / size);
  spike.solve(x);
  VectorXd out(b.size());
  for (Eigen::Index k = 0; k < b.size(); ++k) out[order[std::size_t(k)]] = size * double(x[k]);
  return out;
}

}  // namespace

struct PreconditionedKrylov::Factors {
  std::unique_ptr<Spike<float>> in_float;
  std::unique_ptr<Spike<double>> in_double;
};

PreconditionedKrylov::PreconditionedKrylov(const PreconditionerSettings& settings)
    : settings_(settings), factors_(std::make_unique<Factors>()) {}

PreconditionedKrylov::~PreconditionedKrylov() = default;

void PreconditionedKrylov::factorise(const Sparse& a) {
  a_ = a;
  if (!settings_.is_used) return;
  const Stopwatch watch;
  if (order_.empty()) order_ = reverse_cuthill_mckee(a);
  Band band = to_band(a, order_, settings_.most_half);
  work_.half = band.matrix.half;
  work_.full_half = band.full_half;
  work_.dropped = std::max(work_.dropped, band.dropped);
  const auto note = [&](const auto& spike) {
    work_.bytes = std::max(work_.bytes, spike.bytes());
    work_.partitions = spike.partitions();
  };
  if (settings_.is_single) {
    factors_->in_float = std::make_unique<Spike<float>>(std::move(band.matrix), settings_.spike);
    note(*factors_->in_float);
  } else {
    factors_->in_double = std::make_unique<Spike<double>>(std::move(band.matrix), settings_.spike);
    note(*factors_->in_double);
  }
  work_.setup_ms += watch.ms();
}

bool PreconditionedKrylov::solve(const VectorXd& b, VectorXd& x) {
  const Stopwatch watch;
  Eigen::BiCGSTAB<Sparse, Applied> method;
  if (factors_->in_float)
    method.preconditioner().use([&](const VectorXd& v) { return apply(*factors_->in_float, order_, v); });
  else if (factors_->in_double)
    method.preconditioner().use([&](const VectorXd& v) { return apply(*factors_->in_double, order_, v); });
  method.setTolerance(settings_.tolerance);
  method.setMaxIterations(settings_.max_iterations);
  method.compute(a_);
  x = method.solve(b);
  ++work_.solves;
  work_.inner_iterations += method.iterations();
  work_.solve_ms += watch.ms();
  return method.info() == Eigen::Success && x.allFinite();
}

}  // namespace gonogo::sim
