// What one soil may be, as equally likely points over the variables of the contract, and the model's mean answer.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"
#include "pipeline/map/region/region.h"
#include "pipeline/map/region/rules.h"

namespace gonogo::map {

/// A soil without a texture counts as fine-grained below this friction angle. No sand in configs/soils has a
/// smaller one.
inline constexpr double kMinAngleOfSand = 20;  // [deg]
/// Fine-grained soil that is too weak for a vehicle. The grains of a trial hold no pore water, so trials say nothing
/// reliable about soft wet clay. A point of a soil is soft if its cone index is below the vehicle's VCI50. It is also
/// soft if either of the two is not known.
struct SoftPoints {
  std::vector<char> is_soft;         // [points] 1: soft; empty: none is
  std::vector<std::string> because;  // one sentence per cause, for the map's remarks
};

/// Which of the `points` from soil_points() are too soft. The cone index of a point is measured on its sample, or else
/// estimated from cohesion and friction angle (terrain/soil/soil.h).
SoftPoints soft_points(const Region& region, const Soil& soil, const std::vector<std::vector<double>>& points,
                       const std::optional<ConeIndexNeed>& need);

/// All points of a soil whose cone index was measured below the vehicle's VCI50.
SoftPoints measured_soft(std::size_t points, const ConeIndexNeed& need);

/// Number of the alternative that each of the soil's points belongs to, [points] from soil_points(); empty if all
/// belong to one.
std::vector<int> point_alternatives(const Soil& soil, std::size_t points);

/// Whether a texture of the soil's samples, the soil or the region is. Nothing if none of them gives one.
std::optional<bool> is_fine_grained(const Region& region, const Soil& soil);

/// Whether `value` lies in `sampled`, with a tolerance for ranges that were rounded in a file.
bool contains(Range sampled, double value);

/// Where the own answer of every point of a soil is asked for, and of whom.
struct EachOf {
  std::size_t stride = 1;  // at every k-th slope in both directions
  bool members = true;     // the model's members, too; only with stride 1
};

/// What one soil may be, as equally likely points over the variables of the contract, and the model's mean answer.
/// SoilPoints::at() is where P(go) of a cell is computed: the mean of the model over these points.
/// Points outside the sampled box and points that are too soft count as not answered. Stronger soil is no harder to
/// drive on. So a cohesion or friction angle above what was sampled counts as the largest that was, which is on the
/// safe side. And P(go) of a point that is too soft, or weaker than what was sampled, is at most the model's at the
/// same strength raised to the least that was sampled; at the greatest, where the strength is not known. Such a point
/// is bounded. A point outside in other variables is not.
class SoilPoints {
 public:
  /// `points`: from soil_points(), equally likely, slopes NaN. `soft`: from soft_points() for the same points.
  /// `alternative`: from point_alternatives().
  SoilPoints(const OutcomeModel& model, std::vector<std::vector<double>> points, SoftPoints soft = {},
             std::vector<int> alternative = {});

  /// P(go) of every point, by the model and then by each of its members.
  struct Each {
    std::vector<double> sampled;  // [(1 + members) x sampled points]
    std::vector<double> most;     // [(1 + members) x bounded points] the most that it may be
  };
  /// Mean outcome probabilities over the sampled points at these slopes [deg]; Prospect::p_go() is P(go). For slopes
  /// outside the sampled box outside_share is 1, every probability 0, and `each` empty.
  Prospect at(const OutcomeModel& model, double slope_along, double slope_across) const;
  /// The same at every pair of slopes, [along][across]; `each` in that order, at every k-th slope.
  std::vector<Prospect> on_slopes(const OutcomeModel& model, std::span<const double> along,
                                  std::span<const double> across, std::vector<Each>* each = nullptr,
                                  EachOf of = {}) const;
  /// Whether at() asks the model at these slopes [deg].
  bool is_asked(double slope_along, double slope_across) const;
  /// Mean of the model's novelty over all points, sampled or not, straight uphill at slopes that rise [deg]. Of more
  /// than 32 points over every k-th, 16 to 32 of them. The model must have one.
  std::vector<double> novelty_uphill(const OutcomeModel& model, std::span<const double> slopes) const;

  std::size_t sampled_count() const { return inside_.count; }
  std::size_t bounded_count() const { return bounded_.count; }
  /// Whether cells of this soil may differ though every point was sampled.
  bool has_alternatives() const { return alternatives_ > 1; }
  /// The points that are put to the model, row by row [sampled_count x variables]; slopes are NaN.
  std::span<const double> sampled() const { return inside_.value; }
  /// Share of the points that are too soft, sampled or not.
  double soft_share() const { return soft_share_; }
  /// Reason of an unknown cell whose slopes lie outside the sampled box.
  campaign::Reason reason_outside() const;
  /// Every point, sampled or not; strengths above what was sampled as they count.
  const std::vector<std::vector<double>>& all() const { return all_; }
  /// "cohesion 6.1 kPa is outside 0 to 5 kPa", one for each variable that puts points outside the sampled box. Several
  /// values are "cohesion 6.1 to 9 kPa ..., 20 % of its points".
  const std::vector<std::string>& outside_because() const { return outside_because_; }
  /// "cohesion 15.2 to 68 kPa counts as 15 kPa, the most that was sampled, 83 % of its points".
  const std::vector<std::string>& stronger_because() const { return stronger_because_; }
  /// Share of the points whose value of this variable lies outside what was sampled.
  double outside_share(std::size_t variable) const { return outside_share_[variable]; }
  const std::vector<std::string>& soft_because() const { return soft_.because; }

 private:
  using Probabilities = std::function<void(std::span<const double>, std::span<double>)>;
  /// Points that are put to the model.
  struct Asked {
    std::vector<double> value;        // [count x variables], slopes NaN
    std::vector<std::size_t> origin;  // [count] in all_
    std::size_t count = 0;
    void add(const std::vector<double>& point, std::size_t index);
  };
  struct SlopeSums;  // soil_points.cpp
  class EachAt;
  Prospect prospect_of(const SlopeSums& sums) const;
  /// Appends what the model's members answer at every pair of slopes.
  void add_members(const OutcomeModel& model, std::span<const double> along, std::span<const double> across,
                   std::vector<Each>& each) const;
  void limit_strength();
  void divide();
  bool is_outside(const std::vector<double>& point) const;
  /// The point with its strength raised to what was sampled.
  std::vector<double> raised(std::vector<double> point) const;
  void find_outside();
  Prospect nothing_known() const;

  std::vector<Range> box_;  // [variables] of the trials that answer for these points
  std::vector<std::vector<double>> all_;
  Asked inside_, bounded_;
  std::vector<int> alternative_;  // [points]
  std::size_t alternatives_ = 1;
  SoftPoints soft_;
  double soft_share_ = 0;
  std::vector<std::string> outside_because_, stronger_because_;
  std::vector<double> outside_share_;  // [variables]
};

}  // namespace gonogo::map
