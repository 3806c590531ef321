// Newton's polynomial through nested nodes, for functions whose values cost much.
#pragma once
#include <span>

namespace gonogo::learning {

/// Leja points of [0, 1]: x_0 = 0, x_1 = 1, and every other one where the product of its distances to those before is
/// largest (Leja 1957). The terms of Newton's polynomial are
///
///   h_k(t) = prod_{m < k} (t - x_m) / (x_k - x_m)
///
/// h_k is 0 at the nodes before x_k and 1 there; as x_k is where the product is largest, |h_k| <= 1 on [0, 1]. The
/// polynomial through the first n + 1 values of a function is sum_k w_k h_k. The surplus w_k is the function's value at
/// x_k less that of the polynomial through the nodes before. So no term is larger anywhere than its surplus, what a
/// polynomial leaves out is at most the sum of the surpluses that it leaves out, and a finer one needs all old nodes.
inline constexpr int kLejaCount = 14;

double leja_point(int k);

/// h_0(t), h_1(t), ... as many as asked for, kLejaCount at most.
void leja_terms(double t, std::span<double> terms);

}  // namespace gonogo::learning
