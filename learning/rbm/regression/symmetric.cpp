#include "learning/rbm/regression/symmetric.h"

namespace gonogo::learning {
namespace {

/// Eigen divides a product's sums by the number of its threads, and never runs threads of its own once this is set.
const bool kOneThread = [] {
  Eigen::setNbThreads(1);
  return true;
}();

template <class T>
using View = Eigen::Map<Matrix<T>, 0, Eigen::OuterStride<>>;

/// A square matrix and its quarters on and below the diagonal.
template <class T>
struct Quarters {
  View<T> first, second, below;
  explicit Quarters(View<T>& whole)
      : first(quarter(whole, 0, 0)), second(quarter(whole, 1, 1)), below(quarter(whole, 1, 0)) {}

 private:
  static View<T> quarter(View<T>& whole, Eigen::Index down, Eigen::Index right) {
    const Eigen::Index size = whole.rows(), half = (size / 2 + 7) / 8 * 8;  // whole registers
    return View<T>(whole.data() + down * half + right * half * whole.outerStride(), down ? size - half : half,
                   right ? size - half : half, Eigen::OuterStride<>(whole.outerStride()));
  }
};

constexpr Eigen::Index kSmall =
    32;  // rows of a block that is not divided again; more than what a quarter is rounded by

/// Overwrites a lower triangle L with L^-1.
template <class T>
void invert_triangle(View<T> L) {
  if (L.rows() <= kSmall) {
    Matrix<T> inverse = Matrix<T>::Identity(L.rows(), L.rows());
    L.template triangularView<Eigen::Lower>().solveInPlace(inverse);
    L.template triangularView<Eigen::Lower>() = inverse;
    return;
  }
  Quarters<T> part(L);
  part.second.template triangularView<Eigen::Lower>().solveInPlace(part.below);
  part.first.template triangularView<Eigen::Lower>().template solveInPlace<Eigen::OnTheRight>(part.below);
  part.below = -part.below;
  invert_triangle<T>(part.first);
  invert_triangle<T>(part.second);
}

/// Overwrites a lower triangle L with that of L' L.
template <class T>
void square_triangle(View<T> L) {
  if (L.rows() <= kSmall) {
    const Matrix<T> triangle = L.template triangularView<Eigen::Lower>();
    const Matrix<T> square = triangle.transpose() * triangle;
    L.template triangularView<Eigen::Lower>() = square;
    return;
  }
  Quarters<T> part(L);
  square_triangle<T>(part.first);
  part.first.template selfadjointView<Eigen::Lower>().rankUpdate(part.below.transpose());
  part.below = (part.second.template triangularView<Eigen::Lower>().transpose() * part.below).eval();
  square_triangle<T>(part.second);
}

}  // namespace

template <class T>
bool factorise(Matrix<T>& matrix) {
  return Eigen::LLT<Eigen::Ref<Matrix<T>>>(matrix).info() == Eigen::Success;
}

template <class T>
void invert_factored(Matrix<T>& factor) {
  const View<T> whole(factor.data(), factor.rows(), factor.cols(), Eigen::OuterStride<>(factor.outerStride()));
  invert_triangle<T>(whole);
  square_triangle<T>(whole);
}

template bool factorise(Matrix<float>&);
template bool factorise(Matrix<double>&);
template void invert_factored(Matrix<float>&);
template void invert_factored(Matrix<double>&);

}  // namespace gonogo::learning
