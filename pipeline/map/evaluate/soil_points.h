// What one soil may be: points over the variables of the contract, those that trials sampled and that are not too soft
// kept for the model and the others counted.
#pragma once
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/evaluate/soft_soil.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::map {

/// Room for the last digit of a range that went through a file.
bool contains(Range sampled, double value);

class SoilPoints {
 public:
  /// `points` are those of soil_points(): equally likely, slopes not-a-number; `soft` those of soft_points().
  SoilPoints(const OutcomeModel& model, std::vector<std::vector<double>> points, SoftPoints soft = {});

  /// Mean over the sampled points at these slopes [deg]; slopes outside the sampled box give a prospect without any.
  Prospect at(const OutcomeModel& model, double slope_along, double slope_across) const;
  /// The same, and P(go) of every sampled point by the model and then by each of its members.
  Prospect at(const OutcomeModel& model, double slope_along, double slope_across,
              std::vector<double>& p_go_of_each) const;
  /// Mean of the model's novelty over all points.
  double novelty(const OutcomeModel& model, double slope_along, double slope_across) const;

  std::size_t sampled_count() const { return inside_count_; }
  /// Share of the points that are too soft, sampled or not.
  double soft_share() const { return soft_share_; }
  /// Why nothing is said about slopes outside the sampled box.
  campaign::Reason reason_outside() const;
  /// Every point, sampled or not.
  const std::vector<std::vector<double>>& all() const { return all_; }
  /// "cohesion 6.1 kPa is outside 0 to 5 kPa" for each variable that keeps points of this soil out.
  const std::vector<std::string>& outside_because() const { return outside_because_; }
  const std::vector<std::string>& soft_because() const { return soft_.because; }

 private:
  using Probabilities = std::function<void(std::span<const double>, std::span<double>)>;
  std::vector<double> answers(const Probabilities& model, double slope_along, double slope_across) const;
  Prospect nothing_known() const;
  bool is_sampled(const OutcomeModel& model, double slope_along, double slope_across) const;
  Prospect mean_of(const std::vector<double>& answers) const;
  void add_p_go(const std::vector<double>& answers, std::vector<double>& p_go) const;

  std::vector<std::vector<double>> all_;
  std::vector<double> inside_;  // [inside_count_ x variables]
  std::size_t inside_count_ = 0;
  SoftPoints soft_;
  double soft_share_ = 0;
  std::vector<std::string> outside_because_;
};

}  // namespace gonogo::map
