// Ticks of an axis.
#pragma once
#include <vector>

namespace gonogo::report {

/// Round numbers that cover [low, high] in about `count` steps.
std::vector<double> axis_ticks(double low, double high, int count);

/// 1, 2 or 5 times a power of ten that divides `range` into four to eight steps.
double tick_step(double range);

}  // namespace gonogo::report
