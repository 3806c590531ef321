// SPIKE against sparse LU of Eigen, and the reordering against its promise.
#include "sim/local_problem/banded/spike.h"

#include <omp.h>

#include <Eigen/SparseLU>
#include <numeric>
#include <random>

#include "sim/local_problem/banded/spike_preconditioner.h"
#include "tests/sim/local_problem/random_band.h"
#include "tests/support/catch.h"

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

Sparse to_sparse(const BandedMatrix<double>& a) {
  std::vector<Eigen::Triplet<double>> entry;
  for (Index i = 0; i < a.size; ++i)
    for (Index j = std::max<Index>(0, i - a.half); j <= std::min(a.size - 1, i + a.half); ++j)
      entry.emplace_back(i, j, a.at(i, j));
  Sparse out(a.size, a.size);
  out.setFromTriplets(entry.begin(), entry.end());
  return out;
}

VectorXd right_side(Index n) {
  VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = std::sin(1.7 * double(i + 1));
  return b;
}

VectorXd direct(const Sparse& a, const VectorXd& b) {
  const Eigen::SparseLU<Sparse> lu(a);
  return lu.solve(b);
}

double off(const VectorXd& x, const VectorXd& reference) { return (x - reference).norm() / reference.norm(); }

}  // namespace

TEST_CASE("full SPIKE is a direct solver: sparse LU's solution to 1e-10 for 1 to 64 partitions") {
  for (const auto& [n, half] : {std::pair<Index, Index>{400, 3}, {1500, 11}, {701, 0}, {333, 1}, {2600, 20}})
    for (const double dominance : {1.01, 1.3}) {
      const BandedMatrix<double> a = random_band(unsigned(n + half), n, half, dominance);
      const VectorXd b = right_side(n), reference = direct(to_sparse(a), b);
      for (const int partitions : {1, 2, 3, 4, 7, 16, 33, 64}) {
        const Spike<double> spike(a, {partitions, SpikeKind::full});
        INFO("n " << n << " half " << half << " partitions " << partitions << " dominance " << dominance);
        if (half > 0) CHECK(spike.partitions() == std::min<Index>(partitions, n / (2 * half)));
        CHECK(spike.boosted() == 0);
        VectorXd x = b;
        spike.solve(x);
        CHECK(off(x, reference) < 1e-10);
      }
    }
}

TEST_CASE("truncated SPIKE and factors in float reach 1e-10 by refinement in double") {
  const BandedMatrix<double> a = random_band(9, 3000, 8, 1.2);
  const VectorXd b = right_side(3000), reference = direct(to_sparse(a), b);
  for (const int partitions : {2, 8, 64}) {
    const Refined truncated = refine(a, Spike<double>(a, {partitions, SpikeKind::truncated}), b, 1e-13);
    const Refined in_float = refine(a, Spike<float>(a, {partitions, SpikeKind::full}), b, 1e-13);
    const Refined both = refine(a, Spike<float>(a, {partitions, SpikeKind::truncated}), b, 1e-13);
    for (const Refined& x : {truncated, in_float, both}) {
      INFO("partitions " << partitions << " iterations " << x.iterations);
      CHECK(off(x.x, reference) < 1e-10);
      CHECK(x.iterations >= 1);
      CHECK(x.iterations <= 12);
    }
    VectorXd once = b;
    Spike<double>(a, {partitions, SpikeKind::truncated}).solve(once);
    CHECK(off(once, reference) > 1e-16);  // the truncation is one
  }
}

TEST_CASE("the bits of SPIKE depend on the partitions, not on threads") {
  const BandedMatrix<double> a = random_band(4, 2000, 7, 1.1);
  const int threads = omp_get_max_threads();
  std::vector<VectorXd> found;
  for (const int count : {1, 2, 7}) {
    omp_set_num_threads(count);
    found.push_back(right_side(2000));
    Spike<double>(a, {16, SpikeKind::full}).solve(found.back());
  }
  omp_set_num_threads(threads);
  CHECK(found[0] == found[1]);
  CHECK(found[0] == found[2]);
}

TEST_CASE("reverse Cuthill-McKee finds the band of a shuffled chain and of a shuffled grid") {
  const int side = 12, n = side * side;
  std::vector<int> shuffled(n);
  std::iota(shuffled.begin(), shuffled.end(), 0);
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(3));
  for (const bool is_grid : {false, true}) {
    std::vector<Eigen::Triplet<double>> entry;
    const auto link = [&](int i, int j) {
      entry.emplace_back(shuffled[i], shuffled[j], -1);
      entry.emplace_back(shuffled[j], shuffled[i], -1);
    };
    for (int i = 0; i < n; ++i) {
      entry.emplace_back(shuffled[i], shuffled[i], 5);
      if ((!is_grid || i % side + 1 < side) && i + 1 < n) link(i, i + 1);
      if (is_grid && i + side < n) link(i, i + side);
    }
    Sparse a(n, n);
    a.setFromTriplets(entry.begin(), entry.end());
    const std::vector<Index> order = reverse_cuthill_mckee(a);
    std::vector<Index> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (Index k = 0; k < n; ++k) REQUIRE(sorted[std::size_t(k)] == k);
    const Band band = to_band(a, order, n);
    CHECK(band.full_half <= (is_grid ? side + 1 : 1));
    CHECK(band.dropped == 0);
    const Band cut = to_band(a, order, is_grid ? 3 : 0);
    CHECK(cut.dropped > 0);
    CHECK(cut.matrix.half < band.matrix.half);
  }
}

TEST_CASE("BiCGStab with SPIKE takes fewer iterations than without and finds sparse LU's solution") {
  const BandedMatrix<double> band = random_band(12, 1200, 6, 1.02);
  const Sparse a = to_sparse(band);
  const VectorXd b = right_side(1200), reference = direct(a, b);
  PreconditionerSettings settings;
  settings.most_half = 4;  // a part of the band is dropped
  PreconditionedKrylov with(settings);
  settings.is_used = false;
  PreconditionedKrylov without(settings);
  VectorXd x;
  with.factorise(a);
  CHECK(with.solve(b, x));
  CHECK(off(x, reference) < 1e-7);
  without.factorise(a);
  CHECK(without.solve(b, x));
  CHECK(off(x, reference) < 1e-7);
  CHECK(with.work().dropped > 0);
  CHECK(with.work().bytes > 0);
  CHECK(2 * with.work().inner_iterations < without.work().inner_iterations);
}
