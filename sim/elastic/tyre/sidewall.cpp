#include "sim/elastic/tyre/sidewall.h"

#include <algorithm>
#include <cmath>

namespace gonogo::sim::elastic {
namespace {

constexpr double kLeastAngle = 0.2, kMostAngle = 3;  // half the angle of the arc [rad]

/// t with sin t / t = ratio, by Newton's method, which converges on (0, pi) from either side.
double angle_of(double ratio) {
  const double x = std::max(1 - ratio, 0.0);  // t^2 = 6 x + 9/5 x^2 + ..., from the series of the sine
  double t = std::clamp(std::sqrt(x * (6 + 1.8 * x)), kLeastAngle, 2.9);
  for (int k = 0; k < 20; ++k) {
    const double s = std::sin(t), c = std::cos(t);
    const double step = (s - ratio * t) / (c - ratio);
    t = std::clamp(t - step, kLeastAngle / 2, 3.1);
    if (std::fabs(step) < 1e-8) break;  // the next one would be its square
  }
  return t;
}

}  // namespace

Membrane::Membrane(double chord, double bulge, double pressure) : pressure_(pressure) {
  const double radius = (chord * chord / 4 + bulge * bulge) / (2 * bulge);
  length_ = 2 * radius * std::asin(std::min(chord / (2 * radius), 1.0));
}

Pull Membrane::at(double chord) const {
  const double longest = length_ * std::sin(kLeastAngle) / kLeastAngle,
               shortest = length_ * std::sin(kMostAngle) / kMostAngle;
  const double inside = std::clamp(chord, shortest, longest);
  const double t = angle_of(inside / length_), s = std::sin(t), c = std::cos(t), r = length_ / (2 * t);
  Pull pull{.force = pressure_ * r * c,
            .stiffness = pressure_ / 2 * (t * s + c) / (s - t * c),
            .energy = -pressure_ * r * r * (t - s * c)};
  const double beyond = chord - inside;
  pull.energy += pull.force * beyond + pull.stiffness * beyond * beyond / 2;
  pull.force += pull.stiffness * beyond;
  return pull;
}

}  // namespace gonogo::sim::elastic
