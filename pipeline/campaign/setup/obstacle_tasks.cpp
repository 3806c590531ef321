// Trials across an obstacle: a rigid sill, a trench, a strip of softer soil.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/setup/task.h"

namespace gonogo::campaign {
namespace {

constexpr double kGap = 0.2;  // between the foremost tyre and what it has to cross [m]

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
  explicit Step(const TaskNumbers& n) : height_(n["height_m"]), length_(n["length_m"]) {}
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
  explicit Ditch(const TaskNumbers& n)
      : width_(n["width_m"]), depth_(n["depth_m"]), side_(std::tan(to_radians(n["side_deg"]))) {}
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
  explicit Crossing(const TaskNumbers& n)
      : length_(n["length_m"]), angle_(n["friction_angle_deg"]), cohesion_(1e3 * n["cohesion_kPa"]) {}
  std::string name() const override { return "crossing"; }
  double length() const override { return length_; }
  std::optional<SoftStrip> strip(const Course& c) const override {
    return SoftStrip{from(c), length_, {angle_, cohesion_}};
  }

 private:
  double length_, angle_, cohesion_;
};

}  // namespace

const TaskType& step_type() {
  static constexpr TaskParameter numbers[] = {{"height_m", {0.005, 3}}, {"length_m", {0.05, 20}, 1}};
  static constexpr TaskType type{"step", "step:height_m=0.2", numbers, make_task<Step>};
  return type;
}

const TaskType& ditch_type() {
  static constexpr TaskParameter numbers[] = {
      {"width_m", {0.05, 20}}, {"depth_m", {0.01, 3}}, {"side_deg", {5, 89}, 30}};
  static constexpr TaskType type{"ditch", "ditch:width_m=1,depth_m=0.2", numbers, make_task<Ditch>};
  return type;
}

const TaskType& crossing_type() {
  static constexpr TaskParameter numbers[] = {
      {"length_m", {0.05, 100}}, {"friction_angle_deg", {1, 60}}, {"cohesion_kPa", {0, 100}, 0}};
  static constexpr TaskType type{"crossing", "crossing:length_m=2,friction_angle_deg=18", numbers, make_task<Crossing>};
  return type;
}

}  // namespace gonogo::campaign
