#include "pipeline/campaign/setup/read_setup.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/format.h"
#include "pipeline/campaign/study/contract.h"
#include "sim/law/contact_law.h"

namespace gonogo::campaign {
namespace {

/// The bed of a whole vehicle where the study leaves it open: a folded one, which is cheaper, where there may be one.
void choose_bed(TrialSetup& s) {
  if (vehicle::is_quarter(s.vehicle)) return;
  const Extent e = extent_of(s);
  s.folded = is_foldable(s.vehicle);
  s.bed_width = s.folded ? folded_width(s.vehicle) : wide_bed(s);
  s.bed_length = std::max(s.bed_length, 2 * s.patch().reach + 2 * e.wheel);
}

void read_bed(const Config& bed, TrialSetup& s) {
  s.bed_length = bed.number_or("length_m", s.bed_length, {0.1, 100});
  const bool open = !bed.has("width_m") && !bed.has("tiles_across");
  const bool as_wide = open && !vehicle::is_quarter(s.vehicle);
  const double unfolded = as_wide ? wide_bed(s) : TrialSetup{}.bed_width;
  s.folded = bed.boolean_or("folded", open && s.folded);
  if (s.folded) check_foldable(s);
  s.bed_width = bed.number_or("width_m", s.folded ? folded_width(s.vehicle) : unfolded, {0.05, 100});
  s.tiles_along = int(bed.integer_or("tiles_along", s.tiles_along, {1, 100}));
  s.tiles_across = int(bed.integer_or("tiles_across", s.tiles_across, {1, 100}));
  s.moving_patch = bed.boolean_or("moving_patch", s.moving_patch);
  s.packing_seeds = int(bed.integer_or("packing_seeds", s.packing_seeds, {1, 1000}));
  s.deepest_bed = bed.number_or("deepest_m", s.deepest_bed, {0, 10});
  s.bed_settle_time = bed.number_or("settle_s", s.bed_settle_time, {0, 10});
  bed.finish();
}

void read_drive(const Config& drive, TrialSetup& s) {
  s.park_time = drive.number_or("park_s", s.park_time, {0, 10});
  s.ramp_time = drive.number_or("ramp_s", s.ramp_time, {0.01, 10});
  s.run_in_distance = drive.number_or("run_in_m", s.run_in_distance, {0, 100});
  s.test_distance = drive.number_or("test_distance_m", s.test_distance, {0.01, 1000});
  s.min_drive_time = drive.number_or("minimum_drive_s", s.min_drive_time, {0.1, 100});
  s.time_limit = drive.number_or("time_limit_s", s.time_limit, {0.1, 1000});
  drive.finish();
}

terrain::AskedNumerics read_numerics(const Config& c) {
  terrain::AskedNumerics asked;
  if (c.has("step_s")) asked.step = c.number("step_s", {1e-5, 5e-3});
  if (c.has("substeps")) asked.substeps = int(c.integer("substeps", {1, 1000}));
  if (c.has("iterations")) asked.iterations = int(c.integer("iterations", {1, 100000}));
  if (c.has("tolerance_m_per_s")) asked.tolerance = c.number("tolerance_m_per_s", {0, 1});
  if (c.has("target")) asked.target = sim::target_named(c.choice("target", sim::target_names()));
  if (c.has("give")) asked.give = c.number("give", {0, 10});
  if (c.has("contact")) asked.contact = sim::contact_named(c.choice("contact", sim::contact_names()));
  if (c.has("overlap")) asked.overlap = c.number("overlap", {1e-5, 0.2});
  c.finish();
  return asked;
}

void read_thresholds(const Config& c, Thresholds& t) {
  t.go_speed_share = c.number_or("go_speed_share", t.go_speed_share, {0, 1});
  t.go_slip = c.number_or("go_slip", t.go_slip, {0, 1});
  t.immobile_speed = c.number_or("immobile_speed_m_per_s", t.immobile_speed, {0, 10});
  t.immobile_time = c.number_or("immobile_s", t.immobile_time, {0.01, 100});
  t.slid_back_share = c.number_or("slid_back_vehicle_lengths", t.slid_back_share, {0.01, 10});
  t.tilt_deg = c.number_or("tilt_deg", t.tilt_deg, {1, 180});
  t.creep_speed = c.number_or("creep_m_per_s", t.creep_speed, {1e-3, 10});
  t.residual = c.number_or("residual_m_per_s", t.residual, {1e-6, 10});
  t.energy_error = c.number_or("energy_error", t.energy_error, {1e-6, 10});
  c.finish();
}

/// A variable of a design: the part of it that says so, least and most.
struct Span {
  Config part;
  double low, high;
};

/// Nothing for a variable that comes from a file of points.
std::optional<Span> span_of(const Config& design, const char* variable, Range allowed) {
  if (const auto fixed = design.object_if("fixed"); fixed && fixed->has(variable)) {
    const double value = fixed->number(variable);
    return Span{*fixed, value, value};
  }
  const auto ranges = design.object_if("ranges");
  if (!ranges || !ranges->has(variable)) return {};
  const auto range = ranges->numbers(variable, allowed);
  if (range.size() != 2) return {};
  return Span{*ranges, range[0], range[1]};
}

void check_angles(const TrialSetup& s, const Span& angle) {
  const terrain::AngleRange reach = terrain::reachable_angles(s.calibration);
  if (angle.low >= reach.lowest && angle.high <= reach.highest) return;
  angle.part.fail("friction_angle", "grains of " + number_text(s.calibration.grain_diameter) + " m reach " +
                                        number_text(reach.lowest, 4) + " to " + number_text(reach.highest, 4) +
                                        " deg; narrow the range to that");
}

/// Cohesion is a share of the contacts' pull that changes along the line: held to its least over the angles, in steps
/// of a quarter of a degree.
void check_cohesion(const TrialSetup& s, const Span& angle, const Span& cohesion) {
  for (std::size_t packing = 0; packing < s.calibration.packing.size(); ++packing)
    for (double phi = angle.low;; phi = std::min(phi + 0.25, angle.high)) {
      const double reach = 1e-3 * terrain::reachable_cohesion(s.calibration, phi, packing);
      if (cohesion.high > reach)
        cohesion.part.fail("cohesion", "goes to " + number_text(cohesion.high, 4) +
                                           " kPa, and at a friction angle of " + number_text(phi) + " deg grains of " +
                                           number_text(s.calibration.grain_diameter) + " m reach " +
                                           number_text(reach, 4) +
                                           " kPa; narrow the range to that or start at a larger friction angle");
      if (phi >= angle.high) break;
    }
}

/// Every soil of the design must be within reach of the grains, or trials would fail one by one later.
void check_reach(const Study& study, const TrialSetup& s) {
  const auto design = study.config.object_if("design");
  if (!design) return;
  const auto angle = span_of(*design, "friction_angle", {0, 90});
  if (!angle) return;
  check_angles(s, *angle);
  if (const auto cohesion = span_of(*design, "cohesion", {0, 1000})) check_cohesion(s, *angle, *cohesion);
}

/// Beds are cut from packings of the depth that the study names.
void check_depth(const Study& study, const TrialSetup& s) {
  const auto design = study.config.object_if("design");
  if (s.deepest_bed == 0 || !design || !design->has("ranges") || !design->object("ranges").has("bed_depth")) return;
  const Config ranges = design->object("ranges");
  const auto range = ranges.numbers("bed_depth", {0, 100});
  if (range.size() == 2 && range[1] > s.deepest_bed)
    ranges.fail("bed_depth", "goes to " + number_text(range[1], 4) + " m, but trial.bed.deepest_m is " +
                                 number_text(s.deepest_bed, 4) + " m; make that as deep");
}

/// Stands in for numbers that a file of points gives; the points are checked one by one [m].
constexpr double kSmallObstacle = 0.05;

/// The task of a study. Numbers that trial.task lacks and a variable may give are the points': the task is made for the
/// largest of them, and for the least to see that they are in range.
void read_study_task(const Study& study, const Config& c, TrialSetup& s) {
  const auto design = study.config.object_if("design");
  std::vector<std::string> open;
  std::vector<std::optional<Span>> spans;
  for (const TaskNumber& n : task_numbers(c.text("type"))) {
    if (c.has(n.key)) continue;
    const Variable& variable = contract().variables[n.variable];
    const auto span = design ? span_of(*design, variable.name.c_str(), {}) : std::nullopt;
    if (!span && may_lack(c.text("type"), n.key)) continue;
    spans.push_back(span);
    if (!span && !(design && design->has("file")))
      c.fail(n.key, "missing; give it, or a range or value of " + variable.name + " in the design");
    s.task_varied.push_back(n);
    open.push_back(n.key);
  }
  s.task_given = read_task(c, open);
  const std::string where = c.file().string() + ": trial.task";
  TaskValues least = s.task_given, largest = s.task_given;
  for (std::size_t k = 0; k < open.size(); ++k) {
    least.number[open[k]] = spans[k] ? spans[k]->low : kSmallObstacle;
    largest.number[open[k]] = spans[k] ? spans[k]->high : kSmallObstacle;
  }
  make_task(least, where);
  s.task = make_task(largest, where);
}

/// Sizes of obstacles in the design must be numbers of the task that it leaves open, and trenches end in grains.
void check_sizes(const Study& study, const TrialSetup& s) {
  const auto design = study.config.object_if("design");
  if (!design) return;
  for (std::size_t v = 0; v < contract().variables.size(); ++v) {
    const std::string& name = contract().variables[v].name;
    if (!is_task_variable(contract().variables[v]) || is_varied(s, v)) continue;
    if (const auto span = span_of(*design, name.c_str(), {}); span && span->high > 0)
      span->part.fail(name, refusal_of_size(s, v));
  }
  const auto depth = span_of(*design, "ditch_depth", {}), bed = span_of(*design, "bed_depth", {});
  const double grain = s.calibration.grain_diameter;
  if (depth && bed && depth->high + grain > bed->low)
    depth->part.fail("ditch_depth", "goes to " + number_text(depth->high, 4) + " m, and a bed of " +
                                        number_text(bed->low, 4) + " m leaves no grain below it; make bed_depth " +
                                        number_text(depth->high + 2 * grain, 3) + " m or more");
}

/// Takes the family's member that is largest in everything that the design samples.
void take_largest_member(const Study& study, TrialSetup& s) {
  const auto design = study.config.object_if("design");
  DesignPoint largest{.variables = std::vector<double>(contract().variables.size(), 0)};
  for (std::size_t v = 0; v < contract().variables.size(); ++v) {
    const Variable& variable = contract().variables[v];
    if (!is_family_variable(variable) || !is_varied(s, v)) continue;
    const auto span =
        design ? span_of(*design, variable.name.c_str(), {variable.minimum, variable.maximum}) : std::nullopt;
    if (!span)
      study.config.fail("design", variable.name + ": missing; the vehicle " + s.family->name +
                                      " is a family, so give it a range or a fixed value");
    largest.variables[v] = variable.name == "centre_share" ? 0.5 : span->high;
  }
  const double deflection = wheel_at(largest).deflection;
  if (deflection >= vehicle::kNegligible && !s.compliant_tyres)
    study.config.fail("trial", "compliant_tyres: the design has deflection_ratio up to " + number_text(deflection) +
                                   "; set it to true, or the ratio to 0");
  take_member(s, vehicle_at(largest));
}

void read_vehicle_file(const Config& file, TrialSetup& s) {
  if (vehicle::is_family(file))
    throw InputError(s.vehicle_file.string() +
                     ": is a family of vehicles; a study samples its members, and a single trial drives one vehicle");
  s.vehicle = vehicle::read_any_vehicle(file);
  if (s.vehicle.kind == vehicle::VehicleKind::single_wheel)
    throw InputError(
        s.vehicle_file.string() +
        ": a single-wheel rig does not stand by itself: trials drive its wheel under a carriage that holds "
        "it upright; name its quarter vehicle, such as mgru3_wheel");
}

void read_vehicle_or_family(const Study& study, TrialSetup& s) {
  const Config file = study.file_named("vehicle", s.vehicle_file);
  if (!vehicle::is_family(file)) return read_vehicle_file(file, s);
  s.family = std::make_shared<const vehicle::Family>(vehicle::read_family(file));
  const auto task = study.section("trial").object_if("task");
  s.family_wheels = task && task->text("type") == "single_wheel";
  take_largest_member(study, s);
}

/// Every wheel must stand on the bed, beside and not on its own image; on a folded one beside the other lane.
void check_wheels_on_bed(const TrialSetup& s) {
  const Extent e = extent_of(s);
  const double length = s.tiles_along * s.bed_length, width = s.tiles_across * s.bed_width;
  const auto too_small = [&](const char* side, double has, double needs, const std::string& remedy) {
    throw InputError("the bed is " + number_text(has, 4) + " m " + side + ", and the wheels of the vehicle take " +
                     number_text(needs, 4) + " m: a wheel would stand outside the bed; " + remedy);
  };
  if (length < 2 * e.ends())
    too_small("long", length, 2 * e.ends(), "enlarge trial.bed.length_m, or put more tiles in a row with tiles_along");
  if (s.folded) return check_lanes(s);
  if (width < e.width)
    too_small("wide", width, e.width,
              "leave width_m and tiles_across of trial.bed out, and the bed is as wide as it must be");
}

/// "between -45 and 45 deg"
std::string range_text(const Variable& v) { return line("between %g and %g %s", v.minimum, v.maximum, v.unit.c_str()); }

}  // namespace

TrialSetup read_trial_setup(const Study& study, const std::filesystem::path& packing_folder, sim::Backend device) {
  TrialSetup s;
  s.settled_on = device;
  s.name = study.name;
  s.seed = study.seed;
  s.gravity = study.gravity;
  s.packing_folder = packing_folder;
  if (study.vehicle.empty())
    study.config.fail("vehicle", "missing; name a vehicle file, for example ../vehicles/hmmwv_quarter.json");
  s.vehicle_file = study.vehicle;
  const auto trial = study.config.object_if("trial");
  if (trial) s.compliant_tyres = trial->boolean_or("compliant_tyres", false);
  read_vehicle_or_family(study, s);
  const Config soil = study.section("soil");
  s.calibration_file = soil.path("calibration");
  s.calibration = terrain::read_calibration(study.file_named("calibration", s.calibration_file));
  soil.finish();
  terrain::AskedNumerics asked;
  if (!s.family) choose_bed(s);
  if (trial) {
    if (const auto c = trial->object_if("bed")) read_bed(*c, s);
    if (const auto c = trial->object_if("drive")) read_drive(*c, s);
    if (const auto c = trial->object_if("numerics")) asked = read_numerics(*c);
    if (const auto c = trial->object_if("thresholds")) read_thresholds(*c, s.thresholds);
    if (const auto c = trial->object_if("task")) read_study_task(study, *c, s);
    s.wheel_rolling = trial->number_or("wheel_rolling", 0, kWheelRollingRange);
    trial->finish();
  }
  s.numerics = terrain::numerics_by_table(s.calibration, s.calibration_file, asked);
  if (s.family) take_largest_member(study, s);
  check_wheels_on_bed(s);
  check_tyres(s);
  if (s.moving_patch) terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  check_sizes(study, s);
  fit_to_task(s);
  check_reach(study, s);
  check_depth(study, s);
  return s;
}

TrialSetup vehicle_trial_setup(const std::filesystem::path& vehicle, const std::filesystem::path& calibration,
                               std::shared_ptr<const TrialTask> task, const terrain::AskedNumerics& asked,
                               const std::filesystem::path& packing_folder) {
  TrialSetup s;
  s.packing_folder = packing_folder;
  s.task = std::move(task);
  s.vehicle_file = vehicle;
  read_vehicle_file(Config::read(vehicle), s);
  s.name = s.vehicle.name;
  s.calibration_file = calibration;
  s.calibration = terrain::read_calibration(calibration);
  s.numerics = terrain::numerics_by_table(s.calibration, calibration, asked);
  if (vehicle::is_quarter(s.vehicle)) {
    if (s.task->obstacle_end() > 0) s.bed_length = std::ceil(2 * s.course(0).front + s.task->obstacle_end() + 1);
    fit_to_task(s);
    return s;
  }
  // Tiles as long as a wheel's influence is wide; as many as the vehicle with its patch and the slab ahead need.
  const Extent e = extent_of(s);
  const double d = s.calibration.grain_diameter, tile = std::max(12 * d, 2 * e.wheel);
  s.bed_length = s.bed_width = tile;
  s.moving_patch = true;
  const double alone = 2 * s.patch().reach, crossing = 2 * e.ends() + s.task->obstacle_end();
  s.tiles_along = int(std::ceil((std::max(alone, crossing) + 2 * e.wheel) / tile));
  s.tiles_across = int(std::ceil((e.width + 2 * e.wheel) / tile));
  s.park_time = 0.5;
  s.run_in_distance = 0.5 * s.vehicle.length;
  s.test_distance = 2 * s.vehicle.length;
  s.time_limit = 15;
  fit_to_task(s);
  terrain::check_patch(s.patch(), d);
  return s;
}

std::vector<double> middle_values(const Study& study) {
  std::vector<double> values(contract().variables.size(), std::nan(""));
  const Config design = study.section("design");
  const auto fixed = design.object_if("fixed"), ranges = design.object_if("ranges");
  for (std::size_t v = 0; v < values.size(); ++v) {
    const std::string& name = contract().variables[v].name;
    if (is_task_variable(contract().variables[v])) values[v] = 0;
    if (fixed && fixed->has(name)) values[v] = fixed->number(name);
    if (ranges && ranges->has(name)) values[v] = 0.5 * (ranges->numbers(name).at(0) + ranges->numbers(name).at(1));
  }
  return values;
}

std::vector<double> usual_values(const TrialSetup& setup) {
  const terrain::AngleRange reach = terrain::reachable_angles(setup.calibration);
  std::vector<double> values(contract().variables.size(), 0);
  const auto set = [&](const char* name, double x) { values[contract().variable_index(name)] = x; };
  set("friction_angle", 0.5 * (reach.lowest + reach.highest));
  set("relative_density", 0.5);
  set("tyre_friction", setup.vehicle.wheel.front().friction);
  set("bed_depth", 0.3);
  set("commanded_speed", 1.5);
  return values;
}

void set_value(std::vector<double>& values, const std::string& name, double value, const std::string& where) {
  const std::size_t v = contract().variable_index(name);
  const Variable& variable = contract().variables[v];
  if (!std::isfinite(value) || !admits(variable, value))
    throw InputError(where + ": the value must be a number " + range_text(variable));
  values[v] = value;
}

void check_all_given(const std::vector<double>& values, const std::string& where) {
  for (std::size_t v = 0; v < values.size(); ++v)
    if (std::isnan(values[v])) {
      const Variable& variable = contract().variables[v];
      throw InputError(where + ": design has neither a fixed value nor a range of " + variable.name + ", " +
                       range_text(variable) + "; give one: --set " + variable.name + "=...");
    }
}

}  // namespace gonogo::campaign
