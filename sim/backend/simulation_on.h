// Simulation on an execution space: uploads, steps, downloads. Instantiated once in cpu.cpp and once in cuda.cu.
#pragma once
#include <algorithm>

#include "sim/joint/store.h"
#include "sim/simulation.h"
#include "sim/world/step.h"

namespace gonogo::sim {

/// Takes steps; each backend has its own way of queueing them.
template <class Exec>
class StepQueue;

/// Where a world's parts lie in the arrays of the batch.
struct Place {
  BodyIndex body = 0;
  ShapeIndex shape = 0;
  Index bin = 0, large = 0;
  MechanismSize mechanisms;
  ElementSize elements;
  WorldSize size;
};

template <class Exec>
class SimulationOn final : public Simulation {
 public:
  SimulationOn(Exec exec, std::vector<FlatWorld> worlds, const StepSettings& settings, const WorldSize& room)
      : settings_(settings), flat_(std::move(worlds)), queue_(exec) {
    lay_out(room);
    allocate();
    for (WorldIndex w = 0; w < s_.world_count; ++w) write_world(w);
  }

  void advance(Index count) override {
    queue_.advance(s_, settings_, count);
    if (count > 0) restored_contacts_ = 0, stepped_.assign(stepped_.size(), true);
  }

  StepReport report(WorldIndex w) override {
    const WorldSums sums = s_.world_sums.read(w);
    StepReport r;
    r.time = double(s_.steps.read(w)) * settings_.step;
    r.kinetic_energy = sums.kinetic;
    r.gravity_power = sums.gravity_power;
    const WorldEnergy energy = s_.element.energy.read(w);
    r.motor_power = energy.motor_power;
    r.force_power = energy.force_power;
    r.spring_energy = energy.spring;
    r.rms_residual = rms_residual(sums);
    r.max_residual = sums.residual_max;
    r.contact_count = sums.contact_count;
    r.iterations = sums.iterations;
    r.flags = s_.flags.read(w);
    r.fault = unpacked(s_.fault.read(w));
    if (r.fault.flags != 0) r.fault.body = body_in_scene(w, r.fault.body);
    return r;
  }

  WorldStop stop(WorldIndex w) override { return s_.element.stop.read(w); }
  std::vector<WorldStop> stops() override { return s_.element.stop.download(); }

  MonitorState monitor(WorldIndex w, Index m) override {
    check_monitor(w, m);
    return s_.element.monitor_state.read(place_[w].elements.monitors + m);
  }

  std::vector<MonitorSample> samples(WorldIndex w, Index m, Index first, Index count) override {
    const Index recorded = monitor(w, m).sample_count;
    if (first < 0 || count < 0 || count > recorded - first)
      throw InputError("samples " + std::to_string(first) + " to " + std::to_string(first + count) +
                       " of a monitor are asked for; it has recorded " + std::to_string(recorded));
    return s_.element.sample.download(place_[w].elements.samples + flat_[w].element.monitor[m].first_sample + first,
                                      count);
  }

  BodyState body(WorldIndex w, BodyIndex b) override {
    const BodyIndex i = in_batch(w, b);
    const Velocity v = s_.velocity.read(i);
    return {s_.position.read(i), s_.orientation.read(i), v.linear, v.angular};
  }

  void set_body(WorldIndex w, BodyIndex b, const BodyState& state) override {
    const BodyIndex i = in_batch(w, b);
    s_.position.write(i, state.position);
    s_.orientation.write(i, state.orientation);
    s_.velocity.write(i, Velocity{state.velocity, 0, state.angular_velocity, 0});
  }

  std::vector<BodyState> bodies(WorldIndex w) override {
    const Index first = place_[w].body, count = Index(flat_[w].body.size());
    const auto position = s_.position.download(first, count);
    const auto orientation = s_.orientation.download(first, count);
    const auto velocity = s_.velocity.download(first, count);
    std::vector<BodyState> result;
    for (const BodyIndex i : flat_[w].place_of_body)
      result.push_back({position[i], orientation[i], velocity[i].linear, velocity[i].angular});
    return result;
  }

  void set_gravity(WorldIndex w, const Vec3& gravity) override {
    flat_[w].world.gravity = gravity;
    write_parameters(w);
  }

  void set_law(WorldIndex w, int a, int b, const PairLaw& law) override {
    flat_[w].world.law[a][b] = law;
    flat_[w].world.law[b][a] = law;
    write_parameters(w);
  }

  void set_motor(WorldIndex w, Index m, Real target, Real max_torque) override {
    for (const ControllerPlan& c : flat_[w].element.controller)
      if (c.motor == m)
        throw InputError("world " + std::to_string(w) + ": motor " + std::to_string(m) +
                         " is set by a controller in every step");
    Motor& motor = flat_[w].mechanisms.motor[m];
    motor.target = target;
    motor.max_torque = max_torque;
    write_motors(w);
  }

  double motor_torque(WorldIndex w, Index m) override {
    return double(s_.mechanisms.motor_impulse.read(place_[w].mechanisms.motors + m)) / settings_.substep();
  }

  JointLoad joint_load(WorldIndex w, Index j) override {
    const FlatMechanisms& m = flat_[w].mechanisms;
    return load(w, m.row_of_joint[j], row_count(m.joint[j].type));
  }

  JointLoad spring_load(WorldIndex w, Index i) override { return load(w, flat_[w].mechanisms.row_of_spring[i], 1); }

  Vec3d contact_force(WorldIndex w, BodyIndex b) override {
    const auto contact = contacts(w);
    const auto impulse = impulses(w);
    Vec3d sum;
    for (std::size_t i = 0; i < contact.size(); ++i) {
      if (contact[i].body_a == b) sum += static_cast<Vec3d>(impulse[i].linear);
      if (contact[i].body_b == b) sum -= static_cast<Vec3d>(impulse[i].linear);
    }
    return sum * (1.0 / settings_.substep());
  }

  std::vector<Contact> contacts(WorldIndex w) override {
    if (!stepped_[w]) return {};
    const ContactRange r = latest_contacts(w);
    std::vector<Contact> result = s_.contact.download(r.begin, r.end - r.begin);
    std::vector<BodyIndex> in_scene(flat_[w].place_of_body.size());
    for (std::size_t b = 0; b < in_scene.size(); ++b) in_scene[flat_[w].place_of_body[b]] = BodyIndex(b);
    for (Contact& c : result) {
      c.body_a = in_scene[c.body_a - place_[w].body];
      c.body_b = in_scene[c.body_b - place_[w].body];
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
    const Place& at = place_[w];
    const WorldSize size = flat_[w].size();
    const ContactRange r = latest_contacts(w);
    Snapshot p;
    p.world = flat_[w].world;
    p.steps = s_.steps.read(w);
    p.flags = s_.flags.read(w);
    p.fault = unpacked(s_.fault.read(w));
    p.position = s_.position.download(at.body, size.bodies);
    p.orientation = s_.orientation.download(at.body, size.bodies);
    p.velocity = s_.velocity.download(at.body, size.bodies);
    p.contact_begin = latest().begin.download(at.shape, size.shapes);
    p.contact_end = latest().end.download(at.shape, size.shapes);
    p.key = latest().key.download(r.begin, r.end - r.begin);
    p.impulse = latest().impulse.download(r.begin, r.end - r.begin);
    p.motor = flat_[w].mechanisms.motor;
    p.motor_impulse = s_.mechanisms.motor_impulse.download(at.mechanisms.motors, size.mechanisms.motors);
    p.element = s_.element.snapshot(size.elements, element_place(w));
    shift_contacts(p, -r.begin, -at.shape);
    return p;
  }

  void restore(WorldIndex w, const Snapshot& from) override {
    const WorldSize size = flat_[w].size();
    if (Index(from.position.size()) != size.bodies || Index(from.contact_begin.size()) != size.shapes ||
        Index(from.motor.size()) != size.mechanisms.motors)
      throw InputError("the snapshot is of a world with " + std::to_string(from.position.size()) + " bodies, " +
                       std::to_string(from.contact_begin.size()) + " shapes and " + std::to_string(from.motor.size()) +
                       " motors; this one has " + std::to_string(size.bodies) + ", " + std::to_string(size.shapes) +
                       " and " + std::to_string(size.mechanisms.motors));
    if (!from.element.fits(size.elements))
      throw InputError("the snapshot is of a world with " + std::to_string(from.element.controller.size()) +
                       " controllers and " + std::to_string(from.element.sample.size()) +
                       " samples of monitors; this one has " + std::to_string(size.elements.controllers) + " and " +
                       std::to_string(size.elements.samples));
    const Place& at = place_[w];
    flat_[w].world = from.world;
    flat_[w].mechanisms.motor = from.motor;
    write_parameters(w);
    write_motors(w);
    s_.position.write(at.body, from.position);
    s_.orientation.write(at.body, from.orientation);
    s_.velocity.write(at.body, from.velocity);
    s_.mechanisms.motor_impulse.write(at.mechanisms.motors, from.motor_impulse);
    s_.steps.write(w, from.steps);
    s_.flags.write(w, from.flags);
    s_.fault.write(w, packed(from.fault));
    s_.world_sums.write(w, WorldSums{});
    s_.element.restore(from.element, element_place(w));
    write_contacts(w, from);
    stepped_[w] = false;
  }

  void replace(WorldIndex w, const SceneWorld& world) override { replace(w, flatten(world, w, settings_)); }

  void replace(WorldIndex w, FlatWorld flat) override {
    check_fits(w, flat.size());
    flat_[w] = std::move(flat);
    write_world(w);
  }

  const StepSettings& settings() const override { return settings_; }

 private:
  BodyIndex in_batch(WorldIndex w, BodyIndex b) const { return place_[w].body + flat_[w].place_of_body[b]; }

  /// `place`: of a body in its world's arrays.
  BodyIndex body_in_scene(WorldIndex w, Index place) const {
    const auto& places = flat_[w].place_of_body;
    return BodyIndex(std::find(places.begin(), places.end(), place) - places.begin());
  }

  FlatMechanisms in_batch(WorldIndex w) const {
    return moved(flat_[w].mechanisms, place_[w].mechanisms, w, place_[w].body);
  }

  /// Sum over rows, counted in their world.
  JointLoad load(WorldIndex w, Index first, Index count) {
    JointLoad sum;
    if (!stepped_[w]) return sum;
    queue_.run([&](auto exec) { recover_impulses(exec, s_.mechanisms); });
    for (Index i = place_[w].mechanisms.rows + first, end = i + count; i < end; ++i)
      add_row(sum, s_.mechanisms.row.read(i), s_.mechanisms.row_impulse.read(i), settings_.substep());
    return sum;
  }

  /// The store that the latest step wrote.
  ContactStore<Exec>& latest() { return s_.store[1 - s_.parity]; }

  ContactRange latest_contacts(WorldIndex w) {
    const Index shapes = flat_[w].size().shapes;
    if (shapes == 0) return {0, 0};
    return {latest().begin.read(place_[w].shape), latest().end.read(place_[w].shape + shapes - 1)};
  }

  static void shift_contacts(Snapshot& p, Index contacts, ShapeIndex shapes) {
    for (Index& i : p.contact_begin) i += contacts;
    for (Index& i : p.contact_end) i += contacts;
    for (std::uint64_t& key : p.key) key = shifted_key(key, shapes);
  }

  /// The restored contacts go behind those of the latest step.
  void write_contacts(WorldIndex w, Snapshot from) {
    const Index begin = s_.progress.read(0).contact_total + restored_contacts_, count = Index(from.key.size());
    if (begin + count > s_.contact_capacity) {
      reserve_contacts(s_, begin + 2 * count);
      queue_.forget();
    }
    shift_contacts(from, begin, place_[w].shape);
    latest().begin.write(place_[w].shape, from.contact_begin);
    latest().end.write(place_[w].shape, from.contact_end);
    latest().key.write(begin, from.key);
    latest().impulse.write(begin, from.impulse);
    restored_contacts_ += count;
  }

  void lay_out(const WorldSize& room) {
    Place next;
    for (const FlatWorld& world : flat_) {
      next.size = larger(world.size(), room);
      place_.push_back(next);
      next.body += next.size.bodies;
      next.shape += next.size.shapes;
      next.bin += next.size.bins;
      next.large += next.size.large_shapes;
      next.mechanisms = next.mechanisms + next.size.mechanisms;
      next.elements = after(next.elements, next.size.elements);
    }
    s_.world_count = Index(flat_.size());
    s_.body_count = next.body;
    s_.shape_count = next.shape;
    s_.bin_count = next.bin;
    stepped_.assign(flat_.size(), false);
    large_total_ = next.large;
    mechanism_total_ = next.mechanisms;
    element_total_ = next.elements;
  }

  void check_monitor(WorldIndex w, Index m) const {
    const Index count = flat_[w].size().elements.monitors;
    if (m < 0 || m >= count)
      throw InputError("world " + std::to_string(w) + " has no monitor " + std::to_string(m) + "; it has " +
                       std::to_string(count));
  }

  ElementPlace element_place(WorldIndex w) const {
    const Place& at = place_[w];
    const FlatMechanisms& m = flat_[w].mechanisms;
    return {w,
            at.body,
            at.mechanisms.motors,
            Index(m.motor.size()),
            at.mechanisms.springs,
            Index(m.spring.size()),
            at.elements,
            at.size.elements};
  }

  void check_fits(WorldIndex w, const WorldSize& size) const {
    const WorldSize& room = place_[w].size;
    const std::pair<const char*, std::pair<Index, Index>> parts[] = {
        {"bodies", {size.bodies, room.bodies}},
        {"shapes", {size.shapes, room.shapes}},
        {"bins", {size.bins, room.bins}},
        {"large shapes", {size.large_shapes, room.large_shapes}},
        {"bodies with forces", {size.elements.loaded, room.elements.loaded}},
        {"forces", {size.elements.forces, room.elements.forces}},
        {"controllers", {size.elements.controllers, room.elements.controllers}},
        {"table points", {size.elements.table_points, room.elements.table_points}},
        {"monitors", {size.elements.monitors, room.elements.monitors}},
        {"samples of monitors", {size.elements.samples, room.elements.samples}}};
    for (const auto& [name, count] : parts) check_part(w, name, count.first, count.second);
    for (const auto& part : MechanismSize::parts())
      check_part(w, part.name, size.mechanisms.*part.count, room.mechanisms.*part.count);
  }

  static void check_part(WorldIndex w, const char* name, Index count, Index room) {
    if (count > room)
      throw InputError("the new world has " + std::to_string(count) + " " + name + ", place " + std::to_string(w) +
                       " holds " + std::to_string(room) + "; make the simulation with more room");
  }

  void write_parameters(WorldIndex w) {
    WorldParameters p = flat_[w].world;
    const Place& at = place_[w];
    p.first_body = at.body;
    p.first_shape = at.shape;
    p.first_bin = at.bin;
    p.first_large = at.large;
    p.first_motor = at.mechanisms.motors;
    p.motor_count = Index(flat_[w].mechanisms.motor.size());
    s_.world.write(w, p);
    bool turning = s_.turning;
    for (const auto& row : p.law)
      for (const PairLaw& law : row)
        turning = turning || law.rolling_friction > 0 || law.spinning_friction > 0 || law.stiffness > 0;
    if (turning != s_.turning) queue_.forget();
    s_.turning = turning;
  }

  void write_motors(WorldIndex w) { s_.mechanisms.motor.write(place_[w].mechanisms.motors, in_batch(w).motor); }

  void write_world(WorldIndex w) {
    write_parameters(w);
    write_bodies(w);
    write_shapes(w);
    const Place& at = place_[w];
    write_mechanisms(s_.mechanisms, in_batch(w), at.mechanisms, at.size.mechanisms);
    s_.element.write(flat_[w].element, element_place(w));
    s_.steps.write(w, 0);
    s_.flags.write(w, 0);
    s_.fault.write(w, kNoFault);
    s_.world_sums.write(w, WorldSums{});
    stepped_[w] = false;
  }

  /// The rest of the place is filled with bodies that nothing moves and that carry no shape.
  void write_bodies(WorldIndex w) {
    const Place& at = place_[w];
    std::vector<Vec3d> position(at.size.bodies, flat_[w].world.origin);
    std::vector<Quat> orientation(at.size.bodies);
    std::vector<Velocity> velocity(at.size.bodies);
    for (std::size_t b = 0; b < flat_[w].body.size(); ++b) {
      const BodyState& state = flat_[w].body[b];
      position[b] = state.position;
      orientation[b] = state.orientation;
      velocity[b] = {state.velocity, 0, state.angular_velocity, 0};
    }
    std::vector<BodyMass> mass = flat_[w].mass;
    mass.resize(at.size.bodies, fixed_body());
    for (BodyMass& m : mass)
      if (m.slot >= 0) m.slot += at.mechanisms.bodies;
    s_.position.write(at.body, position);
    s_.orientation.write(at.body, orientation);
    s_.velocity.write(at.body, velocity);
    s_.mass.write(at.body, mass);
    s_.world_of_body.write(at.body, std::vector<WorldIndex>(at.size.bodies, w));
  }

  void write_shapes(WorldIndex w) {
    const Place& at = place_[w];
    std::vector<Shape> shape = flat_[w].shape;
    for (Shape& s : shape) s.body += at.body;
    place_surfaces(w, shape);
    Shape none;
    none.type = ShapeType::none;
    none.body = at.body;
    shape.resize(at.size.shapes, none);
    std::vector<Index> first = flat_[w].first_shape, bin = flat_[w].bin_of_shape;
    for (Index& i : first) i += at.shape;
    first.resize(at.size.bodies, at.shape + at.size.shapes);
    bin.resize(at.size.shapes, -1);
    for (std::size_t i = 0; i < bin.size() && !s_.solids_binned; ++i)
      if (bin[i] >= 0 && shape[i].type != ShapeType::sphere) s_.solids_binned = true, queue_.forget();
    std::vector<LargeShape> large = flat_[w].large;
    for (LargeShape& l : large) l.shape += at.shape;
    s_.shape.write(at.shape, shape);
    s_.first_shape.write(at.body, first);
    s_.bin_of_shape.write(at.shape, bin);
    s_.large.write(at.large, large);
    latest().begin.write(at.shape, std::vector<Index>(at.size.shapes));
    latest().end.write(at.shape, std::vector<Index>(at.size.shapes));
  }

  /// Adds the world's meshes and heightfields to those of the batch.
  void place_surfaces(WorldIndex w, std::vector<Shape>& shape) {
    const FlatWorld& flat = flat_[w];
    if (flat.mesh.empty() && flat.heightfield.empty()) return;
    for (Shape& s : shape) {
      if (s.type == ShapeType::mesh) s.surface = library_.add(flat.mesh[s.surface]);
      if (s.type == ShapeType::heightfield) s.surface = library_.add(flat.heightfield[s.surface]);
    }
    if (library_.size() == s_.surfaces.size()) return;
    s_.surfaces.upload(library_);
    queue_.forget();
  }

  void allocate() {
    for (auto* of_body : {&s_.velocity, &s_.velocity_change, &s_.free_velocity, &s_.extrapolated_velocity,
                          &s_.part_velocity, &s_.earlier_velocity})
      of_body->fill_zero(s_.body_count);
    s_.position.fill_zero(s_.body_count);
    s_.orientation.fill_zero(s_.body_count);
    s_.mass.fill_zero(s_.body_count);
    s_.world_of_body.fill_zero(s_.body_count);
    s_.inverse_inertia_W.fill_zero(s_.body_count);
    for (auto* of_body : {&s_.second_count, &s_.second_cursor, &s_.contact_weight}) of_body->fill_zero(s_.body_count);
    for (auto* offsets : {&s_.first_shape, &s_.first_second}) offsets->fill_zero(s_.body_count + 1);
    s_.first_shape.write(s_.body_count, s_.shape_count);
    s_.world.fill_zero(s_.world_count);
    s_.world_sums.fill_zero(s_.world_count);
    s_.momentum.fill_zero(s_.world_count);
    for (auto* of_world : {&s_.flags, &s_.steps, &s_.tiles_of_world}) of_world->fill_zero(s_.world_count);
    s_.first_tile.fill_zero(s_.world_count + 1);
    s_.fault.fill_zero(s_.world_count);
    gonogo::sim::allocate(s_.mechanisms, mechanism_total_);
    s_.element.allocate(s_.world_count, element_total_);
    s_.progress.fill_zero(1);
    allocate_shapes();
    lay_out_body_tiles();
    reserve_contacts(s_, std::max<Index>(4 * s_.shape_count, 1024));
  }

  void lay_out_body_tiles() {
    std::vector<Index> first{0};
    std::vector<WorldIndex> world;
    for (std::size_t w = 0; w < place_.size(); ++w) {
      first.push_back(first.back() + (place_[w].size.bodies + kTileSize - 1) / kTileSize);
      world.resize(first.back(), WorldIndex(w));
    }
    s_.first_body_tile.upload(first);
    s_.world_of_body_tile.upload(world);
  }

  void allocate_shapes() {
    s_.shape.fill_zero(s_.shape_count);
    s_.centre.fill_zero(s_.shape_count);
    s_.bin_of_shape.fill_zero(s_.shape_count);
    s_.large.fill_zero(large_total_);
    s_.contacts_of_part.fill_zero(s_.shape_count * kSearchParts);
    s_.first_of_part.fill_zero(s_.shape_count * kSearchParts + 1);
    s_.noted.fill_zero(s_.shape_count * kNeighbourRows * kNotedPairs);
    s_.first_contact.fill_zero(s_.shape_count + 1);
    s_.shape_in_bin.fill_zero(s_.shape_count);
    s_.shape_by_bin.fill_zero(s_.shape_count);
    s_.bin_cursor.fill_zero(s_.bin_count);
    s_.first_in_bin.fill_zero(s_.bin_count + 1);
    for (ContactStore<Exec>& store : s_.store) {
      store.begin.fill_zero(s_.shape_count);
      store.end.fill_zero(s_.shape_count);
    }
  }

  StepSettings settings_;
  std::vector<FlatWorld> flat_;  // as they entered, but with the laws, gravity and motors of now
  std::vector<Place> place_;
  std::vector<bool> stepped_;  // [world] since it entered or was restored
  Index large_total_ = 0;
  MechanismSize mechanism_total_;
  ElementSize element_total_;
  Index restored_contacts_ = 0;  // since the latest step
  SurfaceLibrary library_;
  State<Exec> s_;
  StepQueue<Exec> queue_;
};

}  // namespace gonogo::sim
