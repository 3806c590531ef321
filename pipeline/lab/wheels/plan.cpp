#include "pipeline/lab/wheels/plan.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/campaign/setup/setup.h"
#include "pipeline/lab/validate/trials.h"
#include "terrain/soil/evidence.h"
#include "vehicle/model/assembly.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
namespace {

double or_else(double asked, double usual) { return asked > 0 ? asked : usual; }

void add_ends(std::vector<AssumedCase>& cases, const std::string& name, double low, double high,
              const std::function<void(AssumedCase&, double)>& set) {
  if (low == high) return;
  for (const double end : {low, high}) {
    AssumedCase c = cases.front();
    set(c, end);
    c.what = name + " " + number_text(end);
    cases.push_back(c);
  }
}

/// A wheel under slip angles ploughs. It sinks by up to its radius, and needs a way across for that.
bool ploughs(const Benchmark& b) { return b.leads(Quantity::slip_angle); }

/// Grains larger than lugs fill the room between them and make a wheel as large as their tips: its pull grows by up to
/// a third (docs/log/wheels_why.md). Across its way a wheel is wider than along it.
double usual_grain(const Benchmark& b, const vehicle::Wheel& wheel) {
  const double coarse = wheel.width / (ploughs(b) ? 8 : 10), fine = wheel.width / 20;
  return wheel.lug_count > 0 ? std::clamp(wheel.lug_height, fine, coarse) : coarse;
}

/// As far across the way as the wheel reaches at its steepest slip angle, pressed in by a quarter of its radius.
double width_across(const Benchmark& b, const vehicle::Wheel& wheel) {
  double width = wheel.width;
  if (!b.leads(Quantity::slip_angle)) return width;
  const double chord = 2 * std::sqrt(1 - 0.75 * 0.75) * (wheel.radius + wheel.lug_height);
  for (const BenchmarkPoint& p : b.point) {
    const double angle = std::fabs(to_radians(p.led.at(Quantity::slip_angle)));
    width = std::max(width, wheel.width * std::cos(angle) + chord * std::sin(angle));
  }
  return width;
}

/// Rim speed over sqrt(g r) at which inertia does not matter yet: what moves at it rises by a thirtieth of a radius.
constexpr double kSlowest = 0.25;

campaign::TrialSetup setup_of(const Benchmark& b, const WheelRun& run) {
  if (!b.vehicle_file.empty())
    return campaign::vehicle_trial_setup(b.vehicle_file, run.calibration, campaign::default_task(), run.numerics);
  campaign::TrialSetup s;
  s.packing_folder = campaign::default_packing_folder();
  s.name = b.name;
  s.vehicle = b.vehicle;
  s.calibration_file = run.calibration;
  s.calibration = terrain::read_calibration(run.calibration);
  s.numerics = terrain::numerics_by_table(s.calibration, run.calibration, run.numerics);
  return s;
}

/// Trials that drive for the bed's time, whatever happens, on a moving patch.
campaign::TrialSetup setup_on(const Benchmark& b, const WheelRun& run, const WheelBed& bed) {
  campaign::TrialSetup s = setup_of(b, run);
  s.calibration.grain_diameter = bed.grain;
  s.wheel_rolling = run.wheel_rolling;
  s.settled_on = run.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  s.tiles_along = s.tiles_across = 1;
  s.moving_patch = true;
  if (is_whole(b)) campaign::fold_bed(s);
  s.bed_length = bed.length;
  s.bed_width = or_else(bed.width, s.bed_width);
  s.packing_seeds = run.seeds;
  s.test_distance = 1e3;
  s.min_drive_time = s.time_limit = bed.time;
  s.run_in_distance = 0;
  s.thresholds.immobile_speed = 0;
  s.thresholds.slid_back_share = 10;
  // So slow a wheel does little work: pushing settled grains apart by a hair is much beside it.
  s.thresholds.energy_error = 10;
  if (s.folded) campaign::check_lanes(s);
  terrain::check_patch(s.patch(), bed.grain);
  return s;
}

/// What the carriage does at a point.
std::shared_ptr<const campaign::TrialTask> task_at(const Benchmark& b, const BenchmarkPoint& p) {
  if (!b.leads(Quantity::slip)) return campaign::default_task();
  const double slip = p.led.at(Quantity::slip), led = slip < 0 ? slip / (1 + slip) : slip;  // 1 - v / (w r)
  const auto rounded = [](double x) { return std::round(1e6 * x) / 1e6; };  // as a task is written on a command line
  std::optional<double> angle;
  if (b.leads(Quantity::slip_angle)) angle = to_radians(rounded(p.led.at(Quantity::slip_angle)));
  return campaign::single_wheel_task(rounded(slip_of_rim(b, wheel_of(b), led)), angle);
}

std::vector<double> variables_at(const Benchmark& b, const BenchmarkPoint& p, const campaign::TrialSetup& setup,
                                 const AssumedCase& c, double depth) {
  const double slope = b.leads(Quantity::slope) ? p.led.at(Quantity::slope) : 0;
  std::vector<double> values = plain_variables(setup, slope, c.soil.friction_angle, rim_speed_of(b));
  const auto set = [&](const char* name, double value) { values[campaign::contract().variable_index(name)] = value; };
  set("relative_density", c.soil.relative_density);
  set("cohesion", 1e-3 * c.soil.cohesion);
  set("tyre_friction", c.wheel_friction);
  set("bed_depth", depth);
  if (b.vehicle_file.empty())
    set("payload", std::max(0.0, load_at(b, p) / kGravity - vehicle::weigh(setup.vehicle).total));
  return values;
}

/// Time of a led wheel [s]. The last half of a trial counts. So its middle is at three quarters of the way, where the
/// experiment was averaged, if the benchmark says where: soil heaps up before a ploughing wheel all the way. If not,
/// `time`, or for ploughing wheels up to twice as much, for the carriage to move by three radii.
double led_time(const Benchmark& b, const BenchmarkPoint& p, double time, bool quick) {
  const double slip = std::clamp(p.led.at(Quantity::slip), 0.0, 0.99);
  const double carriage_speed = (1 - slip) * rim_speed_of(b);
  if (b.way > 0 && !quick) return b.way / 0.75 / carriage_speed;
  return ploughs(b) ? std::clamp(3 * wheel_of(b).radius / carriage_speed, time, 2 * time) : time;
}

void add_case(const Benchmark& b, std::size_t index, std::size_t of_case, const AssumedCase& c, const WheelRun& run,
              const campaign::TrialSetup& base, WheelPlan& plan) {
  const double density = terrain::fit_soil(base.calibration, c.soil).grain_density;
  for (std::size_t at = 0; at < b.point.size(); ++at) {
    const BenchmarkPoint& p = b.point[at];
    // Trials on slopes share one setup; a carriage makes each its own.
    if (at == 0 || b.leads(Quantity::slip)) {
      plan.setup.push_back(std::make_unique<campaign::TrialSetup>(base));
      plan.setup.back()->grain_density = density;
      plan.setup.back()->task = task_at(b, p);
      if (run.time <= 0 && b.leads(Quantity::slip))
        plan.setup.back()->min_drive_time = plan.setup.back()->time_limit =
            led_time(b, p, base.min_drive_time, run.quick);
    }
    const campaign::TrialSetup& setup = *plan.setup.back();
    const double depth = plan.outcome[index].bed.depth;
    for (campaign::DesignPoint& point : replicates(variables_at(b, p, setup, c, depth), run.seeds))
      plan.trial.push_back({&setup, std::move(point), index, at, of_case});
  }
}

void add_benchmark(const Benchmark& b, std::size_t index, const WheelRun& run, WheelPlan& plan) {
  const vehicle::Wheel& wheel = wheel_of(b);
  WheelOutcome o;
  o.bed = bed_of(b, run);
  o.grains_per_width = wheel.width / o.bed.grain;
  o.lug_grains = lug_grains(wheel, o.bed.grain);
  const campaign::TrialSetup base = setup_on(b, run, o.bed);
  std::vector<AssumedCase> cases = cases_of(b, base.calibration, run.band && !run.quick);
  if (run.wheel_friction)
    for (AssumedCase& c : cases) c.wheel_friction = *run.wheel_friction;
  for (std::size_t k = 1; k < cases.size(); ++k) o.varied.push_back(cases[k].what);
  plan.outcome.push_back(o);
  plan.rim_speed.push_back(rim_speed_of(b));
  plan.tip_speed.push_back(rim_speed_of(b) / wheel.radius * (wheel.radius + wheel.lug_height));
  for (std::size_t k = 0; k < cases.size(); ++k) add_case(b, index, k, cases[k], run, base, plan);
}

}  // namespace

double load_at(const Benchmark& b, const BenchmarkPoint& p) {
  if (const auto own = p.led.find(Quantity::load); own != p.led.end()) return own->second;
  if (b.load > 0) return b.load;
  const double slope = b.leads(Quantity::slope) ? to_radians(p.led.at(Quantity::slope)) : 0;
  return vehicle::weigh(b.vehicle).total * kGravity * std::cos(slope) / double(vehicle::stations(b.vehicle).size());
}

double mean_stress(const Benchmark& b) {
  double load = 0;
  for (const BenchmarkPoint& p : b.point) load += load_at(b, p) / double(b.point.size());
  const vehicle::Wheel& wheel = wheel_of(b);
  return load / (wheel.width * 0.5 * wheel.radius);
}

terrain::MacroscopicSoil acting_soil(const Benchmark& b, terrain::MacroscopicSoil measured) {
  const auto tested = terrain::tested_stresses(b.soil);
  return tested ? terrain::at_stress(measured, *tested, mean_stress(b)) : measured;
}

std::string strength_remark(const Benchmark& b) {
  if (b.soil.cohesion.middle() <= 0) return "";
  const double stress = mean_stress(b) / 1e3;
  const auto tested = terrain::tested_stresses(b.soil);
  if (!tested)
    return line("cohesion is taken as it is at the wheel's %.3g kPa: the soil's test does not say its normal stresses",
                stress);
  const terrain::MacroscopicSoil there = acting_soil(b, b.soil.macroscopic());
  if (there.cohesion == b.soil.macroscopic().cohesion) return "";
  return line(
      "a power law through the ends of the tested envelope, %.3g to %.3g kPa, is assumed at the wheel's %.3g kPa: "
      "%.1f deg and %.2f kPa",
      tested->minimum / 1e3, tested->maximum / 1e3, stress, there.friction_angle, there.cohesion / 1e3);
}

double lug_grains(const vehicle::Wheel& wheel, double grain) {
  return wheel.lug_count > 0 ? wheel.lug_height / (0.5 * grain) : 0;
}

double slip_from_rim(const Benchmark& b, const vehicle::Wheel& w, double slip) {
  return b.slip_at_lugs ? 1 - (1 - slip) * w.radius / (w.radius + w.lug_height) : slip;
}

double slip_of_rim(const Benchmark& b, const vehicle::Wheel& w, double slip) {
  return b.slip_at_lugs ? 1 - (1 - slip) * (w.radius + w.lug_height) / w.radius : slip;
}

double sinkage_from_tips(const Benchmark& b, const vehicle::Wheel& w, double sinkage) {
  return b.sinkage_from_lugs ? sinkage : sinkage - w.lug_height;
}

std::vector<AssumedCase> cases_of(const Benchmark& b, const terrain::Calibration& calibration, bool band) {
  std::vector<AssumedCase> cases{
      {"", b.wheel_friction.value, terrain::as_triaxial(calibration, acting_soil(b, b.soil.macroscopic()))}};
  if (!band) return cases;
  // The measured soil with one of its numbers at an end.
  const auto altered = [&](double terrain::MacroscopicSoil::*member, double x) {
    terrain::MacroscopicSoil soil = b.soil.macroscopic();
    soil.*member = x;
    return terrain::as_triaxial(calibration, acting_soil(b, soil));
  };
  const terrain::SoilState& s = b.soil;
  add_ends(cases, "wheel friction", b.wheel_friction.low, b.wheel_friction.high,
           [](AssumedCase& c, double x) { c.wheel_friction = x; });
  add_ends(cases, "friction angle", s.friction_angle.low, s.friction_angle.high,
           [&](AssumedCase& c, double x) { c.soil = altered(&terrain::MacroscopicSoil::friction_angle, x); });
  add_ends(cases, "cohesion [kPa]", s.cohesion.low, s.cohesion.high,
           [&](AssumedCase& c, double x) { c.soil = altered(&terrain::MacroscopicSoil::cohesion, 1e3 * x); });
  add_ends(cases, "bulk density", s.bulk_density.low, s.bulk_density.high,
           [](AssumedCase& c, double x) { c.soil.bulk_density = x; });
  add_ends(cases, "relative density", s.relative_density.low, s.relative_density.high,
           [](AssumedCase& c, double x) { c.soil.relative_density = x; });
  // Relative density acts through the packing nearest to it, of which a table has a few.
  const std::size_t usual = terrain::packing_level(calibration, cases.front().soil);
  std::erase_if(cases, [&](const AssumedCase& c) {
    return c.what.rfind("relative density", 0) == 0 && terrain::packing_level(calibration, c.soil) == usual;
  });
  // The nominal value may be an end itself.
  std::erase_if(cases, [&](const AssumedCase& c) {
    return c.what.rfind("wheel friction", 0) == 0 && c.wheel_friction == b.wheel_friction.value;
  });
  return cases;
}

double rim_speed_of(const Benchmark& b) {
  const double radius = wheel_of(b).radius;
  return std::max(b.rim_turning * radius, kSlowest * std::sqrt(kGravity * radius));
}

WheelBed bed_of(const Benchmark& b, const WheelRun& run) {
  const vehicle::Wheel& wheel = wheel_of(b);
  const double reach = wheel.radius + wheel.lug_height;
  const bool whole = is_whole(b);
  WheelBed bed;
  bed.grain = or_else(run.grain, run.quick ? wheel.width / 5 : usual_grain(b, wheel));
  bed.length = or_else(run.length, (whole ? 14 : run.quick ? 6 : 8) * reach);
  bed.width = or_else(run.width, whole ? 0 : (run.quick ? 2.5 : 3.5) * width_across(b, wheel));
  bed.depth = or_else(run.depth, (run.quick ? 0.6 : 0.8) * (ploughs(b) ? 2 : 1) * reach);
  const double way = 6.4 * wheel.radius * (whole ? 2 : 1) * (run.quick ? 0.5 : 1);
  bed.time = or_else(run.time, way / rim_speed_of(b));
  return bed;
}

WheelPlan plan_wheels(const std::vector<Benchmark>& benchmarks, const WheelRun& run) {
  WheelPlan plan;
  for (std::size_t i = 0; i < benchmarks.size(); ++i) try {
      add_benchmark(benchmarks[i], i, run, plan);
    } catch (const InputError& error) {
      throw InputError("benchmark " + benchmarks[i].name + ": " + error.what());
    }
  return plan;
}

}  // namespace gonogo::lab
