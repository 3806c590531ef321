// The elimination of a mechanism's rows: against singular values, with rows that repeat others, and by a team of
// threads.
#include <Eigen/SVD>
#include <barrier>
#include <thread>
#include <vector>

#include "sim/constraint/prepare_joints.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

using Eigen::MatrixXd;

/// What a block of the GPU is to the functions of a Team, with host threads.
class ThreadTeam {
 public:
  static constexpr bool kWholeRows = false;
  ThreadTeam(Index rank, Index size, std::barrier<>& barrier) : rank_(rank), size_(size), barrier_(&barrier) {}
  Index rank() const { return rank_; }
  Index size() const { return size_; }
  void sync() const { barrier_->arrive_and_wait(); }

 private:
  Index rank_, size_;
  std::barrier<>* barrier_;
};

/// Rows of unit length in `columns` dimensions; every fourth repeats a combination of those before it.
MatrixXd random_rows(Draw& draw, Index rows, Index columns, int& redundant) {
  MatrixXd j = MatrixXd::Zero(rows, columns);
  redundant = 0;
  for (Index i = 0; i < rows; ++i) {
    if (i % 4 == 3) {
      for (Index k = 0; k < i; ++k) j.row(i) += draw.between(-1, 1) * j.row(k);
      ++redundant;
    } else {
      const Index first = draw.below(int(columns) - 6);
      for (Index c = first; c < first + 6; ++c) j(i, c) = draw.between(-1, 1);
    }
    j.row(i).normalize();
  }
  return j;
}

struct System {
  std::vector<double> number;
  LinearSystem view() { return {number.data(), rows, stride, right}; }
  Index rows, stride, right;
};

/// [J J' | J | b] with M = 1.
System system_of(const MatrixXd& j) {
  const MatrixXd a = j * j.transpose();
  System s;
  s.rows = Index(j.rows());
  s.right = padded(s.rows);
  s.stride = s.right + padded(Index(j.cols()) + 1);
  s.number.assign(std::size_t(s.rows) * s.stride, 0);
  for (Index i = 0; i < s.rows; ++i) {
    for (Index k = i; k < s.rows; ++k) s.view().row(i)[k] = a(i, k);
    for (Index c = 0; c < j.cols(); ++c) s.view().row(i)[s.right + c] = j(i, c);
  }
  return s;
}

MatrixXd projection_of(System& s, const MatrixXd& j) {
  MatrixXd x(j.rows(), j.cols());
  for (Index i = 0; i < s.rows; ++i)
    for (Index c = 0; c < j.cols(); ++c) x(i, c) = s.view().row(i)[s.right + c] / s.view().row(i)[i];
  return MatrixXd::Identity(j.cols(), j.cols()) - j.transpose() * x;
}

}  // namespace

TEST_CASE("elimination projects onto the null space of the rows, repeated rows or not") {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Draw draw(900 + seed);
    const Index rows = 1 + draw.below(40), columns = 60;
    int redundant = 0;
    const MatrixXd j = random_rows(draw, rows, columns, redundant);
    System s = system_of(j);
    eliminate(LoneThread{}, s.view());
    const Eigen::JacobiSVD<MatrixXd> svd(j, Eigen::ComputeFullV);
    Index rank = 0;
    while (rank < svd.singularValues().size() && svd.singularValues()(rank) > 1e-6) ++rank;
    const MatrixXd null = svd.matrixV().rightCols(columns - rank);
    const double smallest = rank > 0 ? svd.singularValues()(rank - 1) : 1;
    INFO("seed " << seed << ": " << rows << " rows, rank " << rank << ", smallest singular value " << smallest);
    CHECK(rank == rows - redundant);
    CHECK((projection_of(s, j) - null * null.transpose()).cwiseAbs().maxCoeff() < 1e-13 / (smallest * smallest));
  }
}

TEST_CASE("a team of threads gives the bits of one") {
  for (const Index size : {2, 3, 7, 40, 64}) {
    Draw draw(950 + std::uint64_t(size));
    int redundant = 0;
    const MatrixXd j = random_rows(draw, 37, 60, redundant);
    System alone = system_of(j), together = alone;
    eliminate(LoneThread{}, alone.view());
    std::barrier barrier(size);
    std::vector<std::thread> threads;
    for (Index rank = 0; rank < size; ++rank)
      threads.emplace_back([&, rank] { eliminate(ThreadTeam(rank, size, barrier), together.view()); });
    for (std::thread& t : threads) t.join();
    for (Index i = 0; i < alone.rows; ++i)
      for (Index c = alone.right; c < alone.stride; ++c) REQUIRE(alone.view().row(i)[c] == together.view().row(i)[c]);
  }
}
