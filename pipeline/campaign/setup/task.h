// Types of trials behind one interface. A task changes the ground, adds obstacles and loads, sets the distance to
// drive, and decides the verdict last. All else is the same for all types.
//
//   climb         up or down a slope, as the point's slopes say; the default
//   side_slope    along the contour: sliding sideways ends it
//   drawbar       pulled back by a load that grows until the vehicle stops
//   single_wheel  a quarter vehicle's wheel towed at a given slip, or slip and slip angle
//   step          over a rigid sill across the way
//   ditch         through a trench across the way
//   crossing      through a strip of softer soil
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/setup/record.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"

namespace gonogo::campaign {

/// Where things are on the bed when the drive begins; x along the heading [m].
struct Course {
  double start = 0;              // x of the vehicle's middle
  double front = 0, rear = 0;    // from there to the foremost and rearmost point of its tyres
  double length = 0, width = 0;  // of the bed
  double surface = 0;            // height of the undisturbed bed
};

/// A finished drive, as a task judges it.
struct DriveEnd {
  Verdict verdict;  // by the rules that all trials share
  Reason reason;
  double travelled = 0;  // along the heading from the start on, run-in included [m]
  double drift = 0;      // sideways [m]
  double vehicle_length = 0;
  double go_slip = 0;  // largest slip for go [-]
  const std::vector<PullPoint>& pull;
};

/// Load that pulls the vehicle back along the bed. It grows to `share` of the weight in `ramp` [s].
struct TowPlan {
  double share = 0, ramp = 0;
};

/// Strip of other soil across the way.
struct SoftStrip {
  double from = 0, length = 0;  // x of its beginning [m]
  terrain::MacroscopicSoil soil;
};

class TrialTask {
 public:
  virtual ~TrialTask() = default;
  virtual std::string name() const = 0;
  /// Distance from the vehicle's foremost tyre to the far side of the obstacle; 0 without one [m].
  virtual double obstacle_end() const { return 0; }
  /// Removes grains from the settled bed.
  virtual void shape(const Course&, terrain::Packing&) const {}
  /// Height of the obstacle above the bed [m].
  virtual double rise() const { return 0; }
  /// Adds fixed bodies that stay through both phases.
  virtual void furnish(const Course&, sim::SceneWorld&) const {}
  virtual std::optional<SoftStrip> strip(const Course&) const { return std::nullopt; }
  virtual TowPlan tow() const { return {}; }
  /// Slip that a carriage imposes on the wheel of a quarter vehicle.
  virtual std::optional<double> given_slip() const { return std::nullopt; }
  /// From the carriage's way to that wheel's heading, to the left [rad]. A carriage with a slip angle, be it zero,
  /// holds the wheel sideways; one without lets it go there.
  virtual std::optional<double> slip_angle() const { return std::nullopt; }
  virtual std::pair<Verdict, Reason> judge(const DriveEnd& end) const { return {end.verdict, end.reason}; }
};

/// How far x lies beyond `from` along the heading on a periodic bed, in [0, length) [m].
double beyond(double from, double x, double length);

/// A number that describes a task, as studies and command lines name it.
struct TaskParameter {
  const char* key;
  Range allowed;
  std::optional<double> usual = {};  // where it is not given; none: it must be given
  bool may_lack = false;             // or the task does without
};

/// Numbers of a task, complete and in range.
struct TaskNumbers {
  std::span<const TaskParameter> parameters;
  std::vector<std::optional<double>> value;  // [parameters.size()]

  double operator[](const char* key) const;
  std::optional<double> find(const char* key) const;  // of one that may lack
};

struct TaskType {
  const char* name;
  const char* example;  // as on a command line: "step:height_m=0.2"
  std::span<const TaskParameter> parameters;
  std::shared_ptr<const TrialTask> (*make)(const TaskNumbers&);
};

/// All types there are.
const std::vector<const TaskType*>& task_types();
/// Their examples, with commas between them.
std::string task_examples();

/// Whether tasks of this type do without this number, or have a usual one.
bool may_lack(const std::string& type, const std::string& key);

/// A task as a value: its type and the numbers that are given, by key.
struct TaskValues {
  const TaskType* type = nullptr;
  std::map<std::string, double, std::less<>> number;
};

/// Throws InputError, beginning with `where`, for a number that is unknown, missing or out of range.
std::shared_ptr<const TrialTask> make_task(const TaskValues& task, const std::string& where);

/// A task without more to make than from its numbers, for TaskType::make.
template <class Task>
std::shared_ptr<const TrialTask> make_task(const TaskNumbers& numbers) {
  if constexpr (std::is_constructible_v<Task, const TaskNumbers&>)
    return std::make_shared<const Task>(numbers);
  else
    return std::make_shared<const Task>();
}

/// Reads {"type": ..., ...}; throws InputError for unknown types, keys and values out of range, and for missing numbers
/// but those whose keys are `open`.
TaskValues read_task(const Config& task, const std::vector<std::string>& open = {});
/// "step:height_m=0.2,length_m=1" as on a command line.
std::shared_ptr<const TrialTask> parse_task(const std::string& text);
/// Up or down a slope.
std::shared_ptr<const TrialTask> default_task();
/// Judged by any pull above 0.
std::shared_ptr<const TrialTask> drawbar_task(const TowPlan& tow);
/// Slip angle [rad]. Throws InputError for a slip outside -0.9 to 1.
std::shared_ptr<const TrialTask> single_wheel_task(double slip, std::optional<double> slip_angle);

}  // namespace gonogo::campaign
