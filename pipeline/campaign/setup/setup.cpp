#include "pipeline/campaign/setup/setup.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/engine_vehicle.h"

namespace gonogo::campaign {
namespace {

/// Largest distance of the middles of a left and a right tyre [m].
double track_of(const vehicle::Vehicle& v) {
  double track = 0;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v))
    if (p.reach > 0) track = std::max(track, 2 * std::fabs(p.centre.y));
  return track;
}

double widest_tyre(const vehicle::Vehicle& v) {
  double width = 0;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v)) width = std::max(width, p.width);
  return width;
}

/// Top speed of the family's vehicles over sqrt(g D): above all that trials command.
constexpr double kTopSpeed = 3;

/// Of a wheel by itself, and not of a whole vehicle.
bool is_of_wheel(const Variable& v) {
  return v.name == "load_number" || v.name == "width_ratio" || v.name == "deflection_ratio" || v.name == "lug_ratio";
}

}  // namespace

terrain::MovingPatch TrialSetup::patch() const {
  const Extent e = extent_of(*this);
  return {tiles_along * bed_length, e.base / 2 + 2.5 * e.wheel};
}

double TrialSetup::weight(double payload) const { return vehicle::loaded_mass(vehicle, payload) * gravity; }

Course TrialSetup::course(double surface) const {
  const double ends = extent_of(*this).ends(), length = tiles_along * bed_length;
  const double usual = vehicle::is_quarter(vehicle) ? 0.15 * length : 0.5 * length;
  return {.start = start > 0 ? start : usual,
          .front = ends,
          .rear = ends,
          .length = length,
          .width = tiles_across * bed_width,
          .surface = surface};
}

terrain::BedSpec TrialSetup::bed_spec(double bed_depth, std::size_t packing, std::uint64_t bed_seed) const {
  terrain::BedSpec spec;
  spec.length = bed_length;
  spec.width = bed_width;
  spec.depth = deepest_bed > 0 ? deepest_bed : bed_depth;
  spec.grain_diameter = calibration.grain_diameter;
  spec.shape = calibration.shape;
  spec.grain_density = grain_density;
  spec.settle_friction = calibration.packing[packing].settle_friction;
  spec.seed = bed_seed % std::uint64_t(packing_seeds);
  spec.settled_on = settled_on;
  return spec;
}

std::filesystem::path default_packing_folder() {
  if (const char* cache = std::getenv("GONOGO_CACHE")) return std::filesystem::path(cache) / "beds";
  if (const char* cache = std::getenv("XDG_CACHE_HOME")) return std::filesystem::path(cache) / "gonogo" / "beds";
  if (const char* home = std::getenv("HOME")) return std::filesystem::path(home) / ".cache" / "gonogo" / "beds";
  return std::filesystem::temp_directory_path() / "gonogo" / "beds";
}

Extent extent_of(const TrialSetup& s) {
  Extent e;
  double front = -1e9, rear = 1e9;
  for (const vehicle::RunningPart& p : vehicle::running_parts(s.vehicle)) {
    if (!(p.reach > 0)) continue;
    front = std::max(front, p.centre.x);
    rear = std::min(rear, p.centre.x);
    e.wheel = std::max(e.wheel, p.reach);
    e.width = std::max(e.width, 2 * std::fabs(p.centre.y) + p.width);
  }
  e.base = front - rear;
  if (s.vehicle.track) {
    const vehicle::Track& t = *s.vehicle.track;
    const double thick = t.pad_below_pin + t.grouser_height;
    e.overhang = std::max(t.sprocket.centre.x + t.sprocket_radius + thick - front,
                          rear - t.idler_travel.x + vehicle::pin_circle(t, t.idler_radius) + thick);
  }
  return e;
}

void check_tyres(const TrialSetup& s) {
  if (s.compliant_tyres && !(s.vehicle.wheel.front().compliant.stiffness > 0))
    throw InputError(s.vehicle_file.string() +
                     ": compliant tyres are asked for, and its wheels name no \"compliant\" with stiffness_N_m and "
                     "damping_N_s_m; add them, or leave compliant_tyres out");
}

double grains_per_tyre(const TrialSetup& s) { return vehicle::tread_width(s.vehicle) / s.calibration.grain_diameter; }

bool is_varied(const TrialSetup& s, std::size_t v) {
  const Variable& variable = contract().variables[v];
  if (is_family_variable(variable)) return s.family && (!s.family_wheels || is_of_wheel(variable));
  return std::any_of(s.task_varied.begin(), s.task_varied.end(), [v](const TaskNumber& n) { return n.variable == v; });
}

std::string refusal_of_size(const TrialSetup& s, std::size_t v) {
  if (is_family_variable(contract().variables[v]) && s.family)
    return "trials of type single_wheel drive a wheel by itself; leave it out, or change trial.task.type";
  if (is_family_variable(contract().variables[v]))
    return "the vehicle " + s.vehicle.name + " is no family; leave the number out, or name ../families/wheeled.json";
  const std::string type = s.task->name();
  for (const TaskNumber& n : task_numbers(type))
    if (n.variable == v) return "trial.task gives " + n.key + " already; keep one of the two";
  return "trials of type " + type + " have no such number; leave it out, or change trial.task.type";
}

/// A sweep gets the time that it takes. The vehicle and what it has to cross must lie side by side on the periodic bed;
/// the run ends behind the obstacle.
void fit_to_task(TrialSetup& s) {
  const double end = s.task->obstacle_end(), sweep = s.task->tow().ramp;
  if (sweep > 0) s.time_limit = s.ramp_time + s.min_drive_time + sweep + s.thresholds.immobile_time;
  if (!vehicle::is_quarter(s.vehicle) && s.task->given_slip())
    throw InputError("a trial of type " + s.task->name() + " leads one wheel" +
                     (s.task->slip_angle() ? " at a slip angle" : "") + "; name a vehicle of kind quarter");
  if (!(end > 0)) return;
  const Course c = s.course(0);
  const double needed = c.front + c.rear + end;
  if (needed > c.length)
    throw InputError("a trial of type " + s.task->name() + " needs a bed of " + number_text(needed, 4) +
                     " m for vehicle and obstacle; it is " + number_text(c.length, 4) + " m long");
  s.run_in_distance = 0;
  s.test_distance = needed;
}

Vec3d bed_gravity(double slope_along_deg, double slope_across_deg, double gravity) {
  // The ground plane rises by tan(along) per metre forward and tan(across) per metre left; its normal is z of the bed.
  const double a = std::tan(slope_along_deg * kDegree), b = std::tan(slope_across_deg * kDegree);
  const double n = std::sqrt(1 + a * a + b * b);
  // With s the slope and psi the heading from the fall line, a = tan s cos psi and b = tan s sin psi: this is
  // -g (sin s cos psi, sin s sin psi, cos s).
  return Vec3d{a, b, 1} * (-gravity / n);
}

TrialInputs inputs_of(const DesignPoint& point) {
  const auto value = [&](const char* name) { return point.variables.at(contract().variable_index(name)); };
  return {.slope_along = value("slope_along"),
          .slope_across = value("slope_across"),
          .soil = {value("friction_angle"), value("cohesion") * 1e3, 0, value("relative_density")},
          .tyre_friction = value("tyre_friction"),
          .bed_depth = value("bed_depth"),
          .payload = value("payload"),
          .speed = value("commanded_speed"),
          .bed_seed = point.seed};
}

vehicle::WheelNumbers wheel_at(const DesignPoint& point) {
  const auto value = [&](const char* name) { return point.variables.at(contract().variable_index(name)); };
  return {.load = value("load_number"),
          .width = value("width_ratio"),
          .deflection = value("deflection_ratio"),
          .lug = value("lug_ratio")};
}

vehicle::VehicleNumbers vehicle_at(const DesignPoint& point) {
  const auto value = [&](const char* name) { return point.variables.at(contract().variable_index(name)); };
  vehicle::VehicleNumbers n{.wheel = wheel_at(point)};
  n.axles = std::clamp(int(std::lround(value("axles"))), 2, 4);
  n.axle_gap = value("axle_gap_ratio");
  n.track = value("track_ratio");
  n.centre_height = value("centre_height_ratio");
  n.centre_behind = value("centre_share");
  n.clearance = value("clearance_ratio");
  n.force = value("force_number");
  n.power = value("power_number");
  n.top_speed = kTopSpeed;
  return n;
}

void take_member(TrialSetup& s, const vehicle::VehicleNumbers& numbers) {
  if (s.family_wheels) {
    s.vehicle = vehicle::canonical_wheel(*s.family, numbers.wheel, s.gravity);
    return;
  }
  s.vehicle = vehicle::canonical_vehicle(*s.family, numbers, s.gravity);
  const Extent e = extent_of(s);
  s.tiles_along = int(std::ceil((e.base + 7 * e.wheel) / s.bed_length));
  s.tiles_across = 1;
  while (lane_gap(s.vehicle, s.tiles_across * s.bed_width) < kMinLaneGap * widest_tyre(s.vehicle)) ++s.tiles_across;
  s.folded = s.tiles_across * s.bed_width < e.width;
}

TrialSetup setup_at(const TrialSetup& setup, const DesignPoint& point) {
  for (std::size_t v = 0; v < contract().variables.size(); ++v)
    if (is_task_variable(contract().variables[v]) && point.variables[v] != 0 && !is_varied(setup, v))
      throw InputError(contract().variables[v].name + ": " + refusal_of_size(setup, v));
  TrialSetup own = setup;
  own.inputs = inputs_of(point);
  if (own.family) take_member(own, vehicle_at(point));
  if (own.task_varied.empty()) return own;
  for (const TaskNumber& n : own.task_varied) own.task_given.number[n.key] = point.variables[n.variable];
  own.task = make_task(own.task_given, "trial " + std::to_string(point.index) + ": trial.task");
  fit_to_task(own);
  return own;
}

double folded_width(const vehicle::Vehicle& v) { return 2 * track_of(v) / 3; }

double lane_gap(const vehicle::Vehicle& v, double width) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto parts = vehicle::running_parts(v);
  for (const vehicle::RunningPart& a : parts) {
    if (!(a.reach > 0)) continue;
    smallest = std::min(smallest, width - a.width);
    for (const vehicle::RunningPart& b : parts)
      if (b.reach > 0 && a.centre.y > 0 && b.centre.y < 0)
        smallest =
            std::min(smallest, std::fabs(std::remainder(a.centre.y - b.centre.y, width)) - (a.width + b.width) / 2);
  }
  return smallest;
}

bool is_foldable(const vehicle::Vehicle& v) {
  return !vehicle::is_quarter(v) && !v.track && lane_gap(v, folded_width(v)) >= kMinLaneGap * widest_tyre(v);
}

double wide_bed(const TrialSetup& s) {
  const Extent e = extent_of(s);
  return e.width + 2 * e.wheel;
}

void check_foldable(const TrialSetup& s) {
  if (vehicle::is_quarter(s.vehicle))
    throw InputError(s.vehicle_file.string() +
                     ": a folded bed has lanes for left and right wheels, and this is a quarter vehicle; leave "
                     "trial.bed.folded out, or name a whole vehicle");
  if (s.vehicle.track)
    throw InputError(s.vehicle_file.string() +
                     ": a folded bed is for wheels; on it, the hull of a tracked vehicle would meet the images of its "
                     "belts; leave trial.bed.folded out");
}

void check_lanes(const TrialSetup& s) {
  const double width = s.tiles_across * s.bed_width, needed = kMinLaneGap * widest_tyre(s.vehicle);
  const double gap = lane_gap(s.vehicle, width);
  if (gap >= needed) return;
  throw InputError("on a folded bed of " + number_text(width, 4) + " m there are " +
                   number_text(std::max(0.0, gap), 4) + " m between the tyres of neighbouring lanes; at least " +
                   number_text(needed, 4) + " m are needed, so that no tyre runs in another's rut; " +
                   (is_foldable(s.vehicle)
                        ? "leave trial.bed.width_m out, which gives " + number_text(folded_width(s.vehicle), 4) + " m"
                        : "tyres so wide for their track have no folded bed: leave folded and "
                          "width_m out, which gives " +
                              number_text(wide_bed(s), 4) + " m"));
}

void fold_bed(TrialSetup& s) {
  check_foldable(s);
  s.folded = true;
  s.bed_width = folded_width(s.vehicle);
  s.tiles_across = 1;
  check_lanes(s);
}

}  // namespace gonogo::campaign
