// Trials that measure a pull: a load that grows until the vehicle stops, and a carriage that imposes a wheel's slip.
#include <algorithm>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/setup/task.h"

namespace gonogo::campaign {
namespace {

/// The pull is judged, not the way: standing is how the sweep ends.
class Drawbar final : public TrialTask {
 public:
  Drawbar(const TowPlan& tow, double needed) : tow_(tow), needed_(needed) {}
  std::string name() const override { return "drawbar"; }
  TowPlan tow() const override { return tow_; }
  std::pair<Verdict, Reason> judge(const DriveEnd& end) const override {
    if (end.reason == Reason::rollover) return {end.verdict, end.reason};
    double gripping = -1, moving = -1;
    for (const PullPoint& p : end.pull) {
      if (p.speed <= 0) continue;
      moving = std::max(moving, p.pull);
      if (p.slip <= end.go_slip) gripping = std::max(gripping, p.pull);
    }
    if (gripping > needed_) return {Verdict::go, Reason::none};
    if (moving > needed_) return {Verdict::slow_go, Reason::none};
    if (end.verdict == Verdict::no_go) return {end.verdict, end.reason};
    return {Verdict::no_go, Reason::traction};
  }

 private:
  TowPlan tow_;
  double needed_;
};

/// The carriage makes the way; what counts is whether the wheel pulls it.
class SingleWheel final : public TrialTask {
 public:
  SingleWheel(double slip, std::optional<double> angle) : slip_(slip), angle_(angle) {}
  std::string name() const override { return "single_wheel"; }
  std::optional<double> given_slip() const override { return slip_; }
  std::optional<double> slip_angle() const override { return angle_; }
  std::pair<Verdict, Reason> judge(const DriveEnd& end) const override {
    const bool pulls = !end.pull.empty() && end.pull.back().pull > 0;
    return pulls ? std::pair{Verdict::go, Reason::none} : std::pair{Verdict::no_go, Reason::traction};
  }

 private:
  double slip_;
  std::optional<double> angle_;
};

}  // namespace

const TaskType& drawbar_type() {
  static constexpr TaskParameter numbers[] = {
      {"max_pull_per_weight", {0.01, 10}, 1}, {"sweep_s", {0.1, 1000}, 8}, {"needed_pull_per_weight", {0, 10}, 0}};
  static constexpr TaskType type{"drawbar", "drawbar", numbers, [](const TaskNumbers& n) {
                                   return std::shared_ptr<const TrialTask>(std::make_shared<const Drawbar>(
                                       TowPlan{n["max_pull_per_weight"], n["sweep_s"]}, n["needed_pull_per_weight"]));
                                 }};
  return type;
}

const TaskType& single_wheel_type() {
  static constexpr TaskParameter numbers[] = {{"slip", {-0.9, 1}}, {"slip_angle_deg", {-90, 90}, {}, true}};
  static constexpr TaskType type{
      "single_wheel", "single_wheel:slip=0.2", numbers, [](const TaskNumbers& n) {
        std::optional<double> angle;
        if (const auto degrees = n.find("slip_angle_deg")) angle = to_radians(*degrees);
        return std::shared_ptr<const TrialTask>(std::make_shared<const SingleWheel>(n["slip"], angle));
      }};
  return type;
}

std::shared_ptr<const TrialTask> drawbar_task(const TowPlan& tow) { return std::make_shared<const Drawbar>(tow, 0); }

std::shared_ptr<const TrialTask> single_wheel_task(double slip, std::optional<double> slip_angle) {
  if (!(slip >= -0.9 && slip <= 1)) throw InputError(line("slip is %g; allowed is -0.9 to 1", slip));
  return std::make_shared<const SingleWheel>(slip, slip_angle);
}

}  // namespace gonogo::campaign
