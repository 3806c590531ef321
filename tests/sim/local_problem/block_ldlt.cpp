// Factors by fronts against dense solutions.
#include "sim/local_problem/algebra/block_ldlt.h"

#include <Eigen/Dense>
#include <random>

#include "tests/support/catch.h"

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

/// Symmetric and diagonally dominant, with dense blocks: a chain, `links` random pairs, and a first contact that
/// touches `clique` others, which touch each other.
MatrixXd random_blocks(std::mt19937& random, Index contacts, Index size, int links, Index clique) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::uniform_int_distribution<Index> any(0, contacts - 1);
  MatrixXd a = MatrixXd::Zero(contacts * size, contacts * size);
  const auto link = [&](Index i, Index j) {
    for (Index r = 0; r < size; ++r)
      for (Index c = 0; c < size; ++c) a(i * size + r, j * size + c) = uniform(random);
    a.block(j * size, i * size, size, size) = a.block(i * size, j * size, size, size).transpose().eval();
  };
  for (Index i = 0; i + 1 < contacts; ++i) link(i, i + 1);
  for (int k = 0; k < links; ++k)
    if (const Index i = any(random), j = any(random); i != j) link(i, j);
  for (Index i = 0; i < clique; ++i)
    for (Index j = 0; j < i; ++j) link(i, j);
  for (Index i = 0; i < contacts; ++i) link(i, i);
  a = (0.5 * (a + a.transpose())).eval();
  const VectorXd sums = a.cwiseAbs().rowwise().sum();
  a.diagonal() += sums + VectorXd::Constant(a.rows(), 0.1);
  return a;
}

Sparse diagonal_blocks_of(const MatrixXd& a, Index size) {
  Sparse out(a.rows(), a.rows());
  for (Index i = 0; i < a.rows(); ++i)
    for (Index j = i / size * size; j < (i / size + 1) * size; ++j) out.insert(i, j) = 0.3 * a(i, j);
  return out;
}

VectorXd right_side(Index n) {
  VectorXd b(n);
  for (Index i = 0; i < n; ++i) b[i] = std::sin(1.7 * double(i + 1));
  return b;
}

}  // namespace

TEST_CASE("factors by fronts solve random block matrices as dense ones do") {
  std::mt19937 random(4);
  for (const Index size : {1, 2, 3, 5})
    for (const auto& [contacts, links, clique] : {std::tuple<Index, int, Index>{1, 0, 0},
                                                  {2, 0, 0},
                                                  {9, 3, 0},
                                                  {40, 0, 0},
                                                  {60, 70, 0},
                                                  {90, 20, 25},
                                                  {130, 40, 90}}) {
      INFO("size " << size << " contacts " << contacts << " links " << links << " clique " << clique);
      const MatrixXd a = random_blocks(random, contacts, size, links, clique);
      const Sparse blocks = diagonal_blocks_of(a, size);
      BlockLdlt factors(size);
      for (const double scale : {1.0, 1e4}) {  // the second time in the same pattern
        REQUIRE(factors.factorise(Sparse(a.sparseView()), Sparse(scale * blocks)));
        const VectorXd b = right_side(a.rows());
        VectorXd x = b;
        factors.solve(x);
        const VectorXd expected = (a + scale * MatrixXd(blocks)).ldlt().solve(b);
        CHECK((x - expected).norm() < 1e-12 * expected.norm());
      }
      CHECK(factors.bytes() >= std::size_t(a.rows()) * sizeof(double));
    }
}

TEST_CASE("factors by fronts take a new pattern, negative pivots, and refuse a pivot of 0") {
  std::mt19937 random(5);
  BlockLdlt factors(3);
  for (const int links : {5, 30}) {
    MatrixXd a = -random_blocks(random, 30, 3, links, 4);
    REQUIRE(factors.factorise(Sparse(a.sparseView()), Sparse(a.rows(), a.rows())));
    const VectorXd b = right_side(a.rows()), expected = a.partialPivLu().solve(b);
    VectorXd x = b;
    factors.solve(x);
    CHECK((x - expected).norm() < 1e-12 * expected.norm());
    a.row(7).setZero();
    a.col(7).setZero();
    CHECK(!factors.factorise(Sparse(a.sparseView()), Sparse(a.rows(), a.rows())));
  }
}

TEST_CASE("multiply-adds of factors are those of a dense matrix, and of a chain") {
  std::mt19937 random(8);
  const auto counted = [&](Index contacts, Index clique) {
    const MatrixXd a = random_blocks(random, contacts, 3, 0, clique);
    BlockLdlt factors(3);
    REQUIRE(factors.factorise(Sparse(a.sparseView()), Sparse(a.rows(), a.rows())));
    return factors.multiply_adds();
  };
  const auto dense = [](int n) {
    double sum = 0;  // n^3 / 6 and less
    for (int k = 0; k < n; ++k)
      for (int j = k + 1; j < n; ++j) sum += j - k;
    return sum;
  };
  CHECK(counted(20, 20) == dense(60));
  // A chain leaves one block below each but the last. Groups of columns may keep zeros, far fewer than a dense matrix.
  const double chain = counted(200, 0);
  CHECK(chain >= 199 * (15 + 10 + 6) + dense(3));
  CHECK(chain < 1e-3 * dense(600));
}

TEST_CASE("the pattern of factors covers their fill, and its groups follow each other") {
  std::mt19937 random(6);
  for (int trial = 0; trial < 10; ++trial) {
    const MatrixXd a = random_blocks(random, 50, 1, 10 * trial, trial);
    const FactorPattern pattern = factor_pattern(Sparse(a.sparseView()));
    MatrixXd permuted(50, 50);
    for (Index i = 0; i < 50; ++i)
      for (Index j = 0; j < 50; ++j) permuted(i, j) = a(pattern.order[std::size_t(i)], pattern.order[std::size_t(j)]);
    const MatrixXd l = permuted.llt().matrixL();
    Index next = 0, zeros = 0;
    for (const ColumnGroup& g : pattern.group) {
      CHECK(g.first == next);
      next += g.width;
      CHECK(std::is_sorted(g.row.begin(), g.row.end()));
      for (Index j = g.first; j < next; ++j)
        for (Index i = j + 1; i < 50; ++i) {
          const bool kept = i < next || std::binary_search(g.row.begin(), g.row.end(), i);
          if (!kept) CHECK(l(i, j) == 0);
          zeros += kept && l(i, j) == 0;
        }
    }
    CHECK(next == 50);
    Index filled = 0;
    for (const ColumnGroup& g : pattern.group) filled += g.filled;
    CHECK(zeros == filled);
  }
}

TEST_CASE("a front leaves the Schur complement of its first columns") {
  std::mt19937 random(7);
  for (const auto& [rows, count] :
       {std::pair<Index, Index>{1, 1}, {6, 3}, {7, 7}, {33, 10}, {191, 50}, {300, 129}, {260, 260}}) {
    INFO("rows " << rows << " count " << count);
    const MatrixXd a = random_blocks(random, rows, 1, 3 * int(rows), std::min<Index>(rows, 20));
    const Index step = (rows + 3) / 4 * 4;
    std::vector<double> f(std::size_t(rows * step), 0.0), inverse(std::size_t(count), 0.0);
    for (Index j = 0; j < rows; ++j)
      for (Index i = j; i < rows; ++i) f[std::size_t(j * step + i)] = a(i, j);
    REQUIRE(eliminate(f.data(), rows, step, count, inverse.data()));
    if (const Index rest = rows - count; rest > 0) {
      const MatrixXd schur =
          a.bottomRightCorner(rest, rest) -
          a.bottomLeftCorner(rest, count) * a.topLeftCorner(count, count).ldlt().solve(a.topRightCorner(count, rest));
      double off = 0;
      for (Index j = 0; j < rest; ++j)
        for (Index i = j; i < rest; ++i)
          off = std::max(off, std::abs(schur(i, j) - f[std::size_t((count + j) * step + count + i)]));
      CHECK(off < 1e-12 * a.cwiseAbs().maxCoeff());
    }
    const Index few = std::min<Index>(count, 5);
    const double product = Eigen::Map<VectorXd>(inverse.data(), few).prod();
    const double expected = a.topLeftCorner(few, few).determinant();
    CHECK(product * expected == Approx(1));
  }
}
