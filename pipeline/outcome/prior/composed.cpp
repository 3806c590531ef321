#include "pipeline/outcome/prior/composed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "learning/model/model.h"
#include "learning/rbm/regression/fit_files.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/training_data.h"
#include "vehicle/family/common_pull.h"

namespace gonogo::outcome {
namespace {

/// Ways in which the wheels of a vehicle may turn, all alike: every slip at every slip angle [deg].
constexpr std::array kSlips = {0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.75, 0.9};
constexpr std::array kSlipAngles = {0.0, 7.0, 14.0, 21.0, 30.0};
constexpr std::size_t kWays = kSlips.size() * kSlipAngles.size();

std::size_t index(const char* name) { return campaign::contract().variable_index(name); }

/// What a wheel by itself depends on. Trials of whole vehicles have more variables.
constexpr std::array kWheelVariables = {
    "friction_angle",    "cohesion",    "relative_density", "tyre_friction",    "bed_depth", "commanded_speed",
    "single_wheel_slip", "load_number", "width_ratio",      "deflection_ratio", "lug_ratio", "single_wheel_slip_angle"};

constexpr std::size_t kInputsOfWheel = kWheelVariables.size() + 6;

/// Inputs of the regressions: the variables inside the box of the trials, and what closed forms of traction are made
/// of. Friction acts as the smaller of the two, loads by their ratio, and slip mobilises it (Janosi & Hanamoto 1961). A
/// tyre touches the ground over a length that goes with the root of its deflection, and a rigid one hardly at all; lugs
/// likewise.
std::vector<double> wheel_inputs(std::span<const double> points, const std::vector<Range>& box) {
  static const std::size_t width = campaign::contract().variables.size();
  constexpr double kMobilised = 0.15;
  std::vector<double> result;
  for (std::size_t first = 0; first < points.size(); first += width) {
    const auto at = [&](const char* name) {
      const std::size_t v = index(name);
      return std::clamp(points[first + v], box[v].minimum, box[v].maximum);
    };
    for (const char* name : kWheelVariables) result.push_back(at(name));
    const double soil = std::tan(to_radians(at("friction_angle")));
    result.insert(result.end(), {soil, std::min(soil, at("tyre_friction")), std::log(at("load_number")),
                                 1 - std::exp(-at("single_wheel_slip") / kMobilised), std::sqrt(at("deflection_ratio")),
                                 std::sqrt(at("lug_ratio"))});
  }
  return result;
}

learning::GaussianRegression fit(const TrainingData& data, const std::vector<Range>& box,
                                 const std::vector<double>& target) {
  learning::TrainingTable table = data.table;
  table.variables = wheel_inputs(table.variables, box);
  table.variable_count = kInputsOfWheel;
  return learning::fit_gaussian_regression(table, target);
}

std::vector<double> measures(const std::vector<campaign::TrialRecord>& records, const char* name) {
  std::vector<double> values;
  for (const campaign::TrialRecord& r : records)
    if (r.verdict != campaign::Verdict::unknown) values.push_back(r.measures[campaign::contract().measure_index(name)]);
  return values;
}

TrainingData checked(const std::vector<campaign::TrialRecord>& wheels, const std::string& where) {
  constexpr std::size_t kFewest = 50;
  TrainingData data = make_training_data(wheels, std::nullopt);
  if (data.table.row_count() < kFewest)
    throw InputError(where + ": has " + std::to_string(data.table.row_count()) + " valid trials of wheels; at least " +
                     std::to_string(kFewest) + " are needed to compose vehicles of them");
  return data;
}

/// What is left until a vehicle on stiff springs tips over, as tangents of slopes along and across.
double standing(const vehicle::VehicleNumbers& v, double along, double across) {
  const double base = v.axle_gap + v.axles - 1, front = v.centre_behind * base;
  return std::min({(base - front) / v.centre_height - along, front / v.centre_height + along,
                   v.track / 2 / v.centre_height - std::abs(across)});
}

/// Appends the wheel of a vehicle that turns in this way under this load, over the mean wheel's. point: the vehicle's.
void append_wheel(const std::vector<double>& point, double load, std::size_t way, std::vector<double>& wheels) {
  static const std::size_t load_at = index("load_number"), slip = index("single_wheel_slip"),
                           angle = index("single_wheel_slip_angle");
  const std::size_t first = wheels.size();
  wheels.insert(wheels.end(), point.begin(), point.end());
  wheels[first + load_at] *= load;
  wheels[first + slip] = kSlips[way % kSlips.size()];
  wheels[first + angle] = kSlipAngles[way / kSlips.size()];
}

}  // namespace

bool are_of_wheels(const std::vector<campaign::TrialRecord>& records) {
  const std::size_t slip = index("single_wheel_slip"), load = index("load_number");
  return std::any_of(records.begin(), records.end(), [&](const campaign::TrialRecord& r) {
    return r.point.variables[slip] != 0 && r.point.variables[load] > 0;
  });
}

ComposedVehicle::ComposedVehicle(const std::vector<campaign::TrialRecord>& wheels, const std::string& where,
                                 double wheel_diameter, double vehicle_diameter, double gravity)
    : unit_speed_(std::sqrt(gravity * vehicle_diameter)),
      scale_(wheel_diameter / vehicle_diameter),
      wheel_diameter_(wheel_diameter) {
  const TrainingData data = checked(wheels, where);
  for (std::size_t v = 0; v < data.lower.size(); ++v) box_.push_back({data.lower[v], data.upper[v]});
  pull_ = fit(data, box_, measures(wheels, "pull"));
  side_force_ = fit(data, box_, measures(wheels, "side_force"));
  sinkage_ = fit(data, box_, measures(wheels, "sinkage"));
}

std::vector<double> ComposedVehicle::pull(std::span<const double> points) const {
  return pull_(wheel_inputs(points, box_));
}

std::vector<double> ComposedVehicle::side_force(std::span<const double> points) const {
  return side_force_(wheel_inputs(points, box_));
}

std::vector<double> ComposedVehicle::sinkage(std::span<const double> points) const {
  return sinkage_(wheel_inputs(points, box_));
}

ComposedMargins ComposedVehicle::margins_of(std::span<const double> asked) const {
  std::vector<double> point(asked.begin(), asked.end());
  const vehicle::VehicleNumbers numbers = campaign::vehicle_at({.variables = point});
  const double slope = to_radians(point[index("slope_along")]), grade = std::tan(slope),
               across = std::tan(to_radians(point[index("slope_across")])),
               speed = point[index("commanded_speed")] / unit_speed_;
  // At the wheels' size, with equal c / (rho g D) and v / sqrt(g D).
  point[index("cohesion")] *= scale_;
  point[index("bed_depth")] *= scale_;
  point[index("commanded_speed")] *= std::sqrt(scale_);
  const std::vector<double> shares = vehicle::axle_shares(numbers, slope), loads = vehicle::axle_loads(shares);
  std::vector<double> wheels, best_wheels;
  for (const double load : loads)
    for (std::size_t way = 0; way < kWays; ++way) append_wheel(point, load, way, wheels);
  const std::vector<double> pulls = pull(wheels), sides = side_force(wheels);
  const auto forces = [&](std::size_t axle, std::size_t way) {
    return vehicle::AxleForces{pulls[axle * kWays + way], sides[axle * kWays + way]};
  };
  const vehicle::CommonPull best = vehicle::largest_pull(shares, kWays, std::abs(across), forces);
  for (const double load : loads) append_wheel(point, load, best.way, best_wheels);
  const std::vector<double> depths = sinkage(best_wheels);
  const double deepest = *std::max_element(depths.begin(), depths.end()) / wheel_diameter_;
  return {.traction = best.pull - grade,
          .drive = std::clamp(vehicle::drive_force(numbers, speed) - grade, -1.0, 1.0),
          .clearance = numbers.clearance - deepest,
          .standing = std::clamp(standing(numbers, grade, across), -1.0, 1.0)};
}

std::vector<ComposedMargins> ComposedVehicle::margins(std::span<const double> points) const {
  const std::size_t width = campaign::contract().variables.size();
  std::vector<ComposedMargins> result;
  for (std::size_t first = 0; first < points.size(); first += width)
    result.push_back(margins_of(points.subspan(first, width)));
  return result;
}

std::vector<double> ComposedVehicle::inputs(std::span<const double> points) const {
  std::vector<double> result;
  for (const ComposedMargins& m : margins(points))
    result.insert(result.end(), {m.traction, m.drive, m.clearance, m.standing});
  return result;
}

void ComposedVehicle::write(Hdf5Writer& out, const std::string& group) const {
  std::vector<double> lower, upper;
  for (const Range& range : box_) {
    lower.push_back(range.minimum);
    upper.push_back(range.maximum);
  }
  out.array(group + "/box/lower", lower);
  out.array(group + "/box/upper", upper);
  out.array(group + "/scales", std::vector<double>{unit_speed_, scale_, wheel_diameter_});
  out.attribute(
      group + "/scales", "description",
      "sqrt(g D) of the vehicles' wheels [m/s]; diameter of the trials' wheels over theirs [-], and itself [m]");
  learning::write_fit(out, group + "/pull", pull_);
  learning::write_fit(out, group + "/side_force", side_force_);
  learning::write_fit(out, group + "/sinkage", sinkage_);
}

ComposedVehicle ComposedVehicle::read(const Hdf5Reader& in, const std::string& group) {
  const std::size_t variables = campaign::contract().variables.size();
  const auto lower = learning::finite_array(in, group + "/box/lower", Shape{variables});
  const auto upper = learning::finite_array(in, group + "/box/upper", Shape{variables});
  const auto scales = learning::finite_array(in, group + "/scales", Shape{3});
  ComposedVehicle vehicle;
  for (std::size_t v = 0; v < variables; ++v) vehicle.box_.push_back({lower[v], upper[v]});
  vehicle.unit_speed_ = scales[0];
  vehicle.scale_ = scales[1];
  vehicle.wheel_diameter_ = scales[2];
  const auto regression = [&](const char* name) {
    learning::GaussianRegression read = learning::read_regression(in, group + name);
    if (read.input_count() != kInputsOfWheel)
      in.fail(group + name, "has other inputs than this program's; train the model again");
    return read;
  };
  vehicle.pull_ = regression("/pull");
  vehicle.side_force_ = regression("/side_force");
  vehicle.sinkage_ = regression("/sinkage");
  return vehicle;
}

}  // namespace gonogo::outcome
