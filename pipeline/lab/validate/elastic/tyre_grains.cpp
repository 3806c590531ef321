// The ring on grains, beside the compliant tyre of the engine and a rigid wheel: each sinks into the same settled bed
// under half the nominal load of the measured tyre and rolls on without slip.
#include <algorithm>
#include <numeric>

#include "base/format.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/measured_tyre.h"
#include "pipeline/lab/validate/elastic/parts.h"
#include "sim/elastic/tyre/on_grains.h"
#include "sim/scene/penalty_setup.h"
#include "terrain/bed/bed.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
namespace {

namespace measured = measured_tyre;

constexpr double kLoad = measured::kLoad / 2;                // [N]
constexpr double kGrain = 0.03, kStart = 0.25;               // diameter; of the hub at the start [m]
constexpr double kSettle = 0.3, kRoll = 0.5, kCount = 0.25;  // at rest; rolling; of which count [s]
constexpr double kSlow = 1;                                  // [m/s]
constexpr double kLoss = 0.16;                               // as elastic_tyre_rolling() fits it [-]
constexpr double kGrainFriction = 0.8, kRolling = 0.2;       // of grains [-]

/// One wheel on the bed.
struct OnBed {
  std::string name;
  double sinkage = 0;                // drop of the hub since touch, at rest [m]
  double rolling = 0;                // the same, rolling [m]
  double pull = 0, load = 0;         // rolling, means [N]
  double length = 0;                 // of the ground that bears nine tenths of the load, rolling [m]
  std::vector<double> x{}, force{};  // contacts, rolling: place before the hub [m], upward force [N]

  void add(double place, double upward) {
    x.push_back(place);
    force.push_back(upward);
  }
};

struct Bed {
  sim::SceneWorld world;
  sim::StepSettings settings;
  double top = 0;  // highest grain [m]
};

Bed settled_bed(const sim::PairLaw& tool) {
  static const terrain::Packing packing =
      terrain::settle_packing({.length = 0.9, .width = 0.15, .depth = 0.11, .grain_diameter = kGrain, .seed = 3}, 1);
  const sim::PairLaw grain{.friction = Real(kGrainFriction), .rolling_friction = Real(kRolling)};
  Bed bed{terrain::bed_world(packing, {grain, tool}, 1), {}, terrain::highest_point(packing)};
  bed.settings = terrain::bed_step_settings(kGrain, 1e-3, 1);
  bed.settings.contact = sim::ContactLaw::spring_damper;
  bed.settings.penalty = sim::law_of_overlap(0.03, 2, kGrain / 2, 2650, 0.3);
  bed.settings.cohesion_range = 0;
  bed.settings.step = Real(0.7 * sim::critical_step(bed.world, bed.settings).step);
  return bed;
}

/// Length about the middle that bears nine tenths: from the 5 % to the 95 % quantile of the force.
double bearing_length(const std::vector<double>& x, const std::vector<double>& force) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  const double all = std::accumulate(force.begin(), force.end(), 0.0);
  double sum = 0, from = 0, to = 0;
  for (const std::size_t i : order) {
    if (sum < 0.05 * all) from = x[i];
    if (sum < 0.95 * all) to = x[i];
    sum += force[i];
  }
  return to - from;
}

OnBed ring_on_bed() {
  Bed bed = settled_bed({.friction = Real(kGrainFriction)});
  el::Tyre tyre = fitted_tyre(240);
  tyre.nodes = 96;
  tyre.loss = kLoss;
  const double height = bed.top + tyre.radius + 2e-3, step = double(bed.settings.step);
  el::TyreOnGrains both(tyre, {.load = kLoad, .mass = kLoad / kGravity, .damping = 1500},
                        {.world = bed.world,
                         .settings = bed.settings,
                         .material = terrain::tool_material,
                         .x = kStart,
                         .y = 0.075,
                         .height = height});
  OnBed found{.name = "ring"};
  both.advance(std::lround(kSettle / step));
  found.sinkage = bed.top + tyre.radius - both.tyre().rim().y;
  both.tyre().set_motion(kSlow, -kSlow / measured::rolling_radius(kLoad));
  both.advance(std::lround((kRoll - kCount) / step));
  const long count = std::lround(kCount / step);
  for (long i = 0; i < count; i += 50) {
    const el::TreadLoad now = both.advance(50);
    const double share = 50.0 / double(count);
    found.pull += share * now.forward;
    found.load += share * now.upward;
    found.rolling += share * (bed.top + tyre.radius - both.tyre().rim().y);
    for (std::size_t k = 0; k < now.x.size(); ++k) found.add(now.x[k], share * now.force[k]);
  }
  found.length = bearing_length(found.x, found.force);
  return found;
}

/// Adds one moment of the rolling wheel.
void sample(OnBed& found, sim::Simulation& simulation, sim::BodyIndex wheel, double touch, double share) {
  const Vec3d f = simulation.contact_force(0, wheel);
  found.pull += share * f.x;
  found.load += share * f.z;
  found.rolling += share * (touch - simulation.body(0, wheel).position.z);
  const auto contacts = simulation.contacts(0);
  const auto impulses = simulation.impulses(0);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const bool is_a = contacts[k].body_a == wheel, is_b = contacts[k].body_b == wheel;
    if (is_a || is_b)
      found.add(double((is_a ? contacts[k].arm_a : contacts[k].arm_b).x),
                share * (is_a ? 1 : -1) * double(impulses[k].linear.z) / simulation.settings().substep());
  }
}

/// The wheel of the engine, on springs where `spring` has stiffness.
OnBed wheel_on_bed(const std::string& name, const vehicle::LinearSpring& spring, double width) {
  Bed bed = settled_bed(
      {.friction = Real(kGrainFriction), .stiffness = Real(spring.stiffness), .damping = Real(spring.damping)});
  sim::BodyMass mass = sim::fixed_body();
  mass.inverse_mass.z = Real(kGravity / kLoad);
  const double touch = bed.top + measured::kRadius;
  sim::Shape s;
  s.type = sim::ShapeType::wheel;
  s.material = terrain::tool_material;
  s.size = {Real(measured::kRadius), Real(width / 2), 0};
  s.body = bed.world.add_body({{kStart, 0.075, touch + 2e-3}, {}, {}, {}}, mass);
  bed.world.add_shape(s);
  bed.settings.step = Real(0.9 * sim::critical_step(bed.world, bed.settings).step);
  const double step = double(bed.settings.step);
  const auto simulation = sim::make_simulation(sim::Backend::cpu, {bed.world}, bed.settings, 1);
  simulation->advance(Index(std::lround(kSettle / step)));
  sim::BodyState state = simulation->body(0, s.body);
  OnBed found{.name = name, .sinkage = touch - state.position.z};
  state.velocity.x = Real(kSlow);
  state.angular_velocity.y = Real(kSlow / measured::kRadius);
  simulation->set_body(0, s.body, state);
  simulation->advance(Index(std::lround((kRoll - kCount) / step)));
  const long count = std::lround(kCount / step) / 10;
  for (long i = 0; i < count; ++i) {
    simulation->advance(10);
    sample(found, *simulation, s.body, touch, 1.0 / double(count));
  }
  found.length = bearing_length(found.x, found.force);
  return found;
}

report::PlotLine histogram(const OnBed& wheel) {
  constexpr double kBin = 0.02;
  report::PlotLine l{.label = wheel.name};
  for (double x = -0.15; x < 0.15; x += kBin) {
    double sum = 0;
    for (std::size_t i = 0; i < wheel.x.size(); ++i)
      if (wheel.x[i] >= x && wheel.x[i] < x + kBin) sum += wheel.force[i];
    l.add(1e3 * (x + kBin / 2), sum / (kBin * 1e3));
  }
  return l;
}

}  // namespace

CheckFigure elastic_tyre_grains() {
  vehicle::Wheel tyre;
  tyre.radius = measured::kRadius;
  tyre.width = measured::contact_width(measured::kLoad, measured::kPressure);
  tyre.compliant = {kLoad / measured::deflection(kLoad, measured::kPressure), 2000};
  const std::vector<OnBed> wheels{
      ring_on_bed(),
      wheel_on_bed("compliant tyre of the engine", vehicle::contact_spring(tyre, kLoad, kGrain), tyre.width),
      wheel_on_bed("rigid wheel", {}, tyre.width)};
  CheckFigure figure =
      figure_of("elastic_tyre_grains", "wheel,sinkage_m,rolling_sinkage_m,pull_n,load_n,bearing_length_m\n");
  for (const OnBed& w : wheels) {
    figure.csv += line("%s,%.5g,%.5g,%.5g,%.5g,%.5g\n", w.name.c_str(), w.sinkage, w.rolling, w.pull, w.load, w.length);
    figure.plot.lines.push_back(histogram(w));
  }
  const OnBed &ring = wheels[0], &compliant = wheels[1], &rigid = wheels[2];
  figure.check = {
      {"grains_load_ratio", "Tyre on grains: force of the grains over the load, rolling", 0.9, 1.1, ring.load / kLoad},
      {"grains_ring_resistance", "Tyre on grains: towing force over load at no slip", 0, 0.15, -ring.pull / ring.load},
      {"grains_compliant_resistance", "Compliant tyre on grains: towing force over load", 0, 0.15,
       -compliant.pull / compliant.load},
      {"grains_rigid_resistance", "Rigid wheel on grains: towing force over load", 0.07, 0.25,
       -rigid.pull / rigid.load},
      {"grains_length_ratio", "Bearing length of the compliant tyre over the ring's", 0.7, 2.5,
       compliant.length / ring.length}};
  figure.plot = plot_of("Wheels rolling on 30 mm grains under 2 kN", "place before the hub [mm]",
                        "load per length [N/mm]", figure.plot.lines);
  return figure;
}

}  // namespace gonogo::lab
