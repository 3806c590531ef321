// Simulation on an execution space: uploads, steps, downloads. Instantiated by cpu.cpp and cuda.cu.
#pragma once
#include <algorithm>
#include <chrono>

#include "sim/scene/flat_world.h"
#include "sim/simulation/between_steps.h"
#include "sim/simulation/layout/batch_arrays.h"
#include "sim/simulation/simulation.h"
#include "sim/simulation/step.h"

namespace gonogo::sim {

/// Wall-clock times of stages. `Wait` returns when the device has finished all queued work.
template <class Wait>
class StageClock {
 public:
  StageClock(StageTimes& times, Wait wait) : times_(times), wait_(std::move(wait)) { wait_(); }

  template <class Work>
  void operator()(Stage stage, const Work& work) const {
    const auto start = std::chrono::steady_clock::now();
    work();
    wait_();
    times_.seconds[int(stage)] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  StageTimes& times_;
  Wait wait_;
};

/// Throws InputError for a snapshot of a world of another size. `remembers`: contacts of this simulation have
/// histories.
inline void require_fit(const Snapshot& from, const WorldSize& size, bool remembers) {
  if (Index(from.position.size()) != size.bodies || Index(from.contact_begin.size()) != size.shapes ||
      Index(from.motor.size()) != size.mechanisms.motors)
    throw InputError("the snapshot is of a world with " + std::to_string(from.position.size()) + " bodies, " +
                     std::to_string(from.contact_begin.size()) + " shapes and " + std::to_string(from.motor.size()) +
                     " motors; this one has " + std::to_string(size.bodies) + ", " + std::to_string(size.shapes) +
                     " and " + std::to_string(size.mechanisms.motors));
  if (remembers && from.history.size() != from.key.size())
    throw InputError("the snapshot holds " + std::to_string(from.key.size()) + " contacts and the histories of " +
                     std::to_string(from.history.size()) +
                     "; penalty contact continues from snapshots of penalty contact only");
  if (!from.element.fits(size.elements))
    throw InputError("the snapshot is of a world with " + std::to_string(from.element.controller.size()) +
                     " controllers and " + std::to_string(from.element.sample.size()) +
                     " samples of monitors; this one has " + std::to_string(size.elements.controllers) + " and " +
                     std::to_string(size.elements.samples));
}

/// Takes steps and owns the SolverStorage. Specialised by each backend.
template <class Exec>
class StepQueue;

template <class Exec>
class SimulationOn final : public Simulation, public StepByStage {
 public:
  SimulationOn(Exec exec, std::vector<FlatWorld> worlds, const StepSettings& settings, const WorldSize& room)
      : settings_(settings),
        batch_(std::move(worlds), room, settings),
        stepped_(batch_.flat.size(), false),
        steps_(batch_.flat.size(), 0),
        queue_(exec) {}

  void advance(Index count) override {
    for (Index done = 0; done < count;) {
      const Index next = std::min(count - done, sort_worlds());
      forget_if_changed();
      queue_.advance(batch_.state, settings_, next);
      done += next;
      count_steps(next);
    }
  }

  StageTimes timed_step() override {
    sort_worlds();
    forget_if_changed();
    const StageTimes times = queue_.timed_step(batch_.state, settings_);
    count_steps(1);
    return times;
  }

  SearchReport timed_search() override {
    forget_if_changed();
    const Progress before = batch_.state.progress.read(0);
    SearchReport report;
    report.times = queue_.timed_search(batch_.state, settings_);
    report.contact_count = batch_.state.progress.read(0).contact_total;
    batch_.state.progress.write(0, before);  // the latest step's contacts still hold their impulses
    stepped_.assign(stepped_.size(), false);
    return report;
  }

  double solver_traffic() override {
    return queue_.traffic(batch_.state, settings_, batch_.state.progress.read(0).contact_total);
  }

  StepReport report(WorldIndex w) override {
    GONOGO_ASSERT(w >= 0 && w < batch_.state.world_count);
    const State<Exec>& s = batch_.state;
    return report(w, s.world_sums.read(w), s.element.energy.read(w), s.steps.read(w), s.flags.read(w), s.slowed.read(w),
                  s.fault.read(w));
  }

  std::vector<StepReport> reports() override {
    const State<Exec>& s = batch_.state;
    const auto sums = s.world_sums.download();
    const auto energy = s.element.energy.download();
    const auto steps = s.steps.download(), flags = s.flags.download(), slowed = s.slowed.download();
    const auto fault = s.fault.download();
    std::vector<StepReport> all;
    for (std::size_t w = 0; w < std::size_t(s.world_count); ++w)
      all.push_back(report(WorldIndex(w), sums[w], energy[w], steps[w], flags[w], slowed[w], fault[w]));
    return all;
  }

  WorldStop stop(WorldIndex w) override { return batch_.state.element.stop.read(w); }
  std::vector<WorldStop> stops() override { return batch_.state.element.stop.download(); }

  MonitorState monitor(WorldIndex w, Index m) override {
    check_monitor(w, m);
    return batch_.state.element.monitor_state.read(batch_.place[w].elements.monitors + m);
  }

  std::vector<MonitorSample> samples(WorldIndex w, Index m, Index first, Index count) override {
    const Index recorded = monitor(w, m).sample_count;
    if (first < 0 || count < 0 || count > recorded - first)
      throw InputError("samples " + std::to_string(first) + " to " + std::to_string(first + count) +
                       " of a monitor are asked for; it has recorded " + std::to_string(recorded));
    return batch_.state.element.sample.download(
        batch_.place[w].elements.samples + batch_.flat[w].element.monitor[m].first_sample + first, count);
  }

  BodyState body(WorldIndex w, BodyIndex b) override {
    const BodyIndex i = batch_.in_batch(w, b);
    const Velocity v = batch_.state.velocity.read(i);
    return {batch_.state.position.read(i), batch_.state.orientation.read(i), v.linear, v.angular};
  }

  void set_body(WorldIndex w, BodyIndex b, const BodyState& state) override {
    const BodyIndex i = batch_.in_batch(w, b);
    batch_.state.position.write(i, state.position);
    batch_.state.orientation.write(i, state.orientation);
    batch_.state.velocity.write(i, Velocity{state.velocity, 0, state.angular_velocity, 0});
  }

  void set_bodies(WorldIndex w, const std::vector<BodyIndex>& which, const std::vector<BodyState>& states) override {
    std::vector<BodyIndex> in_batch;
    GONOGO_ASSERT(which.size() == states.size());
    for (const BodyIndex b : which) in_batch.push_back(batch_.in_batch(w, b));
    queue_.run([&](auto exec) { place_bodies(exec, batch_.state, sent_, in_batch, states); });
  }

  std::vector<BodyState> bodies(WorldIndex w) override {
    const Index first = batch_.place[w].body, count = Index(batch_.flat[w].body.size());
    const auto position = batch_.state.position.download(first, count);
    const auto orientation = batch_.state.orientation.download(first, count);
    const auto velocity = batch_.state.velocity.download(first, count);
    std::vector<BodyState> result;
    for (const BodyIndex i : batch_.flat[w].place_of_body)
      result.push_back({position[i], orientation[i], velocity[i].linear, velocity[i].angular});
    return result;
  }

  BodiesOnDevice bodies_on_device(WorldIndex first, WorldIndex count) override {
    std::vector<BodyIndex> in_batch;
    for (WorldIndex w = first; w < first + count; ++w)
      for (const BodyIndex b : batch_.flat[w].place_of_body) in_batch.push_back(batch_.place[w].body + b);
    const auto memory = std::make_shared<Buffer<BodyState, Exec>>(in_batch.size());
    queue_.run([&](auto exec) { gather_bodies(exec, batch_.state, sent_, in_batch, *memory); });
    return {std::shared_ptr<BodyState>(memory, memory->data()), Index(in_batch.size()), queue_.gpu()};
  }

  void set_gravity(WorldIndex w, const Vec3& gravity) override {
    batch_.flat[w].world.gravity = gravity;
    batch_.write_parameters(w);
  }

  void set_law(WorldIndex w, int a, int b, const PairLaw& law) override {
    batch_.flat[w].world.law[a][b] = law;
    batch_.flat[w].world.law[b][a] = law;
    batch_.write_parameters(w);
  }

  void set_motor(WorldIndex w, Index m, Real target, Real max_torque) override {
    if (sets_motor(batch_.flat[w].element, m))
      throw InputError("world " + std::to_string(w) + ": motor " + std::to_string(m) +
                       " is set by a controller in every step");
    Motor& motor = batch_.flat[w].mechanisms.motor[m];
    motor.target = target;
    motor.max_torque = max_torque;
    batch_.write_motors(w);
  }

  void set_command(WorldIndex w, Index c, double value) override {
    const ControllerPlan& plan = batch_.flat[w].element.controller.at(c);
    const double limit = command_limit(plan.type);
    if (!(value >= -limit && value <= limit))
      throw InputError("world " + std::to_string(w) + ": controller " + std::to_string(c) + " takes no command of " +
                       std::to_string(value) + "; allowed are " + std::to_string(-limit) + " to " +
                       std::to_string(limit));
    batch_.hold(w, plan.command, value);
  }

  void set_pedals(WorldIndex w, Index d, double throttle, double brake) override {
    const DrivelinePlan& plan = batch_.flat[w].element.driveline.at(d);
    for (const double pedal : {throttle, brake})
      if (!(pedal >= 0 && pedal <= 1))
        throw InputError("world " + std::to_string(w) + ": a pedal of driveline " + std::to_string(d) + " stands at " +
                         std::to_string(pedal) + "; allowed are 0 to 1");
    batch_.hold(w, plan.throttle, throttle);
    batch_.hold(w, plan.braking, brake);
  }

  double motor_torque(WorldIndex w, Index m) override {
    return double(batch_.state.mechanisms.motor_impulse.read(batch_.place[w].mechanisms.motors + m)) /
           settings_.substep();
  }

  JointLoad joint_load(WorldIndex w, Index j) override {
    const FlatMechanisms& m = batch_.flat[w].mechanisms;
    return load(w, m.row_of_joint[j], row_count(m.joint[j].type));
  }

  JointLoad spring_load(WorldIndex w, Index i) override {
    return load(w, batch_.flat[w].mechanisms.row_of_spring[i], 1);
  }

  std::vector<Vec3d> contact_forces(const std::vector<WorldBody>& of) override {
    std::vector<BodyIndex> in_batch;
    std::vector<std::size_t> asked;
    for (std::size_t k = 0; k < of.size(); ++k) {
      if (!stepped_[of[k].world]) continue;
      in_batch.push_back(batch_.in_batch(of[k].world, of[k].body));
      asked.push_back(k);
    }
    std::vector<Vec3d> force(of.size()), impulse;
    if (asked.empty()) return force;
    queue_.run([&](auto exec) { impulse = sum_contact_impulses(exec, batch_.state, latest(), sent_, in_batch); });
    for (std::size_t i = 0; i < asked.size(); ++i) force[asked[i]] = impulse[i] * (1.0 / settings_.substep());
    return force;
  }

  std::vector<Contact> contacts(WorldIndex w) override {
    if (!stepped_[w]) return {};
    const ContactRange r = latest_contacts(w);
    std::vector<Contact> result = batch_.state.contact.download(r.begin, r.end - r.begin);
    std::vector<BodyIndex> in_scene(batch_.flat[w].place_of_body.size());
    for (std::size_t b = 0; b < in_scene.size(); ++b) in_scene[batch_.flat[w].place_of_body[b]] = BodyIndex(b);
    for (Contact& c : result) {
      c.body_a = in_scene[c.body_a - batch_.place[w].body];
      c.body_b = in_scene[c.body_b - batch_.place[w].body];
      c.world = w;
    }
    return result;
  }

  std::vector<Impulse> impulses(WorldIndex w) override {
    if (!stepped_[w]) return {};
    const ContactRange r = latest_contacts(w);
    return latest().impulse.download(r.begin, r.end - r.begin);
  }

  Snapshot snapshot(WorldIndex w) override {
    const Place& at = batch_.place[w];
    const WorldSize size = batch_.flat[w].size();
    const ContactRange r = latest_contacts(w);
    GONOGO_ASSERT(r.begin <= r.end && r.end <= batch_.state.contact_capacity);
    Snapshot p;
    p.world = batch_.flat[w].world;
    p.place_of_body = batch_.flat[w].place_of_body;
    p.steps = batch_.state.steps.read(w);
    p.flags = batch_.state.flags.read(w);
    p.slowed = batch_.state.slowed.read(w);
    p.fault = unpacked(batch_.state.fault.read(w));
    p.position = batch_.state.position.download(at.body, size.bodies);
    p.orientation = batch_.state.orientation.download(at.body, size.bodies);
    p.velocity = batch_.state.velocity.download(at.body, size.bodies);
    p.contact_begin = latest().begin.download(at.shape, size.shapes);
    p.contact_end = latest().end.download(at.shape, size.shapes);
    p.key = latest().key.download(r.begin, r.end - r.begin);
    p.impulse = latest().impulse.download(r.begin, r.end - r.begin);
    if (batch_.state.remembers) p.history = latest().history.download(r.begin, r.end - r.begin);
    p.motor = batch_.flat[w].mechanisms.motor;
    p.motor_impulse = batch_.state.mechanisms.motor_impulse.download(at.mechanisms.motors, size.mechanisms.motors);
    p.element = batch_.state.element.snapshot(size.elements, batch_.element_place(w));
    shift_contacts(p, -r.begin, -at.shape);
    return p;
  }

  void restore(WorldIndex w, const Snapshot& from) override {
    require_fit(from, batch_.flat[w].size(), batch_.state.remembers);
    if (from.place_of_body != batch_.flat[w].place_of_body)
      batch_.replace(w, rearranged(batch_.flat[w], from.place_of_body, settings_));
    const Place& at = batch_.place[w];
    batch_.flat[w].world = from.world;
    batch_.flat[w].mechanisms.motor = from.motor;
    batch_.write_parameters(w);
    batch_.write_motors(w);
    batch_.state.position.write(at.body, from.position);
    batch_.state.orientation.write(at.body, from.orientation);
    batch_.state.velocity.write(at.body, from.velocity);
    batch_.state.mechanisms.motor_impulse.write(at.mechanisms.motors, from.motor_impulse);
    batch_.state.steps.write(w, from.steps);
    batch_.state.flags.write(w, from.flags);
    batch_.state.slowed.write(w, from.slowed);
    batch_.state.fault.write(w, packed(from.fault));
    batch_.state.world_sums.write(w, WorldSums{});
    batch_.state.element.restore(from.element, batch_.element_place(w));
    write_contacts(w, from);
    stepped_[w] = false;
    steps_[w] = from.steps;
  }

  void replace(WorldIndex w, const SceneWorld& world) override { replace(w, flatten(world, w, settings_)); }

  void replace(WorldIndex w, FlatWorld flat) override {
    batch_.replace(w, std::move(flat));
    stepped_[w] = false;
    steps_[w] = 0;
  }

  const StepSettings& settings() const override { return settings_; }

  // For a part of a divided world (parts/).

  BatchArrays<Exec>& arrays() { return batch_; }

  /// The store that the latest step wrote.
  ContactStore<Exec>& latest() { return batch_.state.store[1 - batch_.state.parity]; }

  /// A step that work(exec, state) takes. Bodies are not sorted.
  template <class Work>
  void take_step(const Work& work) {
    forget_if_changed();
    queue_.run([&](auto exec) { work(exec, batch_.state); });
    batch_.state.parity = 1 - batch_.state.parity;
    count_steps(1);
  }

 private:
  void forget_if_changed() {
    if (std::exchange(batch_.changed, false)) queue_.forget();
  }

  void count_steps(Index count) {
    for (Index& steps : steps_) steps += count;
    restored_contacts_ = 0;
    stepped_.assign(stepped_.size(), true);
  }

  /// `place`: of a body in its world's arrays.
  BodyIndex body_in_scene(WorldIndex w, Index place) const {
    const auto& places = batch_.flat[w].place_of_body;
    return BodyIndex(std::find(places.begin(), places.end(), place) - places.begin());
  }

  /// Sorts the worlds that are due. Returns the number of steps until the next one is.
  Index sort_worlds() {
    Index until_next = settings_.sort_every;
    for (WorldIndex w = 0; w < batch_.state.world_count; ++w) {
      const Index since = steps_[w] % settings_.sort_every;
      if (since == 0 && steps_[w] > 0) sort_bodies(w);
      until_next = std::min(until_next, settings_.sort_every - since);
    }
    return until_next;
  }

  void sort_bodies(WorldIndex w) {
    const FlatWorld& flat = batch_.flat[w];
    const auto position = batch_.state.position.download(batch_.place[w].body, Index(flat.body.size()));
    const std::vector<BodyIndex> place = spatial_order(position, flat.world);
    if (!have_mixed(position, place, flat.world)) return;
    const Snapshot now = snapshot(w);
    FlatWorld sorted = rearranged(flat, composed(flat.place_of_body, place), settings_);
    const Snapshot then = rearranged(now, flat, sorted);
    batch_.replace(w, std::move(sorted));
    restore(w, then);
  }

  StepReport report(WorldIndex w, const WorldSums& sums, const WorldEnergy& energy, Index steps, Index flags,
                    Index slowed, const PackedFault& fault) const {
    StepReport r;
    r.time = double(steps) * settings_.step;
    r.kinetic_energy = sums.kinetic;
    r.gravity_power = sums.gravity_power;
    r.motor_power = energy.motor_power;
    r.force_power = energy.force_power;
    r.spring_energy = energy.spring;
    r.rms_residual = rms_residual(sums);
    r.max_residual = sums.residual_max;
    r.contact_count = sums.contact_count;
    r.iterations = sums.iterations;
    r.flags = flags;
    r.slowed = slowed;
    r.fault = unpacked(fault);
    if (r.fault.flags != 0) r.fault.body = body_in_scene(w, r.fault.body);
    return r;
  }

  /// Sum over rows, counted in their world.
  JointLoad load(WorldIndex w, Index first, Index count) {
    JointLoad sum;
    if (!stepped_[w]) return sum;
    queue_.run([&](auto exec) { recover_impulses(exec, batch_.state.mechanisms); });
    for (Index i = batch_.place[w].mechanisms.rows + first, end = i + count; i < end; ++i)
      add_row(sum, batch_.state.mechanisms.row.read(i), batch_.state.mechanisms.row_impulse.read(i),
              settings_.substep());
    return sum;
  }

  ContactRange latest_contacts(WorldIndex w) {
    const Index shapes = batch_.flat[w].size().shapes;
    if (shapes == 0) return {0, 0};
    return {latest().begin.read(batch_.place[w].shape), latest().end.read(batch_.place[w].shape + shapes - 1)};
  }

  static void shift_contacts(Snapshot& p, Index contacts, ShapeIndex shapes) {
    GONOGO_ASSERT(p.contact_begin.size() == p.contact_end.size());
    for (Index& i : p.contact_begin) i += contacts;
    for (Index& i : p.contact_end) i += contacts;
    for (std::uint64_t& key : p.key) key = shifted_key(key, shapes);
  }

  /// The restored contacts go behind those of the latest step.
  void write_contacts(WorldIndex w, Snapshot from) {
    const Index begin = batch_.state.progress.read(0).contact_total + restored_contacts_,
                count = Index(from.key.size());
    if (begin + count > batch_.state.contact_capacity) {
      reserve_contacts(batch_.state, begin + 2 * count);
      batch_.changed = true;
    }
    GONOGO_ASSERT(begin + count <= batch_.state.contact_capacity && from.impulse.size() == from.key.size());
    shift_contacts(from, begin, batch_.place[w].shape);
    latest().begin.write(batch_.place[w].shape, from.contact_begin);
    latest().end.write(batch_.place[w].shape, from.contact_end);
    latest().key.write(begin, from.key);
    latest().impulse.write(begin, from.impulse);
    if (batch_.state.remembers) latest().history.write(begin, from.history);
    restored_contacts_ += count;
  }

  void check_monitor(WorldIndex w, Index m) const {
    const Index count = batch_.flat[w].size().elements.monitors;
    if (m < 0 || m >= count)
      throw InputError("world " + std::to_string(w) + " has no monitor " + std::to_string(m) + "; it has " +
                       std::to_string(count));
  }

  StepSettings settings_;
  BatchArrays<Exec> batch_;
  std::vector<bool> stepped_;    // [world] since it entered or was restored
  std::vector<Index> steps_;     // [world] taken
  Index restored_contacts_ = 0;  // since the latest step
  BodyPlaces<Exec> sent_;
  StepQueue<Exec> queue_;
};

}  // namespace gonogo::sim
