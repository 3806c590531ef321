// Performance profiles (Dolan & More 2002): the share of problems that a solver ends within a factor tau of the
// fastest.
#pragma once
#include <vector>

namespace gonogo::lab {

struct Profile {
  std::vector<double> tau;                 // increasing, from 1
  std::vector<std::vector<double>> share;  // rho [solver][tau], 0 .. 1
};

/// cost: [solver][problem], positive, infinite where the solver failed. A problem that no solver ends counts as failed
/// for all. tau: the ratios that occur.
Profile performance_profile(const std::vector<std::vector<double>>& cost);

}  // namespace gonogo::lab
