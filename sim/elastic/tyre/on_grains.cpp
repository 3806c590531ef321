#include "sim/elastic/tyre/on_grains.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::sim::elastic {
namespace {

RollingTyre hovering(const Tyre& tyre, const Hub& hub, double height) { return {tyre, hub, height, {}}; }

}  // namespace

TyreOnGrains::TyreOnGrains(const Tyre& tyre, const Hub& hub, GrainGround ground)
    : shape_(tyre),
      tyre_(hovering(tyre, hub, ground.height)),
      x_(ground.x),
      y_(ground.y),
      step_(double(ground.settings.step)) {
  if (!is_penalty(ground.settings.contact))
    throw InputError(
        "tyre on grains: the contact must be spring_damper or hertz, whose steps are explicit as the ring's");
  substeps_ = long(std::ceil(step_ / (0.9 * tyre_.critical_step())));
  const double half = (length(tyre_.node(1) - tyre_.node(0))) / 2;
  for (int k = 0; k < tyre.nodes; ++k) {
    Shape s;
    s.type = ShapeType::box;
    s.material = ground.material;
    s.size = {Real(half), Real(tyre.width / 2), Real(tyre.tread / 2)};
    s.body = ground.world.add_body({{x_, y_, ground.height}, {}, {}, {}}, fixed_body());
    ground.world.add_shape(s);
    box_.push_back(s.body);
  }
  grains_ = make_simulation(Backend::cpu, {std::move(ground.world)}, ground.settings, ground.threads);
  place_boxes();
}

/// A box's z axis points out of the tyre; turning counter-clockwise in the ring's plane is turning about -y.
void TyreOnGrains::place_boxes() {
  const int n = shape_.nodes;
  std::vector<BodyState> states;
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    const Vec3d a = tyre_.node(k), b = tyre_.node(next), along = b - a;
    const double size = length(along), outward_x = along.y / size, outward_z = -along.x / size;
    const Vec3d middle = (a + b) * 0.5;
    const double h = shape_.tread / 2, angle = std::atan2(outward_x, outward_z);  // about +y, from z
    const Vec3d va = tyre_.velocity(k), vb = tyre_.velocity(next), v = (va + vb) * 0.5;
    const double spin = cross(along, vb - va).z / (size * size);  // counter-clockwise
    BodyState s;
    s.position = {x_ + middle.x + h * outward_x, y_, middle.y + h * outward_z};
    s.orientation = {Real(std::cos(angle / 2)), 0, Real(std::sin(angle / 2)), 0};
    s.velocity = {Real(v.x - spin * h * outward_z), 0, Real(v.y + spin * h * outward_x)};
    s.angular_velocity = {0, Real(-spin), 0};
    states.push_back(s);
  }
  grains_->set_bodies(0, box_, states);
}

/// The force at a point of a box goes to the ends of its beam by the lever rule, with the moment that is left.
void TyreOnGrains::take_forces(TreadLoad& load) {
  const int n = shape_.nodes;
  struct End {
    double x = 0, y = 0, moment = 0;
  };
  std::vector<End> end(std::size_t(n), End{});
  load.x.clear();
  load.force.clear();
  const auto contacts = grains_->contacts(0);
  const auto impulses = grains_->impulses(0);
  const double per_step = 1 / grains_->settings().substep();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const sim::Contact& c = contacts[i];
    const bool is_a = c.body_a >= box_.front() && c.body_a <= box_.back(),
               is_b = c.body_b >= box_.front() && c.body_b <= box_.back();
    if (is_a == is_b) continue;
    const int k = (is_a ? c.body_a : c.body_b) - box_.front(), next = (k + 1) % n;
    const Vec3d force = static_cast<Vec3d>(impulses[i].linear) * (is_a ? per_step : -per_step);
    const Vec3d arm = static_cast<Vec3d>(is_a ? c.arm_a : c.arm_b);
    const Vec3d a = tyre_.node(k), b = tyre_.node(next), along = b - a;
    const double size = length(along), out_x = along.y / size, out_y = -along.x / size;
    const Vec3d at = (a + b) * 0.5 + Vec3d{out_x, out_y, 0} * (shape_.tread / 2) + Vec3d{arm.x, arm.z, 0};
    const double share = std::clamp(dot(at - a, along) / (size * size), 0.0, 1.0);
    const Vec3d lever = at - a - along * share;
    const double moment = lever.x * force.z - lever.y * force.x;
    for (const auto& [node, part] : {std::pair{k, 1 - share}, std::pair{next, share}}) {
      end[node].x += part * force.x;
      end[node].y += part * force.z;
      end[node].moment += part * moment;
    }
    load.forward += force.x;
    load.upward += force.z;
    load.x.push_back(at.x - tyre_.rim().x);
    load.force.push_back(force.z);
  }
  for (int k = 0; k < n; ++k) tyre_.set_load(k, end[k].x, end[k].y, end[k].moment);
}

TreadLoad TyreOnGrains::advance(long count) {
  TreadLoad load;
  for (long i = 0; i < count; ++i) {
    grains_->advance(1);
    take_forces(load);
    tyre_.advance(step_ / double(substeps_), substeps_);
    place_boxes();
  }
  load.forward /= double(std::max(count, 1L));
  load.upward /= double(std::max(count, 1L));
  return load;
}

double TyreOnGrains::lowest() const {
  double least = 1e300;
  for (int k = 0; k < shape_.nodes; ++k) least = std::min(least, tyre_.node(k).y + shape_.tread * tyre_.normal(k).y);
  return least;
}

}  // namespace gonogo::sim::elastic
