// Simulation on an execution space: uploads, steps, downloads. Instantiated once in cpu.cpp and once in cuda.cu.
#pragma once
#include "sim/simulation.h"
#include "sim/world/step.h"

namespace gonogo::sim {

template <class Exec>
class SimulationOn final : public Simulation {
 public:
  SimulationOn(Exec exec, const FlatScene& scene, const StepSettings& settings)
      : exec_(exec), settings_(settings), first_motor_(scene.first_motor), world_(scene.world) {
    upload(scene);
  }

  void advance(Index count) override {
    for (Index i = 0; i < count; ++i) step(exec_, s_, settings_);
    step_count_ += count;
  }

  StepReport report(WorldIndex w) override {
    const WorldSums sums = s_.world_sums.read(w);
    StepReport r;
    r.time = double(step_count_) * settings_.step;
    r.kinetic_energy = sums.kinetic;
    r.gravity_power = sums.gravity_power;
    for (Index m = first_motor_[w]; m < motor_end(w); ++m)
      r.motor_power += s_.motor_impulse.read(m) / settings_.step * s_.velocity.read(s_.motor.read(m).body).angular.y;
    r.rms_residual = sums.contact_count > 0 ? std::sqrt(sums.residual_square / sums.contact_count) : 0;
    r.max_residual = sums.residual_max;
    r.contact_count = Index(sums.contact_count);
    r.iterations = Index(sums.iterations);
    r.flags = s_.flags.read(w);
    return r;
  }

  BodyState body(WorldIndex w, BodyIndex b) override {
    const BodyIndex i = world_[w].first_body + b;
    const Velocity v = s_.velocity.read(i);
    return {s_.position.read(i), s_.orientation.read(i), v.linear, v.angular};
  }

  void set_body(WorldIndex w, BodyIndex b, const BodyState& state) override {
    const BodyIndex i = world_[w].first_body + b;
    s_.position.write(i, state.position);
    s_.orientation.write(i, state.orientation);
    s_.velocity.write(i, {state.velocity, 0, state.angular_velocity, 0});
  }

  std::vector<BodyState> bodies(WorldIndex w) override {
    const auto position = s_.position.download();
    const auto orientation = s_.orientation.download();
    const auto velocity = s_.velocity.download();
    std::vector<BodyState> result;
    for (BodyIndex b = world_[w].first_body; b < world_[w].first_body + world_[w].body_count; ++b)
      result.push_back({position[b], orientation[b], velocity[b].linear, velocity[b].angular});
    return result;
  }

  void set_gravity(WorldIndex w, const Vec3& gravity) override {
    world_[w].gravity = gravity;
    s_.world.write(w, world_[w]);
  }

  void set_law(WorldIndex w, int a, int b, const PairLaw& law) override {
    world_[w].law[a][b] = law;
    world_[w].law[b][a] = law;
    s_.world.write(w, world_[w]);
  }

  void set_motor(WorldIndex w, Index m, Real speed, Real max_torque) override {
    const Index i = first_motor_[w] + m;
    s_.motor.write(i, {s_.motor.read(i).body, speed, max_torque});
  }

  double motor_torque(WorldIndex w, Index m) override {
    return double(s_.motor_impulse.read(first_motor_[w] + m)) / settings_.step;
  }

  Vec3d contact_force(WorldIndex w, BodyIndex b) override {
    const BodyIndex body = world_[w].first_body + b;
    const auto contact = s_.contact.download();
    const auto impulse = s_.impulse.download();
    Vec3d sum;
    for (Index i = 0; i < s_.contact_count; ++i) {
      if (contact[i].body_a == body) sum += static_cast<Vec3d>(impulse[i].linear);
      if (contact[i].body_b == body) sum -= static_cast<Vec3d>(impulse[i].linear);
    }
    return sum * (1.0 / settings_.step);
  }

  std::vector<Contact> contacts() override { return s_.contact.download(); }
  std::vector<Impulse> impulses() override {
    auto impulse = s_.impulse.download();
    impulse.resize(s_.contact_count);  // after restore it holds the warm start of contacts not yet found
    return impulse;
  }

  Snapshot snapshot() override {
    return {s_.position.download(),
            s_.orientation.download(),
            s_.velocity.download(),
            s_.first_contact.download(),
            s_.flags.download(),
            s_.key.download(),
            s_.impulse.download(),
            s_.motor_impulse.download(),
            world_,
            s_.motor.download(),
            step_count_};
  }

  void restore(const Snapshot& p) override {
    if (Index(p.position.size()) != s_.body_count || Index(p.world.size()) != s_.world_count ||
        Index(p.motor.size()) != s_.motor.size())
      throw InputError("the snapshot is of another scene: " + std::to_string(p.position.size()) + " bodies, expected " +
                       std::to_string(s_.body_count));
    s_.position.upload(p.position);
    s_.orientation.upload(p.orientation);
    s_.velocity.upload(p.velocity);
    s_.first_contact.upload(p.first_contact);
    s_.flags.upload(p.flags);
    s_.key.upload(p.key);
    s_.impulse.upload(p.impulse);
    s_.motor_impulse.upload(p.motor_impulse);
    s_.motor_extrapolated.upload(p.motor_impulse);
    s_.world.upload(p.world);
    s_.motor.upload(p.motor);
    s_.world_sums.fill_zero(s_.world_count);
    s_.contact_count = 0;
    s_.contact.resize(0);
    world_ = p.world;
    step_count_ = p.step_count;
  }

  const StepSettings& settings() const override { return settings_; }

 private:
  Index motor_end(WorldIndex w) const {
    return std::size_t(w) + 1 < first_motor_.size() ? first_motor_[w + 1] : s_.motor.size();
  }

  void upload(const FlatScene& f) {
    s_.world_count = Index(f.world.size());
    s_.body_count = Index(f.body.size());
    s_.shape_count = Index(f.shape.size());
    s_.bin_count = f.bin_count;
    std::vector<Vec3d> position;
    std::vector<Quat> orientation;
    std::vector<Velocity> velocity;
    for (const BodyState& b : f.body) {
      position.push_back(b.position);
      orientation.push_back(b.orientation);
      velocity.push_back({b.velocity, 0, b.angular_velocity, 0});
    }
    s_.position.upload(position);
    s_.orientation.upload(orientation);
    s_.velocity.upload(velocity);
    s_.world.upload(f.world);
    s_.mass.upload(f.mass);
    s_.world_of_body.upload(f.world_of_body);
    s_.shape.upload(f.shape);
    s_.first_shape.upload(f.first_shape);
    s_.bin_of_shape.upload(f.bin_of_shape);
    s_.large.upload(f.large);
    s_.motor.upload(f.motor);
    s_.spring.upload(f.spring);
    allocate();
  }

  void allocate() {
    s_.inverse_inertia_W.fill_zero(s_.body_count);
    s_.free_velocity.fill_zero(s_.body_count);
    s_.body_progress.fill_zero(s_.body_count);
    s_.body_sums.fill_zero(s_.body_count);
    s_.first_second.fill_zero(s_.body_count + 1);
    s_.world_sums.fill_zero(s_.world_count);
    s_.momentum.fill_zero(s_.world_count);
    s_.flags.fill_zero(s_.world_count);
    s_.worlds_iterating.fill_zero(1);
    s_.motor_impulse.fill_zero(s_.motor.size());
    s_.motor_extrapolated.fill_zero(s_.motor.size());
    s_.centre.fill_zero(s_.shape_count);
    s_.contacts_of_shape.fill_zero(s_.shape_count);
    s_.binned_count = s_.shape_count - s_.large.size();
    s_.shape_in_bin.fill_zero(s_.binned_count);
    s_.shape_by_bin.fill_zero(s_.binned_count);
    s_.first_in_bin.fill_zero(s_.bin_count + 1);
  }

  Exec exec_;
  StepSettings settings_;
  std::vector<Index> first_motor_;
  std::vector<WorldParameters> world_;  // host copy
  State<Exec> s_;
  std::int64_t step_count_ = 0;
};

}  // namespace gonogo::sim
