#include "pipeline/outcome/prior/composed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

constexpr std::array kSlips = {0.05, 0.1, 0.2, 0.3, 0.4, 0.6};
constexpr double kLeastShare = 0.02;  // of the weight on a wheel that a load number takes

std::size_t index(const char* name) { return campaign::contract().variable_index(name); }

/// What a wheel by itself depends on. Trials of whole vehicles have more variables.
constexpr std::array kWheelVariables = {
    "friction_angle",    "cohesion",    "relative_density", "tyre_friction",    "bed_depth", "commanded_speed",
    "single_wheel_slip", "load_number", "width_ratio",      "deflection_ratio", "lug_ratio", "single_wheel_slip_angle"};

constexpr std::size_t kInputsOfWheel = kWheelVariables.size() + 4;

/// Inputs of the regressions: the variables inside the box of the trials, and what closed forms of traction are made
/// of. Friction acts as the smaller of the two, loads by their ratio, and slip mobilises it (Janosi & Hanamoto 1961).
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
                                 1 - std::exp(-at("single_wheel_slip") / kMobilised)});
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
  sinkage_ = fit(data, box_, measures(wheels, "sinkage"));
}

std::vector<double> ComposedVehicle::pull(std::span<const double> points) const {
  return pull_(wheel_inputs(points, box_));
}

std::vector<double> ComposedVehicle::sinkage(std::span<const double> points) const {
  return sinkage_(wheel_inputs(points, box_));
}

std::vector<ComposedMargins> ComposedVehicle::margins(std::span<const double> points) const {
  static const std::size_t width = campaign::contract().variables.size(), slope_at = index("slope_along"),
                           across_at = index("slope_across"), speed_at = index("commanded_speed"),
                           load = index("load_number"), slip = index("single_wheel_slip"),
                           depth_at = index("bed_depth"), cohesion = index("cohesion");
  std::vector<double> asked, share_of;
  std::vector<vehicle::VehicleNumbers> numbers;
  for (std::size_t first = 0; first < points.size(); first += width) {
    std::vector<double> x(points.begin() + std::ptrdiff_t(first), points.begin() + std::ptrdiff_t(first + width));
    numbers.push_back(campaign::vehicle_at({.variables = x}));
    // At the wheels' size, with equal c / (rho g D) and v / sqrt(g D).
    x[cohesion] *= scale_;
    x[depth_at] *= scale_;
    x[speed_at] *= std::sqrt(scale_);
    const double mean_load = x[load];
    for (const double share : vehicle::axle_shares(numbers.back(), to_radians(x[slope_at]))) {
      share_of.push_back(share);
      x[load] = mean_load * std::max(kLeastShare, share * numbers.back().axles);
      for (const double s : kSlips) {
        x[slip] = s;
        asked.insert(asked.end(), x.begin(), x.end());
      }
    }
  }
  const std::vector<double> pulls = pull(asked), depths = sinkage(asked);
  std::vector<ComposedMargins> result;
  std::size_t wheel = 0;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const vehicle::VehicleNumbers& v = numbers[n];
    const double grade = std::tan(to_radians(points[n * width + slope_at]));
    const double across = std::tan(to_radians(points[n * width + across_at]));
    std::array<double, kSlips.size()> total{}, depth{};
    for (int axle = 0; axle < v.axles; ++axle, ++wheel)
      for (std::size_t k = 0; k < kSlips.size(); ++k) {
        total[k] += share_of[wheel] * pulls[wheel * kSlips.size() + k];
        depth[k] = std::max(depth[k], depths[wheel * kSlips.size() + k]);
      }
    const std::size_t best = std::size_t(std::max_element(total.begin(), total.end()) - total.begin());
    const double drive = vehicle::drive_force(v, points[n * width + speed_at] / unit_speed_) - grade;
    result.push_back({total[best] - grade, std::clamp(drive, -1.0, 1.0), v.clearance - depth[best] / wheel_diameter_,
                      std::clamp(standing(v, grade, across), -1.0, 1.0)});
  }
  return result;
}

std::vector<double> ComposedVehicle::inputs(std::span<const double> points) const {
  std::vector<double> result;
  for (const ComposedMargins& m : margins(points))
    result.insert(result.end(), {m.traction, m.drive, m.clearance, m.standing});
  return result;
}

}  // namespace gonogo::outcome
