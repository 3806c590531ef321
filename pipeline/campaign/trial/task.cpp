#include "pipeline/campaign/trial/task.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::campaign {
namespace {

constexpr double kGap = 0.2;  // between the foremost tyre and what it has to cross [m]

class Climb final : public TrialTask {
 public:
  std::string name() const override { return "climb"; }
};

/// Along the contour of a slope: the vehicle must not slide down it by more than a share of its length.
class SideSlope final : public TrialTask {
 public:
  explicit SideSlope(const Config& c) : share_(c.number_or("slide_vehicle_lengths", 0.25, {0.01, 10})) {}
  std::string name() const override { return "side_slope"; }
  std::pair<Verdict, Reason> judge(const DriveEnd& end) const override {
    const bool first = end.reason == Reason::rollover || end.reason == Reason::slope_unstable;
    if (!first && std::fabs(end.drift) > share_ * end.vehicle_length) return {Verdict::no_go, Reason::slid_back};
    return {end.verdict, end.reason};
  }

 private:
  double share_;
};

/// The pull is judged, not the way: standing is how the sweep ends.
class Drawbar final : public TrialTask {
 public:
  explicit Drawbar(const Config& c)
      : tow_{c.number_or("max_pull_per_weight", 1, {0.01, 10}), c.number_or("sweep_s", 8, {0.1, 1000})},
        needed_(c.number_or("needed_pull_per_weight", 0, {0, 10})) {}
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
  explicit SingleWheel(const Config& c) : slip_(c.number("slip", {-0.9, 1})) {
    if (c.has("slip_angle_deg")) angle_ = to_radians(c.number("slip_angle_deg", {-90, 90}));
  }
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

/// Something across the way that has to be crossed from end to end.
class Obstacle : public TrialTask {
 public:
  double obstacle_end() const override { return kGap + length(); }
  std::pair<Verdict, Reason> judge(const DriveEnd& end) const override {
    if (end.reason == Reason::timeout && end.travelled > kGap) return {Verdict::no_go, Reason::obstacle};
    return {end.verdict, end.reason};
  }

 protected:
  virtual double length() const = 0;
  static double from(const Course& c) { return c.start + c.front + kGap; }
};

/// A rigid sill as wide as the bed that stands `height` over the undisturbed surface.
class Step final : public Obstacle {
 public:
  explicit Step(const Config& c)
      : height_(c.number("height_m", {0.005, 3})), length_(c.number_or("length_m", 1, {0.05, 20})) {}
  std::string name() const override { return "step"; }
  double length() const override { return length_; }
  double rise() const override { return height_; }

  void shape(const Course& c, terrain::Packing& bed) const override {
    std::erase_if(bed.grain, [&](const terrain::Grain& g) {
      const double reach = terrain::clump_of(bed.spec.shape, g.radius).reach;
      return beyond(from(c), g.position.x + reach, c.length) < length_ + 2 * reach;
    });
  }

  void furnish(const Course& c, sim::SceneWorld& world) const override {
    const double top = c.surface + height_;
    sim::Shape s;
    s.type = sim::ShapeType::box;
    const double x = beyond(0, from(c) + length_ / 2, c.length);
    s.body = world.add_body({{x, c.width / 2, top / 2}, {}, {}, {}}, sim::fixed_body());
    s.material = terrain::base_material;
    s.size = {Real(length_ / 2), Real(0.499 * c.width), Real(top / 2)};
    world.add_shape(s);
  }

 private:
  double height_, length_;
};

/// A trench with sloping sides down to `depth` below the surface.
class Ditch final : public Obstacle {
 public:
  explicit Ditch(const Config& c)
      : width_(c.number("width_m", {0.05, 20})),
        depth_(c.number("depth_m", {0.01, 3})),
        side_(std::tan(to_radians(c.number_or("side_deg", 30, {5, 89})))) {}
  std::string name() const override { return "ditch"; }
  double length() const override { return width_; }

  void shape(const Course& c, terrain::Packing& bed) const override {
    if (depth_ > c.surface - bed.spec.grain_diameter)
      throw InputError("a ditch of " + number_text(depth_) + " m in a bed of " + number_text(c.surface) +
                       " m leaves no grain below it; make the bed deeper");
    std::erase_if(bed.grain, [&](const terrain::Grain& g) {
      const double x = beyond(from(c), g.position.x, c.length), inside = std::min(x, width_ - x);
      return inside > 0 && g.position.z > c.surface - std::min(depth_, inside * side_);
    });
  }

 private:
  double width_, depth_, side_;
};

class Crossing final : public Obstacle {
 public:
  explicit Crossing(const Config& c)
      : length_(c.number("length_m", {0.05, 100})),
        angle_(c.number("friction_angle_deg", {1, 60})),
        cohesion_(1e3 * c.number_or("cohesion_kPa", 0, {0, 100})) {}
  std::string name() const override { return "crossing"; }
  double length() const override { return length_; }
  std::optional<SoftStrip> strip(const Course& c) const override {
    return SoftStrip{from(c), length_, {angle_, cohesion_}};
  }

 private:
  double length_, angle_, cohesion_;
};

template <class Task>
std::shared_ptr<const TrialTask> made(const Config& c) {
  auto task = std::make_shared<const Task>(c);
  c.finish();
  return task;
}

}  // namespace

double beyond(double from, double x, double length) {
  const double d = std::fmod(x - from, length);
  return d < 0 ? d + length : d;
}

std::shared_ptr<const TrialTask> default_task() { return std::make_shared<const Climb>(); }

std::shared_ptr<const TrialTask> read_task(const Config& task) {
  const std::string type =
      task.choice("type", {"climb", "side_slope", "drawbar", "single_wheel", "step", "ditch", "crossing"});
  if (type == "side_slope") return made<SideSlope>(task);
  if (type == "drawbar") return made<Drawbar>(task);
  if (type == "single_wheel") return made<SingleWheel>(task);
  if (type == "step") return made<Step>(task);
  if (type == "ditch") return made<Ditch>(task);
  if (type == "crossing") return made<Crossing>(task);
  task.finish();
  return default_task();
}

std::shared_ptr<const TrialTask> parse_task(const std::string& text) {
  const auto colon = text.find(':');
  Json json;
  json["type"] = text.substr(0, colon);
  for (std::size_t at = colon; at != std::string::npos && at + 1 < text.size();) {
    const std::size_t next = text.find(',', at + 1), equals = text.find('=', at + 1);
    char* end = nullptr;
    const std::string value =
        equals < next ? text.substr(equals + 1, next == std::string::npos ? next : next - equals - 1) : "";
    const double number = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != 0)
      throw InputError("--trial " + text + ": write it as type:name=number,..., such as step:height_m=0.2,length_m=1");
    json[text.substr(at + 1, equals - at - 1)] = number;
    at = next;
  }
  return read_task(Config::parse(json.dump(), "--trial"));
}

}  // namespace gonogo::campaign
