#include "pipeline/lab/scenes/screen.h"

#include <algorithm>
#include <cmath>

#include "base/math/random.h"
#include "base/units.h"
#include "sim/scene/scene.h"

namespace gonogo::lab {
namespace {

constexpr double kSizeRatio = 2;                  // of large spheres to small ones; a lattice cell holds 1 or 8
constexpr double kOpening = 1.4, kBarHalf = 0.3;  // between bars; half of their width; in small diameters
constexpr double kSlope = kPi / 4;                // of the deck's stroke
constexpr double kLengthOverWidth = 3, kFeedLength = 0.4;  // of the deck; of the feed over the deck's length
constexpr double kBinLength = 0.5;                         // for what goes over, in lengths of the deck
constexpr double kFeedHeight = 0.5;                        // over the deck's width
constexpr double kSettle = 0.5;                            // time in which the feed comes to rest on the deck [s]
constexpr double kRunUp = 0.5;                             // of the motor [s]
constexpr int kMachine = 2;                                // material
constexpr std::int32_t kMachineGroup = 1;

double pitch(const ScreenSpec& spec) { return kSizeRatio * spec.of.pitch(); }
double depth(const ScreenSpec& spec) { return 0.7 * spec.width(); }  // of the bin under the deck
double bars_apart(const ScreenSpec& spec) { return (kOpening + 2 * kBarHalf) * spec.of.diameter; }
double thickness(const ScreenSpec& spec) { return 2 * kBarHalf * spec.of.diameter; }

/// Where the deck begins along x, before its rear wall, at the start and at the furthest forward [m].
double deck_rear(const ScreenSpec& spec) { return thickness(spec) + 2 * spec.crank(); }

struct Kinds {
  std::vector<Sphere> sphere;
  std::vector<bool> is_large;
};

/// One large sphere, or eight small ones.
void fill_cell(const ScreenSpec& spec, const Vec3d& corner, bool large, std::uint64_t& draw, Kinds& feed) {
  const int per_side = large ? 1 : 2;
  const double edge = pitch(spec) / per_side, diameter = large ? kSizeRatio * spec.of.diameter : spec.of.diameter;
  for (int k = 0; k < per_side * per_side * per_side && Index(feed.sphere.size()) < spec.of.count; ++k) {
    const double size = 1 + spec.of.size_spread * (2 * random_unit(spec.of.seed, 0, draw++) - 1);
    const int row = k / 2 % 2, layer = k / 4;
    const Vec3d at{(k % 2 + 0.5) * edge, (row + 0.5) * edge, (layer + 0.5) * edge};
    feed.sphere.push_back({corner + at, diameter / 2 * size});
    feed.is_large.push_back(large);
  }
}

/// Layer by layer over the rear of the deck.
Kinds loose_feed(const ScreenSpec& spec) {
  const auto across = std::max<Index>(1, Index(spec.width() / pitch(spec)));
  const auto along = std::max<Index>(1, Index(kFeedLength * spec.length() / pitch(spec)));
  Kinds feed;
  std::uint64_t draw = 0;
  for (Index cell = 0; Index(feed.sphere.size()) < spec.of.count; ++cell) {
    const Index layer = cell / along / across;
    const Vec3d corner{deck_rear(spec) + (cell % along) * pitch(spec),
                       (cell / along % across - 0.5 * across) * pitch(spec), thickness(spec) / 2 + layer * pitch(spec)};
    fill_cell(spec, corner, random_unit(spec.of.seed, 1, std::uint64_t(cell)) < spec.large_share, draw, feed);
  }
  return feed;
}

void add_machine_shape(sim::SceneWorld& world, sim::Shape s) {
  s.material = kMachine;
  s.group = kMachineGroup;
  world.add_shape(s);
}

sim::Shape box(sim::BodyIndex body, const Vec3& offset, const Vec3& half) {
  sim::Shape s;
  s.type = sim::ShapeType::box;
  s.body = body;
  s.offset_B = offset;
  s.size = half;
  return s;
}

/// Solid box's inertia.
sim::BodyMass solid_box(double mass, double x, double y, double z) {
  const double c = mass / 12;
  return sim::solid(Real(mass), {Real(c * (y * y + z * z)), Real(c * (x * x + z * z)), Real(c * (x * x + y * y))});
}

/// Torque of the motor: several times what holds the deck with all of the feed on it, and throws it.
double torque_of(const ScreenSpec& spec, double mass) {
  return 10 * mass * spec.crank() * (kGravity + spec.crank() * std::pow(spec.crank_speed(), 2));
}

/// Bars along x, held by three beams below, and a rear wall, so that nothing gets between the deck and what stands
/// still; its origin is the middle of the bars.
void add_deck(sim::SceneWorld& world, const ScreenSpec& spec, double wall_height, double mass) {
  const double d = spec.of.diameter, length = spec.length(), width = spec.width(), apart = bars_apart(spec);
  const sim::BodyIndex deck = world.add_body({{deck_rear(spec) + length / 2, 0, 0}, {}, {}, {}},
                                             solid_box(mass, length, width, thickness(spec)));
  const auto bars = int(std::lround(width / apart)) + 1;
  const Real thin = Real(thickness(spec) / 2);
  for (int k = 0; k < bars; ++k)
    add_machine_shape(world, box(deck, {0, Real((k - 0.5 * (bars - 1)) * apart), 0}, {Real(length / 2), thin, thin}));
  const double half = 0.2 * d;
  for (const double at : {-0.5, 0.0, 0.5})
    add_machine_shape(world, box(deck, {Real(at * (length - d)), 0, Real(-(kBarHalf * d + half))},
                                 {Real(half), Real(width / 2), Real(half)}));
  const Real tall = Real(wall_height / 2);
  add_machine_shape(world, box(deck, {Real(-length / 2) - thin, 0, tall}, {thin, Real(width / 2), tall}));
}

/// Crank and rod, the rod along the stroke with its far end on the deck, and the joints and the motor between them. The
/// universal joint keeps the rod from turning about itself.
void add_crank(sim::SceneWorld& world, const ScreenSpec& spec, const ScreenParts& parts, const Vec3d& deck_pin,
               double mass) {
  const Vec3d stroke = parts.stroke, across{0, 1, 0}, pin = deck_pin - parts.rod_length * stroke,
              axle = pin - spec.crank() * stroke;
  const double r = 2 * spec.crank(), w = thickness(spec);
  sim::Shape disc;
  disc.type = sim::ShapeType::cylinder;
  disc.size = {Real(r), Real(w / 2), 0};
  disc.body = world.add_body({axle, {}, {}, {}}, solid_box(0.1 * mass, r, w, r));
  add_machine_shape(world, disc);
  sim::Shape rod;
  rod.type = sim::ShapeType::capsule;
  rod.size = {Real(spec.crank() / 2), Real(parts.rod_length / 2), 0};
  const Real c = Real(std::sqrt(0.5));
  rod.turn_B = {c, c * Real(stroke.z), 0, -c * Real(stroke.x)};  // its axis, y, along the stroke
  rod.body = world.add_body({0.5 * (pin + deck_pin), {}, {}, {}},
                            solid_box(0.1 * mass, parts.rod_length, w, parts.rod_length));
  add_machine_shape(world, rod);
  const sim::Joint crank = sim::revolute(world, parts.crank, parts.ground, axle, across);
  world.joint = {crank, sim::prismatic(world, parts.deck, parts.ground, deck_pin, stroke),
                 sim::spherical(world, parts.rod, parts.crank, pin),
                 sim::universal(world, parts.rod, parts.deck, deck_pin, cross(stroke, across), across)};
  world.motor = {sim::speed_motor(crank, 0, torque_of(spec, mass))};
}

/// Where things end along x and z [m].
struct Bounds {
  double wall_x, wall_top, end_x, floor_z;  // of the wall between the bins, of the second bin, of both
};

/// The wall begins under the front edge where that is furthest back. There is room for a small sphere everywhere
/// between the wall and the deck.
Bounds bounds_of(const ScreenSpec& spec) {
  const double wall = deck_rear(spec) + spec.length() - 2 * spec.crank();
  return {wall, -(thickness(spec) + 2 * spec.crank() + 2 * spec.of.diameter), wall + kBinLength * spec.length(),
          -depth(spec)};
}

/// Floor, sides, rear and end, and the wall between the bins.
void add_ground(sim::SceneWorld& world, const ScreenSpec& spec, const Bounds& at) {
  const sim::BodyIndex ground = world.add_body({}, sim::fixed_body());
  const double half = spec.width() / 2;
  add_plane(world, ground, {0, 0, at.floor_z}, {});
  add_plane(world, ground, {0, -half, 0}, towards(1, 1));
  add_plane(world, ground, {0, half, 0}, towards(1, -1));
  add_plane(world, ground, {}, towards(0, 1));
  add_plane(world, ground, {at.end_x, 0, 0}, towards(0, -1));
  for (std::size_t k = world.shape.size() - 5; k < world.shape.size(); ++k) {
    world.shape[k].material = kMachine;
    world.shape[k].group = kMachineGroup;
  }
  const double thick = thickness(spec) / 2, tall = (at.wall_top - at.floor_z) / 2;
  add_machine_shape(world, box(ground, {Real(at.wall_x + thick), 0, Real(at.wall_top - tall)},
                               {Real(thick), Real(half), Real(tall)}));
}

/// What has gone where [-].
struct Sorted {
  double small_through = 0, large_through = 0, large_over = 0;
};

Sorted sort_of(const std::vector<sim::BodyState>& bodies, const std::vector<bool>& is_large, const Bounds& at) {
  double count[2] = {}, through[2] = {}, over[2] = {};
  for (std::size_t b = 0; b < is_large.size(); ++b) {
    const Vec3d& p = bodies[b].position;
    ++count[is_large[b]];
    if (p.x >= at.wall_x)
      ++over[is_large[b]];
    else if (p.z < at.wall_top)
      ++through[is_large[b]];
  }
  return {through[0] / count[0], through[1] / count[1], over[1] / count[1]};
}

}  // namespace

/// Cells over a share of the deck: kFeedLength * length * width * kFeedHeight * width / pitch^3; whole bars.
double ScreenSpec::width() const {
  const double per_cell = large_share + 8 * (1 - large_share), apart = bars_apart(*this);
  const double cells = double(of.count) / per_cell / (kFeedLength * kLengthOverWidth * kFeedHeight);
  return apart * std::max(3.0, std::ceil(pitch(*this) * std::cbrt(cells) / apart));
}

double ScreenSpec::length() const { return kLengthOverWidth * width(); }

double ScreenSpec::crank() const { return 0.25 * of.diameter; }

double ScreenSpec::crank_speed() const { return std::sqrt(throw_number * kGravity / (crank() * std::sin(kSlope))); }

ScreenParts screen_parts(const ScreenSpec& spec) {
  const sim::BodyIndex ground = spec.of.count;
  return {.ground = ground,
          .deck = ground + 1,
          .crank = ground + 2,
          .rod = ground + 3,
          .stroke = {std::cos(kSlope), 0, std::sin(kSlope)},
          .rod_length = 20 * spec.crank()};
}

ManyScene screen_scene(const ScreenSpec& spec, const RunOn& on) {
  ManyScene scene;
  scene.name = "screen";
  scene.settings = many_step_settings(spec.of, on.iterations, on.solver);
  scene.show_by_material = true;
  scene.duration = kSettle + kRunUp + spec.shaken;
  sim::SceneWorld& world = scene.world;
  for (int a = 0; a <= kMachine; ++a)
    for (int b = a; b <= kMachine; ++b) world.set_law(a, b, {Real(spec.of.friction), 0, 0});
  const Kinds feed = loose_feed(spec);
  double mass = 0;
  for (std::size_t k = 0; k < feed.sphere.size(); ++k) {
    const Sphere& s = feed.sphere[k];
    world.add_sphere(s.centre, Real(s.radius), Real(spec.of.density), feed.is_large[k] ? 1 : 0);
    mass += spec.of.density * 4.0 / 3 * kPi * s.radius * s.radius * s.radius;
  }
  const ScreenParts parts = screen_parts(spec);
  const Bounds at = bounds_of(spec);
  const double rear = parts.rod_length + 6 * spec.crank(), side = spec.width() / 2 + spec.of.diameter;
  const double below = std::max(-at.floor_z, rear) + spec.of.diameter, above = height_of(feed.sphere) + spec.width();
  world.origin = {-rear, -side, -below};
  world.size = {rear + at.end_x + spec.of.diameter, 2 * side, below + above};
  add_ground(world, spec, at);
  add_deck(world, spec, height_of(feed.sphere), mass);
  add_crank(world, spec, parts, {deck_rear(spec) - thickness(spec) / 2, 0, 0}, mass);
  scene.drive = [spec, torque = torque_of(spec, mass)](sim::Simulation& simulation, double time) {
    const double share = std::clamp((time - kSettle) / kRunUp, 0.0, 1.0);
    simulation.set_motor(0, 0, Real(share * spec.crank_speed()), Real(torque));
  };
  scene.measure = [is_large = feed.is_large, at](sim::Simulation& simulation) {
    const Sorted s = sort_of(simulation.bodies(0), is_large, at);
    return std::vector<SceneNumber>{{"small_through", s.small_through},
                                    {"large_through", s.large_through},
                                    {"large_over", s.large_over},
                                    {"newton_efficiency", s.small_through - s.large_through}};
  };
  scene.watch = over_time(scene.measure);
  return scene;
}

}  // namespace gonogo::lab
