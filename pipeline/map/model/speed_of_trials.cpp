#include "pipeline/map/model/speed_of_trials.h"

#include <cmath>

#include "base/units.h"
#include "vehicle/model/assembly.h"
#include "vehicle/model/engine_vehicle.h"
#include "vehicle/model/statics.h"

namespace gonogo::map {
namespace {

/// What a trial's numbers refer to.
struct Driven {
  double mass = 0;            // without payload [kg]
  double wheels = 1;          // driven ones, over which the torque is averaged
  double payload_share = 1;   // of the vehicle's payload that it carries
  double radius = 0;          // [m]
  double tyre_stiffness = 0;  // of all tyres together [N/m]
};

Driven driven_of(const TrialVehicle& v) {
  if (v.rig)
    return {.mass = vehicle::rig_mass(*v.rig, 0),
            .payload_share = 1.0 / v.rig->wheels_per_vehicle,
            .radius = v.rig->radius,
            .tyre_stiffness = v.compliant_tyres ? v.rig->compliant.stiffness : 0};
  Driven driven{.mass = vehicle::weigh(*v.whole).total, .wheels = 0, .radius = vehicle::drive_radius(*v.whole)};
  for (const vehicle::RunningPart& part : vehicle::running_parts(*v.whole)) driven.wheels += part.driven;
  for (const vehicle::Station& s : vehicle::stations(*v.whole))
    if (v.compliant_tyres) driven.tyre_stiffness += s.wheel->compliant.stiffness;
  return driven;
}

double measure(const campaign::TrialRecord& record, const char* name) {
  return record.measures[campaign::contract().measure_index(name)];
}

double variable(const campaign::TrialRecord& record, const char* name) {
  return record.point.variables[campaign::contract().variable_index(name)];
}

/// Nothing downhill. Shares are of the load across the ground.
std::optional<ResistanceTrial> resistance_of(const campaign::TrialRecord& record, const Driven& driven,
                                             const SpeedModel& model) {
  const double along = std::tan(to_radians(variable(record, "slope_along"))),
               across = std::tan(to_radians(variable(record, "slope_across")));
  const double mass = driven.mass + driven.payload_share * variable(record, "payload");
  const double load = mass * model.gravity / std::sqrt(1 + along * along + across * across);
  const double push = driven.wheels * measure(record, "mean_torque") / driven.radius / load;
  const double slip = measure(record, "slip"), speed = measure(record, "mean_speed");
  if (!(along >= 0) || !(slip < 1) || !(speed > 0) || !std::isfinite(push)) return std::nullopt;
  return ResistanceTrial{.resistance = push - along,
                         .rut = model.rut(measure(record, "sinkage"), load),
                         .slip = slip,
                         .speed = speed / (1 - slip)};
}

/// Of all ruts side by side: the wheels of one axle, or two tracks [m].
double rut_width(const vehicle::Vehicle& v) {
  if (v.kind == vehicle::VehicleKind::tracked) return 2 * v.track[0].shoe_width;
  double front = -std::numeric_limits<double>::infinity(), width = 0;
  for (const vehicle::Station& s : vehicle::stations(v)) front = std::max(front, s.centre.x);
  for (const vehicle::Station& s : vehicle::stations(v))
    if (s.centre.x > front - 1e-3) width += s.wheel->width;
  return width;
}

MeasureFit fit_of(const campaign::Dataset& dataset, const char* name) {
  std::vector<double> points, value;
  for (const campaign::TrialRecord& record : dataset.records) {
    if (!campaign::passes(record.verdict)) continue;
    points.insert(points.end(), record.point.variables.begin(), record.point.variables.end());
    value.push_back(measure(record, name));
  }
  return fit_measure(name, "", points, value);
}

}  // namespace

std::optional<SpeedModel> speed_of_trials(const campaign::Dataset& dataset, const TrialVehicle& driven,
                                          const vehicle::Vehicle& whole) {
  const Driven of_trials = driven_of(driven);
  SpeedModel model;
  model.drive = vehicle::TractiveForce(whole);
  model.gravity = driven.gravity;
  model.mass = vehicle::weigh(whole).total;
  model.tyre_stiffness = of_trials.tyre_stiffness;
  model.rut_width = rut_width(whole);
  std::vector<ResistanceTrial> trials;
  for (const campaign::TrialRecord& record : dataset.records)
    if (campaign::passes(record.verdict))
      if (const auto trial = resistance_of(record, of_trials, model)) trials.push_back(*trial);
  if (trials.empty()) return std::nullopt;
  model.resistance = fit_resistance(trials);
  model.slip = fit_of(dataset, "slip");
  model.sinkage = fit_of(dataset, "sinkage");
  return model;
}

}  // namespace gonogo::map
