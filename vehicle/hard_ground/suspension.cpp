#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "vehicle/hard_ground/drive_for.h"
#include "vehicle/model/statics.h"
#include "vehicle/multibody/vehicle_tree.h"

namespace gonogo::vehicle {
namespace {

constexpr double kGravityChange = 0.05;  // relative, of the experiments
constexpr double kStep = 5e-4;           // of the free oscillation [s]
constexpr Index kStride = 10;            // steps between samples
constexpr int kSamples = 250;

/// Mass of an axle that rests on the ground without its springs: wheels, uprights, half of the tie rods, and half of
/// the arms, which turn about their inner ends [kg].
double unsprung_of_axle(const std::vector<Station>& wheels, int axle) {
  double sum = 0;
  for (const Station& s : wheels) {
    if (s.axle != axle) continue;
    sum += s.wheel->part.mass + 0.5 * s.suspension->tie_rod_mass;
    for (const auto& [name, part] : s.suspension->part) sum += (name == "upright" ? 1 : 0.5) * part.mass;
  }
  return sum;
}

/// One station of each of two axles.
std::array<Station, 2> axles_of(const Vehicle& v) {
  const auto wheels = stations(v);
  if (wheels.size() != 4 || wheels.front().axle == wheels.back().axle)
    throw InputError("vehicle " + v.name + " has no two axles of two wheels; its heave and pitch have no closed form");
  return {wheels.front(), wheels.back()};
}

/// Inverse inertia that vertical forces on the chassis over its axles meet, from the vehicle in reduced coordinates
/// whose wheels may not leave the ground, nor turn: H N (N^T M N)^-1 N^T H^T with N spanning what loops and ground
/// leave free [1/kg].
Eigen::Matrix2d inertia_over_axles(const Vehicle& vehicle) {
  using namespace multibody;
  const Assembly a = assemble(vehicle);
  const VehicleTree t = vehicle_tree(a);
  const VectorX q = t.tree.zero_position(), rest = VectorX::Zero(t.tree.velocity_count());
  const Kinematics k = kinematics(t.tree, q, rest);
  const MatrixX loops = loop_equations(t.tree, t.loop, k, rest).jacobian;
  const auto wheels = stations(vehicle);
  const auto count = Eigen::Index(wheels.size());
  MatrixX held = MatrixX::Zero(loops.rows() + 2 * count, loops.cols());
  held.topRows(loops.rows()) = loops;
  for (Eigen::Index i = 0; i < count; ++i) {
    const int body = a.wheel[std::size_t(i)];
    held.row(loops.rows() + i) = point_jacobian(t.tree, k, body, t.local(body, wheels[std::size_t(i)].centre)).row(2);
    held(loops.rows() + count + i, t.axle[std::size_t(i)]) = 1;
  }
  const MatrixX free = held.fullPivLu().kernel();
  const MatrixX mass = mass_matrix_by_composites(t.tree, q);
  MatrixX over(2, loops.cols());
  const auto axles = axles_of(vehicle);
  for (int i = 0; i < 2; ++i) {
    const Vec3d at{axles[std::size_t(i)].centre.x, 0, 0};
    over.row(i) = point_jacobian(t.tree, k, 0, t.local(0, at)).row(2);
  }
  const MatrixX reach = over * free;
  return reach * (free.transpose() * mass * free).llt().solve(reach.transpose());
}

/// The vehicle on frictionless ground, where wheels are free to track out; its wheels as spheres, which touch where
/// their middle planes do, whatever their camber.
struct Shaker {
  HardGround ground;
  Vec3d centre;  // of the chassis's mass, in the vehicle's frame [m]
  std::array<Station, 2> axle;

  explicit Shaker(const Vehicle& v)
      : ground(v, {100, 0, 0, 1e9, 0}, 0), centre(assemble(v).body[0].centre), axle(axles_of(v)) {
    for (sim::Shape& s : ground.world.shape)
      if (s.type == sim::ShapeType::cylinder) s.type = sim::ShapeType::sphere;
  }

  /// Heights of the chassis over the axles, from its pose [m].
  Eigen::Vector2d heights(sim::Simulation& s) const {
    const sim::BodyState b = s.body(0, ground.e.chassis);
    const Quat& start = ground.world.body[std::size_t(ground.e.chassis)].orientation;
    const auto z = [&](double x) {
      const Vec3 at{Real(x - centre.x), 0, Real(-centre.z)};
      return b.position.z + double(rotate(b.orientation, rotate_back(start, at)).z);
    };
    return {z(axle[0].centre.x), z(axle[1].centre.x)};
  }

  /// At rest under `factor` times gravity.
  std::unique_ptr<sim::Simulation> rested(double factor, const HardGroundRun& run) const {
    HardGround g = ground;
    g.world.gravity = g.world.gravity * Real(factor);
    auto s = start(g, run, 1e-3);
    drive_for(*s, 3);
    return s;
  }
};

/// Of the two axles: a change of gravity changes their loads, the heights answer [N/m].
Eigen::Vector2d axle_rates(const Vehicle& v, const Shaker& shaker, const HardGroundRun& run) {
  const Eigen::Vector2d low = shaker.heights(*shaker.rested(1 + kGravityChange, run)),
                        high = shaker.heights(*shaker.rested(1 - kGravityChange, run));
  const auto load = static_loads(v);
  const auto wheels = stations(v);
  Eigen::Vector2d rate;
  for (int a = 0; a < 2; ++a) {
    const std::size_t left = 2 * std::size_t(a);
    const double sprung = load[left] + load[left + 1] - unsprung_of_axle(wheels, wheels[left].axle) * kGravity;
    rate(a) = 2 * kGravityChange * sprung / (high(a) - low(a));
  }
  return rate;
}

/// Heights over the axles after gravity has grown from a little less than its own, without dampers.
std::vector<Eigen::Vector2d> free_oscillation(Vehicle v, const Shaker& damped, const HardGroundRun& run) {
  for (Suspension& s : v.suspension) {
    s.damper.force = {};
    s.damper.bump = {};
  }
  Shaker free(v);
  const auto rest = damped.rested(1 - kGravityChange, run)->bodies(0);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    free.ground.world.body[i].position = rest[i].position;
    free.ground.world.body[i].orientation = rest[i].orientation;
  }
  const auto s = start(free.ground, run, kStep);
  std::vector<Eigen::Vector2d> z;
  for (int k = 0; k < kSamples; ++k) {
    z.push_back(damped.heights(*s));
    drive_for(*s, kStride * kStep);
  }
  return z;
}

/// z'' = -A z - C z' + b by least squares; 2 (1 - cos(w dt)) / dt^2 are the eigenvalues of A. Ascending [rad/s].
Eigen::Vector2d frequencies(const std::vector<Eigen::Vector2d>& z, double dt) {
  Eigen::MatrixXd state(Eigen::Index(z.size()) - 2, 5), second(state.rows(), 2);
  for (Eigen::Index k = 0; k < state.rows(); ++k) {
    const auto i = std::size_t(k) + 1;
    state.row(k) << z[i].transpose(), (z[i + 1] - z[i - 1]).transpose() / (2 * dt), 1;
    second.row(k) = ((z[i + 1] - 2 * z[i] + z[i - 1]) / (dt * dt)).transpose();
  }
  const Eigen::MatrixXd fit = state.colPivHouseholderQr().solve(second);
  Eigen::Vector2d found = Eigen::EigenSolver<Eigen::Matrix2d>(Eigen::Matrix2d(-fit.topRows(2))).eigenvalues().real();
  for (int m = 0; m < 2; ++m) found(m) = std::acos(1 - found(m) * dt * dt / 2) / dt;
  if (found(0) > found(1)) std::swap(found(0), found(1));
  return found;
}

}  // namespace

HardGroundReport check_suspension(const Vehicle& vehicle, const HardGroundRun& run) {
  const Vehicle v = smooth(vehicle);
  const Shaker shaker(v);
  const Eigen::Vector2d rate = axle_rates(v, shaker, run);
  const Eigen::Matrix2d inertia = inertia_over_axles(v).inverse(), stiffness = rate.asDiagonal();
  const Eigen::Vector2d expected =
      Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d>(stiffness, inertia).eigenvalues().cwiseSqrt();
  const auto z = free_oscillation(v, shaker, run);
  const Eigen::Vector2d found = frequencies(z, kStride * kStep);

  HardGroundReport r{.name = "suspension",
                     .title = v.name + ": free oscillation without dampers",
                     .x_label = "time [s]",
                     .y_label = "height over the axle [m]",
                     .trace = {{"front axle", {}, {}}, {"rear axle", {}, {}}}};
  const char* const name[2] = {"slower", "faster"};
  for (int m = 0; m < 2; ++m) {
    const double hertz = expected(m) / (2 * kPi);
    r.check.push_back({.key = std::string("suspension_") + name[m] + "_Hz",
                       .claim = std::string(name[m]) + " of heave and pitch on the static rates of the axles [Hz]",
                       .expected = hertz,
                       .measured = found(m) / (2 * kPi),
                       .tolerance = 0.05 * hertz});
  }
  for (std::size_t k = 0; k < z.size(); ++k)
    for (int a = 0; a < 2; ++a) {
      r.trace[std::size_t(a)].x.push_back(double(k) * kStride * kStep);
      r.trace[std::size_t(a)].y.push_back(z[k](a));
    }
  return r;
}

}  // namespace gonogo::vehicle
