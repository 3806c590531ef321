// Numbers with their derivatives by N variables: forward differentiation, exact to round-off.
// Contact forces are written once on Dual; their consistent tangent follows without a second formula.
#pragma once
#include <array>
#include <cmath>

namespace gonogo::sim::elastic {

template <int N>
struct Dual {
  double value = 0;
  std::array<double, N> slope{};  // derivative by each variable

  Dual() = default;
  Dual(double v) : value(v) {}  // a constant; implicit, as in every formula

  static Dual variable(double v, int index) {
    Dual x(v);
    x.slope[std::size_t(index)] = 1;
    return x;
  }
  Dual& operator+=(const Dual& o) {
    value += o.value;
    for (int i = 0; i < N; ++i) slope[i] += o.slope[i];
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    value -= o.value;
    for (int i = 0; i < N; ++i) slope[i] -= o.slope[i];
    return *this;
  }
  Dual& operator*=(const Dual& o) {
    for (int i = 0; i < N; ++i) slope[i] = slope[i] * o.value + value * o.slope[i];
    value *= o.value;
    return *this;
  }
  Dual& operator/=(const Dual& o) {
    value /= o.value;
    for (int i = 0; i < N; ++i) slope[i] = (slope[i] - value * o.slope[i]) / o.value;
    return *this;
  }
  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator*(Dual a, const Dual& b) { return a *= b; }
  friend Dual operator/(Dual a, const Dual& b) { return a /= b; }
  friend Dual operator-(Dual a) { return a *= Dual(-1); }
};

inline double value_of(double x) { return x; }
template <int N>
double value_of(const Dual<N>& x) {
  return x.value;
}

inline double root(double x) { return std::sqrt(x); }
/// Only above 0.
template <int N>
Dual<N> root(Dual<N> x) {
  x.value = std::sqrt(x.value);
  for (double& s : x.slope) s /= 2 * x.value;
  return x;
}

/// Angle of the direction (x, y) from the x axis, in (-pi, pi]. Not at the origin.
inline double angle(double y, double x) { return std::atan2(y, x); }
template <int N>
Dual<N> angle(const Dual<N>& y, const Dual<N>& x) {
  Dual<N> a(std::atan2(y.value, x.value));
  const double square = x.value * x.value + y.value * y.value;
  for (int i = 0; i < N; ++i) a.slope[i] = (x.value * y.slope[i] - y.value * x.slope[i]) / square;
  return a;
}

inline double power(double x, double exponent) { return std::pow(x, exponent); }
/// Only above 0.
template <int N>
Dual<N> power(Dual<N> x, double exponent) {
  const double slope = exponent * std::pow(x.value, exponent - 1);
  x.value = std::pow(x.value, exponent);
  for (double& s : x.slope) s *= slope;
  return x;
}

}  // namespace gonogo::sim::elastic
