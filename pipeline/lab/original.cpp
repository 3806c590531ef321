#include "pipeline/lab/original.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "base/units.h"
#include "vehicle/model/statics.h"
#include "vehicle/world/driving.h"

namespace gonogo::lab {
namespace {

struct Column {
  const char* name;
  const char* unit;
  double min, max;
};

/// Wider than what the study sampled: slopes of 0 to 30 degrees, radii of 4 to 30 mm, densities of 1000 to 3000 kg/m^3,
/// friction of 0.2 to 1 and cohesion of 1 to 1000 kPa.
constexpr Column kColumn[] = {{"slope", "deg", -45, 45},
                              {"grain radius", "mm", 0.5, 100},
                              {"density", "kg/m^3", 100, 20000},
                              {"friction", "-", 0, 3},
                              {"cohesion", "kPa", 0, 10000}};

std::vector<double> numbers_of(const std::string& text, const std::string& where) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (*end != 0) throw InputError(where + line(": \"%s\" is not a number", word.c_str()));
  }
  if (numbers.size() != std::size(kColumn))
    throw InputError(where + " has " + std::to_string(numbers.size()) +
                     " numbers; a run has five: slope [deg], grain radius [mm], density [kg/m^3], friction, cohesion "
                     "[kPa]");
  return numbers;
}

}  // namespace

OriginalInput read_original_input(const std::filesystem::path& file, int line) {
  std::ifstream in(file);
  if (!in) throw InputError(file.string() + ": cannot be read");
  std::string text;
  int count = 0;
  while (count < line && std::getline(in, text)) ++count;
  if (line < 1 || count < line)
    throw InputError(file.string() + " has " + std::to_string(count) + " lines, none with the number " +
                     std::to_string(line) + "; lines count from 1");
  const std::string where = file.string() + ", line " + std::to_string(line);
  const std::vector<double> x = numbers_of(text, where);
  for (std::size_t i = 0; i < x.size(); ++i)
    if (!(x[i] >= kColumn[i].min && x[i] <= kColumn[i].max))
      throw InputError(
          where + ": " + kColumn[i].name +
          gonogo::line(" %g %s; allowed are %g to %g", x[i], kColumn[i].unit, kColumn[i].min, kColumn[i].max));
  return {.slope = to_radians(x[0]), .radius = 1e-3 * x[1], .density = x[2], .friction = x[3], .cohesion = 1e3 * x[4]};
}

namespace {

enum Stream : std::uint64_t { first_stream = 1, choice_stream, angle_stream, distance_stream };

/// Square cells so small that each holds one point at most.
class PointGrid {
 public:
  PointGrid(double half_x, double half_y, double apart)
      : half_x_(half_x),
        half_y_(half_y),
        apart_(apart),
        cell_(apart / std::numbers::sqrt2),
        nx_(int(2 * half_x / cell_) + 1),
        ny_(int(2 * half_y / cell_) + 1),
        point_(std::size_t(nx_) * std::size_t(ny_), -1) {}

  bool takes(const std::vector<Vec3d>& points, const Vec3d& p) const {
    if (std::fabs(p.x) > half_x_ || std::fabs(p.y) > half_y_) return false;
    const int i = column(p), j = row(p);
    for (int b = std::max(0, j - 2); b <= std::min(ny_ - 1, j + 2); ++b)
      for (int a = std::max(0, i - 2); a <= std::min(nx_ - 1, i + 2); ++a)
        if (const int other = point_[index(a, b)]; other >= 0 && length(points[std::size_t(other)] - p) < apart_)
          return false;
    return true;
  }

  void put(int number, const Vec3d& p) { point_[index(column(p), row(p))] = number; }

 private:
  int column(const Vec3d& p) const { return std::min(nx_ - 1, int((p.x + half_x_) / cell_)); }
  int row(const Vec3d& p) const { return std::min(ny_ - 1, int((p.y + half_y_) / cell_)); }
  std::size_t index(int i, int j) const { return std::size_t(j) * std::size_t(nx_) + std::size_t(i); }

  double half_x_, half_y_, apart_, cell_;
  int nx_, ny_;
  std::vector<int> point_;
};

void add_wall(const Vec3d& centre, const Vec3& half, sim::SceneWorld& world) {
  sim::Shape s;
  s.type = sim::ShapeType::box;
  s.body = world.add_body({centre, {}, {}, {}}, sim::fixed_body());
  s.material = terrain::base_material;
  s.group = kPassesFloor;
  s.size = half;
  world.add_shape(s);
}

/// Floor with its spheres, centres on it.
void add_floor(const OriginalBin& bin, double radius, sim::SceneWorld& world) {
  sim::Shape s;
  s.body = world.add_body({}, sim::fixed_body());
  s.material = terrain::base_material;
  s.group = kPassesFloor;
  s.type = sim::ShapeType::plane;
  world.add_shape(s);
  s.type = sim::ShapeType::sphere;
  s.size = {Real(radius), 0, 0};
  const double pitch = bin.base_pitch * radius;
  const int nx = int(bin.half_length / pitch), ny = int(bin.half_width / pitch);
  for (int i = -nx; i <= nx; ++i)
    for (int j = -ny; j <= ny; ++j) {
      s.offset_B = {Real(i * pitch), Real(j * pitch), 0};
      world.add_shape(s);
    }
}

void add_walls(const OriginalBin& bin, sim::SceneWorld& world) {
  const double t = bin.half_wall, h = bin.half_height;
  for (const double side : {1.0, -1.0}) {
    add_wall({side * (bin.half_length + t), 0, h}, {Real(t), Real(bin.half_width + 2 * t), Real(h)}, world);
    add_wall({0, side * (bin.half_width + t), h}, {Real(bin.half_length), Real(t), Real(h)}, world);
  }
}

}  // namespace

int layer_count(const OriginalBin& bin, double radius) {
  return std::clamp(int(bin.depth / (2 * radius) + 1e-9), bin.min_layers, bin.max_layers);
}

std::vector<Vec3d> poisson_disk(double half_x, double half_y, double apart, std::uint64_t seed) {
  constexpr int trials = 30;
  PointGrid grid(half_x, half_y, apart);
  std::vector<Vec3d> points{{half_x * (2 * random_unit(seed, first_stream, 0) - 1),
                             half_y * (2 * random_unit(seed, first_stream, 1) - 1), 0}};
  grid.put(0, points[0]);
  std::vector<std::size_t> active{0};
  for (std::uint64_t round = 0; !active.empty(); ++round) {
    const auto chosen = std::size_t(random_unit(seed, choice_stream, round) * double(active.size()));
    const Vec3d around = points[active[chosen]];
    bool found = false;
    for (std::uint64_t t = 0; t < trials && !found; ++t) {
      const std::uint64_t draw = round * trials + t;
      const double angle = 2 * kPi * random_unit(seed, angle_stream, draw);
      // Uniform over the ring between one and two distances.
      const double r = apart * std::sqrt(1 + 3 * random_unit(seed, distance_stream, draw));
      const Vec3d p = around + Vec3d{r * std::cos(angle), r * std::sin(angle), 0};
      if (!grid.takes(points, p)) continue;
      grid.put(int(points.size()), p);
      active.push_back(points.size());
      points.push_back(p);
      found = true;
    }
    if (found) continue;
    active[chosen] = active.back();
    active.pop_back();
  }
  return points;
}

std::vector<Vec3d> dropped_grains(const OriginalBin& bin, double radius, std::uint64_t seed) {
  const double wide = bin.spread * radius;
  std::vector<Vec3d> grains;
  for (int layer = 0; layer < layer_count(bin, radius); ++layer)
    for (const Vec3d& p : poisson_disk(bin.half_length - wide, bin.half_width - wide, 2 * wide, seed + 7919u * layer))
      grains.push_back(p + Vec3d{0, 0, 2 * wide * (layer + 1)});
  return grains;
}

sim::SceneWorld bin_world(const OriginalBin& bin, const OriginalInput& input, double tyre_friction,
                          const std::vector<sim::BodyState>& grain) {
  // How far the domain reaches beyond the bin [m]. A vehicle may slide back until its middle is at the rear wall, and
  // fall out of the bin.
  constexpr double around = 0.5, behind = 3.5, above = 4, below = 6;
  sim::SceneWorld world;
  world.origin = {-bin.half_length - behind, -bin.half_width - around, -below};
  world.size = {2 * bin.half_length + behind + around, 2 * (bin.half_width + around), above + below};
  const sim::PairLaw soil{Real(input.friction), Real(0), Real(input.cohesion)};
  // The larger friction and the smaller cohesion of two materials act; tyres have none.
  const sim::PairLaw tyre{Real(std::max(input.friction, tyre_friction)), 0, 0};
  world.set_law(terrain::grain_material, terrain::grain_material, soil);
  world.set_law(terrain::grain_material, terrain::base_material, soil);
  world.set_law(terrain::grain_material, terrain::tool_material, tyre);
  world.set_law(terrain::base_material, terrain::tool_material, tyre);
  for (const sim::BodyState& g : grain) {
    const sim::BodyIndex b =
        world.add_sphere(g.position, Real(input.radius), Real(input.density), terrain::grain_material);
    world.body[std::size_t(b)] = g;
  }
  add_floor(bin, input.radius, world);
  add_walls(bin, world);
  return world;
}

namespace {

using vehicle::EngineVehicle;
using vehicle::Vehicle;

Vehicle as_in_the_original(Vehicle v) {
  if (v.kind != vehicle::VehicleKind::wheeled || v.driveline.wheel_motors)
    throw InputError("vehicle " + v.name + ": the original study drives a wheeled vehicle with an engine");
  for (vehicle::Wheel& w : v.wheel) {
    w.lug_count = 0;
    w.lug_height = 0;
  }
  for (vehicle::Axle& a : v.axle) a.brake_torque = 0;
  return v;
}

sim::StepSettings settings_of(const OriginalRequest& r) {
  sim::StepSettings s = terrain::bed_step_settings(2 * r.input.radius, r.time.step, r.time.iterations, 1e-3);
  s.envelope = Real(0.1 * r.input.radius);
  // A pull of 1 MPa turns a loose grain 20 m/s faster in a step. The original lets it go; here it crosses one bin.
  s.max_slowed = std::numeric_limits<Index>::max();
  return s;
}

Index steps_in(double time, double step) { return Index(std::lround(time / step)); }

/// Grains settled alone.
std::vector<sim::BodyState> settled(const OriginalRequest& r) {
  std::vector<sim::BodyState> grain;
  for (const Vec3d& p : dropped_grains(r.bin, r.input.radius, r.seed)) grain.push_back({p, {}, {}, {}});
  const auto s =
      sim::make_simulation(r.backend, {bin_world(r.bin, r.input, r.tyre_friction, grain)}, settings_of(r), r.threads);
  s->advance(steps_in(r.time.settle, r.time.step));
  if (const sim::StepReport report = s->report(0); report.flags != 0)
    throw DeviceError("the grains of the bin did not settle: " + sim::description(report.fault, r.time.step));
  const auto bodies = s->bodies(0);
  return {bodies.begin(), bodies.begin() + std::ptrdiff_t(grain.size())};
}

/// The vehicle over the settled grains.
struct Dropped {
  sim::SceneWorld world;
  EngineVehicle e;
  Vec3 origin_B;         // the vehicle's origin in the chassis's frame
  sim::Controller hand;  // of the steering, empty command: there is none
};

sim::Monitor chassis_monitor(const OriginalTimeline& t, sim::BodyIndex chassis) {
  return {.body = chassis,
          .time_limit = t.end - t.settle,
          .distance = t.goal_x - t.start_x,
          .slid_back = t.start_x - t.lost_x};
}

Dropped dropped(const Vehicle& v, const OriginalRequest& r, const std::vector<sim::BodyState>& grain, double surface) {
  Dropped d;
  d.world = bin_world(r.bin, r.input, r.tyre_friction, grain);
  const Vec3d origin{r.time.start_x, 0, surface + r.time.drop};
  const std::size_t shapes = d.world.shape.size();
  d.e = vehicle::add_vehicle(d.world, v, origin, terrain::tool_material);
  std::erase_if(d.world.shape, [&](const sim::Shape& s) { return s.body == d.e.chassis; });
  for (std::size_t i = shapes; i < d.world.shape.size(); ++i) d.world.shape[i].group = kPassesFloor;
  if (vehicle::steers(v)) {
    vehicle::add_steering(d.world, v, d.e, origin);
    d.hand = d.world.controller.back();
  }
  vehicle::DriverOrders orders{.release = r.time.rest, .throttle_ramp = r.time.throttle_ramp};
  vehicle::add_driveline(d.world, v, d.e, orders);
  const sim::BodyState& chassis = d.world.body[std::size_t(d.e.chassis)];
  d.origin_B = rotate_back(chassis.orientation, static_cast<Vec3>(origin - chassis.position));
  d.world.monitor.push_back(chassis_monitor(r.time, d.e.chassis));
  return d;
}

OriginalSample sample_of(const sim::BodyState& chassis, const Dropped& d, const OriginalTimeline& t, double since) {
  OriginalSample s{.time = t.settle + since, .throttle = std::clamp((since - t.rest) / t.throttle_ramp, 0.0, 1.0)};
  const Vec3 arm = rotate(chassis.orientation, d.origin_B);
  s.position = chassis.position + static_cast<Vec3d>(arm);
  s.velocity = static_cast<Vec3d>(chassis.velocity + cross(chassis.angular_velocity, arm));
  if (d.hand.command.empty()) return s;
  const Vec3 forward = rotate(chassis.orientation, d.hand.axis);
  const double beside = chassis.position.y + d.hand.look_ahead * forward.y;
  s.steering = sim::steering_wish(d.hand.proportional, d.hand.max_angle, beside) / d.hand.max_angle;
  return s;
}

OriginalStop stop_of(sim::StopCause cause) {
  if (cause == sim::StopCause::distance) return OriginalStop::max_x;
  if (cause == sim::StopCause::slid_back) return OriginalStop::sliding_backward;
  return cause == sim::StopCause::time_limit ? OriginalStop::max_time : OriginalStop::failed;
}

/// Floor and spheres let tyres through, so that a vehicle that digs itself in falls out of the bin. The original goes
/// on until it is behind lost_x or the time is over. Below the floor nothing touches it: the rest is a parabola.
std::optional<OriginalStop> stop_of_fall(const OriginalSample& s, const OriginalRequest& r) {
  constexpr double kAllBelow = -2.5;  // of the origin: no wheel reaches the floor [m]
  if (s.position.z > kAllBelow) return std::nullopt;
  const double left = r.time.end - s.time, pull = -kGravity * std::sin(r.input.slope);
  const double end_x = s.position.x + left * s.velocity.x + 0.5 * left * left * pull;
  return end_x <= r.time.lost_x ? OriginalStop::sliding_backward : OriginalStop::max_time;
}

}  // namespace

const char* stop_sentence(OriginalStop stop) {
  constexpr const char* kSentences[] = {"Reached maximum x position", "Vehicle sliding backward",
                                        "Reached maximum time", "Simulation failed"};
  return kSentences[int(stop)];
}

OriginalRecord run_original(const Vehicle& vehicle, const OriginalRequest& r) {
  const Vehicle v = as_in_the_original(vehicle);
  const std::vector<sim::BodyState> grain = settled(r);
  OriginalRecord record;
  record.grains = grain.size();
  for (const sim::BodyState& g : grain) record.surface = std::max(record.surface, g.position.z + r.input.radius);
  const Dropped d = dropped(v, r, grain, record.surface);
  const auto s = sim::make_simulation(r.backend, {d.world}, settings_of(r), r.threads);
  const Index every = std::max<Index>(1, steps_in(r.time.output_step, r.time.step));
  const Index tilt = steps_in(r.time.rest, r.time.step);
  for (Index taken = 0;; taken += every) {
    stop_if_cancelled();
    record.sample.push_back(sample_of(s->body(0, d.e.chassis), d, r.time, taken * r.time.step));
    if (r.watch) r.watch(record.sample.back());
    if (const sim::WorldStop stop = s->stop(0); stop.cause != sim::StopCause::none) {
      record.stop = stop_of(stop.cause);
      record.slowed = s->report(0).slowed;
      const sim::StepReport report = s->report(0);
      if (report.flags & sim::flag_left_domain)
        record.stop = stop_of_fall(record.sample.back(), r).value_or(record.stop);
      if (record.stop == OriginalStop::failed) record.fault = sim::description(report.fault, r.time.step);
      return record;
    }
    if (taken == tilt)
      s->set_gravity(0, {Real(-kGravity * std::sin(r.input.slope)), 0, Real(-kGravity * std::cos(r.input.slope))});
    s->advance(every);
  }
}

std::string original_output(const OriginalRecord& record) {
  std::string text;
  for (const OriginalSample& s : record.sample)
    text += line("%.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g %.6g\n", s.time, s.throttle, s.steering, s.position.x,
                 s.position.y, s.position.z, s.velocity.x, s.velocity.y, s.velocity.z);
  return text + "# " + stop_sentence(record.stop) + "\n";
}

}  // namespace gonogo::lab
