// A model whose probabilities are known in closed form, for tests of what maps do with them.
#pragma once
#include <cmath>
#include <limits>

#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/evaluate/outcome_model.h"

namespace gonogo::test {

struct AnalyticModel {
  double width_deg = 3;       // of the passage from go to no_go
  double unknown_limit = 25;  // slope [deg] that is passed half the time when the friction angle is unknown
  double slow_share = 0.2;    // of P(go)
  double weaker_deg = 0;      // takes this off every limit
  double steep_deg = 20;      // from here on no_go is slid_back, below traction

  /// Half of the trials pass where the slope equals the friction angle plus cohesion in kPa.
  double p_go(double slope, double friction_angle, double cohesion) const {
    double limit = unknown_limit;
    if (!std::isnan(friction_angle)) limit = friction_angle + (std::isnan(cohesion) ? 0 : cohesion);
    return 1 / (1 + std::exp((slope - limit + weaker_deg) / width_deg));
  }

  map::OutcomeModel outcome_model() const {
    using namespace campaign;
    using namespace map;
    const Contract& c = contract();
    OutcomeModel model;
    for (const Variable& v : c.variables)  // a model of one vehicle has no numbers of a family
      model.sampled.push_back(v.prior == "family" ? Range{0, 0} : Range{v.minimum, v.maximum});
    model.sampled[c.variable_index("slope_along")] = {0, 35};
    model.sampled[c.variable_index("slope_across")] = {0, 0};
    model.hash = "analytic";
    model.cone_index = ConeIndexNeed{"a vehicle that every soil carries", 0, 0};
    model.probabilities = [*this, &c](std::span<const double> points, std::span<double> result) {
      const std::size_t variables = c.variables.size(), outcomes = c.outcomes.size();
      const std::size_t go = c.outcome_index(Verdict::go, Reason::none),
                        slow = c.outcome_index(Verdict::slow_go, Reason::none);
      const std::size_t slid = c.outcome_index(Verdict::no_go, Reason::slid_back);
      const std::size_t traction = c.outcome_index(Verdict::no_go, Reason::traction);
      for (std::size_t i = 0; i * variables < points.size(); ++i) {
        const double* point = &points[i * variables];
        const double slope = point[c.variable_index("slope_along")];
        const double p = p_go(slope, point[c.variable_index("friction_angle")], point[c.variable_index("cohesion")]);
        for (std::size_t o = 0; o < outcomes; ++o) result[i * outcomes + o] = 0;
        result[i * outcomes + go] = p * (1 - slow_share);
        result[i * outcomes + slow] = p * slow_share;
        result[i * outcomes + (slope < steep_deg ? traction : slid)] = 1 - p;
      }
    };
    return model;
  }
};

}  // namespace gonogo::test
