// How far a point lies from the trials that a model learned from.
#pragma once
#include <span>
#include <vector>

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

 private:
  static constexpr std::size_t kNone = ~std::size_t(0);
  /// `skip`: a trial that does not count.
  double nearest(std::span<const double> point, std::size_t skip) const;
  double median_of_neighbours(const learning::Model& model) const;

  struct Axis {
    std::size_t variable;
    double width;               // of the sampled range
    std::vector<double> trial;  // [trial]
  };
  std::vector<Axis> axis_;
  std::size_t trials_;
  double typical_ = 1;
};

}  // namespace gonogo::outcome
