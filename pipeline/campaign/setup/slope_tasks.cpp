// Trials on a slope of the settled bed: up or down it, and along its contour.
#include <cmath>

#include "pipeline/campaign/setup/task.h"

namespace gonogo::campaign {
namespace {

class Climb final : public TrialTask {
 public:
  std::string name() const override { return "climb"; }
};

/// Along the contour of a slope: the vehicle must not slide down it by more than a share of its length.
class SideSlope final : public TrialTask {
 public:
  explicit SideSlope(const TaskNumbers& n) : share_(n["slide_vehicle_lengths"]) {}
  std::string name() const override { return "side_slope"; }
  std::pair<Verdict, Reason> judge(const DriveEnd& end) const override {
    const bool first = end.reason == Reason::rollover || end.reason == Reason::slope_unstable;
    if (!first && std::fabs(end.drift) > share_ * end.vehicle_length) return {Verdict::no_go, Reason::slid_back};
    return {end.verdict, end.reason};
  }

 private:
  double share_;
};

}  // namespace

const TaskType& climb_type() {
  static constexpr TaskType type{"climb", "climb", {}, make_task<Climb>};
  return type;
}

const TaskType& side_slope_type() {
  static constexpr TaskParameter numbers[] = {{"slide_vehicle_lengths", {0.01, 10}, 0.25}};
  static constexpr TaskType type{"side_slope", "side_slope", numbers, make_task<SideSlope>};
  return type;
}

std::shared_ptr<const TrialTask> default_task() { return std::make_shared<const Climb>(); }

}  // namespace gonogo::campaign
