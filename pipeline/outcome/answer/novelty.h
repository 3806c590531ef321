// How far a point lies from the trials that a model learned from.
#pragma once
#include <span>
#include <vector>

#include "base/math/pack.h"
#include "learning/model/model.h"

namespace gonogo::outcome {

/// Distance of points to the nearest trial, over the variables that the trials vary and the point knows. A point
/// holds the model's variables in their order; NaN marks an unknown one.
class Novelty {
 public:
  explicit Novelty(const learning::Model& model);

  /// Root mean square over the variables in units of the sampled ranges, divided by the median over trials of the
  /// distance to the nearest trial at another point: 0 on a trial, about 1 where trials are as dense as on average.
  double of(std::span<const double> point) const;
  /// The same for many values of one variable, which rise; its value in `point` is ignored.
  void along(std::span<const double> point, std::size_t variable, std::span<const double> values,
             std::span<double> result) const;

 private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  /// A variable that the trials vary. `scaled`: values over the width of the range, in blocks of eight; rest infinite.
  struct Axis {
    std::size_t variable;
    double width;
    std::vector<Pack> scaled;
  };

  /// `skip`: a trial that does not count.
  double nearest(std::span<const double> point, std::size_t skip) const;
  std::size_t nearest_trial(std::span<const double> point, std::size_t skip) const;
  double distance(std::span<const double> point, std::size_t trial) const;
  double median_of_neighbours() const;
  std::span<const double> trial(std::size_t n) const { return std::span(points_).subspan(n * variables_, variables_); }

  std::size_t variables_, trials_;
  std::vector<double> points_;  // [trial x variable]
  std::vector<Axis> axis_;
  bool complete_ = true;  // the trials know every variable that they vary
  double typical_ = 1;
};

}  // namespace gonogo::outcome
