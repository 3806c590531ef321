// Factors of bands in both directions, against their product and against dense solutions.
#include "sim/local_problem/banded/band_factors.h"

#include <Eigen/LU>
#include <limits>

#include "tests/sim/local_problem/random_band.h"
#include "tests/support/catch.h"

using namespace gonogo::sim;
using Eigen::Index;

namespace {

template <class Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Entries of the band in the order of the walk.
template <class Walk>
Eigen::MatrixXd dense(const Walk& walk) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(walk.size, walk.size);
  for (Index i = 0; i < walk.size; ++i)
    for (Index j = std::max<Index>(0, i - walk.half); j <= std::min(walk.size - 1, i + walk.half); ++j)
      out(i, j) = double(walk.at(i, j));
  return out;
}

/// L U of the factors.
template <class Walk>
Eigen::MatrixXd product_of(const Walk& lu) {
  const Eigen::MatrixXd factors = dense(lu);
  Eigen::MatrixXd l = factors.triangularView<Eigen::StrictlyLower>(), u = factors.triangularView<Eigen::Upper>();
  l.diagonal().setOnes();
  u.diagonal() = u.diagonal().cwiseInverse().eval();
  return l * u;
}

template <class Scalar, int Direction>
void check(const BandWalk<Scalar, Direction>& walk, double tolerance) {
  const Eigen::MatrixXd a = dense(walk);
  CHECK(factorise_band(walk, std::numeric_limits<Scalar>::min()) == 0);
  CHECK((product_of(walk) - a).norm() <= tolerance * a.norm());
  const BandWalk<const Scalar, Direction> lu{walk.origin, walk.size, walk.half};
  const Index n = walk.size, columns = walk.half + 2;
  Matrix<Scalar> b(n, columns);
  for (Index i = 0; i < b.size(); ++i) b.data()[i] = Scalar(std::sin(1.3 * double(i + 1)));
  const Eigen::MatrixXd expected = a.partialPivLu().solve(b.template cast<double>());
  Matrix<Scalar> x = b;
  sweep_rows_forward(lu, x.data(), columns, 0);
  sweep_rows_backward(lu, x.data(), columns);
  CHECK((x.template cast<double>() - expected).norm() <= tolerance * expected.norm());
  // One column, whose entries have the walk's direction in memory.
  std::vector<Scalar> one(std::size_t(n), 0);
  Scalar* const first = Direction > 0 ? one.data() : one.data() + n - 1;
  for (Index i = 0; i < n; ++i) first[Direction * i] = b(i, 0);
  sweep_forward(lu, first);
  sweep_backward(lu, first);
  double off = 0;
  for (Index i = 0; i < n; ++i) off = std::max(off, std::abs(double(first[Direction * i]) - expected(i, 0)));
  CHECK(off <= tolerance * expected.col(0).cwiseAbs().maxCoeff());
}

template <class Scalar>
void check_both(Index n, Index half, double tolerance) {
  const BandedMatrix<double> a = random_band(unsigned(17 * n + half), n, half, 1.1);
  std::vector<Scalar> down(a.value.begin(), a.value.end()), up = down;
  INFO("n " << n << " half " << half);
  check(walk_down(down.data(), n, half), tolerance);
  check(walk_up(up.data(), n, half), tolerance);
}

}  // namespace

TEST_CASE("factors of a band multiply to it and solve, down and up, in double and float") {
  for (const Index half : {0, 1, 2, 3, 4, 5, 7, 8, 9, 12, 13, 16, 17, 31, 50})
    for (const Index n : {1, 2, 3, 4, 5, 7, 8, 30, 61, 120}) {
      check_both<double>(n, half, 1e-13);
      check_both<float>(n, half, 1e-5);
    }
}

TEST_CASE("pivots below the least are lifted and counted") {
  for (const Index half : {1, 6}) {
    BandedMatrix<double> a = random_band(3, 40, half, 1.5);
    for (Index j = std::max<Index>(0, 20 - half); j <= 20 + half; ++j) a.at(20, j) = a.at(j, 20) = 0;
    a.at(0, 0) = -1e-9;
    for (Index j = 1; j <= half; ++j) a.at(0, j) = a.at(j, 0) = 0;
    CHECK(factorise_band(walk_down(a.value.data(), 40, half), 1e-6) == 2);
    CHECK(a.at(20, 20) == Approx(1e6));  // reciprocals
    CHECK(a.at(0, 0) == Approx(-1e6));
  }
}
