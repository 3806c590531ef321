// Cholesky factors and inverses of symmetric matrices, of which the lower triangle is given, on Eigen. Their bits do
// not depend on the number of threads, and any number of threads may call them at once. Only inside learning/rbm.
#pragma once
#include <Eigen/Dense>

namespace gonogo::learning {

template <class T>
using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;  // by columns
template <class T>
using Column = Eigen::Array<T, Eigen::Dynamic, 1>;

/// Overwrites the lower triangle of a matrix with its Cholesky factor. Whether the matrix is positive definite; if not,
/// the triangle holds no meaning.
template <class T>
bool factorise(Matrix<T>& matrix);

/// Overwrites a Cholesky factor with the lower triangle of the inverse of what it is the factor of.
template <class T>
void invert_factored(Matrix<T>& factor);

/// S b of a symmetric matrix, by its lower triangle.
template <class T>
Column<T> symmetric_product(const Matrix<T>& S, const Column<T>& b) {
  return (S.template selfadjointView<Eigen::Lower>() * b.matrix()).array();
}

/// (L L')^-1 b.
template <class T>
Column<T> factored_solution(const Matrix<T>& L, const Column<T>& b) {
  Eigen::Matrix<T, Eigen::Dynamic, 1> x = b.matrix();
  L.template triangularView<Eigen::Lower>().solveInPlace(x);
  L.template triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  return x.array();
}

}  // namespace gonogo::learning
