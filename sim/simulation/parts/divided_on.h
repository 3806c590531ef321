// One rank's view of a divided world on an execution space. Instantiated by divided.cpp and divided.cu.
#pragma once
#include <algorithm>
#include <optional>

#include "sim/simulation/layout/memory.h"
#include "sim/simulation/parts/divided.h"
#include "sim/simulation/parts/step_part.h"
#include "sim/simulation/simulation_on.h"

namespace gonogo::sim {

/// A rank's own bodies and the contacts that they found, by indices of the world.
struct OwnState {
  std::vector<Vec3d> position;
  std::vector<Quat> orientation;
  std::vector<Velocity> velocity;
  std::vector<Index> contacts;  // [shape]
  std::vector<std::uint64_t> key;
  std::vector<Impulse> impulse;
};

/// Bytes of a rank's GPU.
struct PartMemory {
  double needed = 0, free = 0;
};

/// On the GPU a search whose contacts exceed the buffers does nothing more; see PartStepper.
template <class Exec>
Exec halting(Exec exec, State<Exec>& s) {
  if constexpr (requires { exec.halted; }) exec.halted = &s.progress.data()->halted;
  return exec;
}

template <class Exec>
class DividedSimulation final : public Simulation, public InParts {
 public:
  DividedSimulation(Exec exec, FlatWorld world, const StepSettings& settings, Ranks& ranks)
      : exec_(exec), settings_(settings), ranks_(ranks), whole_(std::move(world)) {
    divide(start_of(whole_));
  }

  void advance(Index count) override {
    for (Index done = 0; done < count; ++done) {
      const bool sorts = steps_ > 0 && steps_ % settings_.sort_every == 0;
      if (sorts || outdated_ || stepper_->halo_is_stale()) renew(sorts);
      local_->take_step([&](Exec exec, State<Exec>& s) { stepper_->step(halting(exec, s), s, settings_); });
      ++steps_;
    }
    if (count > 0) stepped_ = true;
  }

  StepReport report(WorldIndex) override {
    StepReport report = local_->report(0);
    report.fault = fault();
    if (report.fault.flags != 0) report.fault.body = scene_body(report.fault.body);
    return report;
  }
  std::vector<StepReport> reports() override { return {report(0)}; }
  WorldStop stop(WorldIndex) override { return local_->stop(0); }
  std::vector<WorldStop> stops() override { return local_->stops(); }
  MonitorState monitor(WorldIndex, Index m) override { return local_->monitor(0, m); }
  std::vector<MonitorSample> samples(WorldIndex, Index m, Index first, Index count) override {
    return local_->samples(0, m, first, count);
  }

  BodyState body(WorldIndex, BodyIndex b) override {
    const BodyIndex place = whole_.place_of_body.at(std::size_t(b));
    std::vector<BodyState> mine;
    if (owns(place)) mine.push_back(local_->body(0, local_place(place)));
    return joined(ranks_, std::move(mine)).at(0);
  }

  void set_body(WorldIndex w, BodyIndex b, const BodyState& state) override { set_bodies(w, {b}, {state}); }

  void set_bodies(WorldIndex, const std::vector<BodyIndex>& which, const std::vector<BodyState>& states) override {
    GONOGO_ASSERT(which.size() == states.size());
    for (std::size_t k = 0; k < which.size(); ++k)
      if (const BodyIndex place = whole_.place_of_body.at(std::size_t(which[k])); holds(place))
        local_->set_body(0, local_place(place), states[k]);
    outdated_ = true;
  }

  std::vector<BodyState> bodies(WorldIndex) override {
    std::vector<BodyState> mine = local_->bodies(0);
    mine = {mine.begin() + part_.own_begin, mine.begin() + part_.own_end};
    const std::vector<BodyState> all = joined(ranks_, std::move(mine));
    std::vector<BodyState> result;
    for (const BodyIndex place : whole_.place_of_body) result.push_back(all[place]);
    return result;
  }

  BodiesOnDevice bodies_on_device(WorldIndex, WorldIndex) override {
    const auto memory = std::make_shared<std::vector<BodyState>>(bodies(0));
    return {std::shared_ptr<BodyState>(memory, memory->data()), Index(memory->size()), -1};
  }

  void set_gravity(WorldIndex, const Vec3& gravity) override {
    whole_.world.gravity = gravity;
    local_->set_gravity(0, gravity);
  }

  void set_law(WorldIndex, int a, int b, const PairLaw& law) override {
    whole_.world.law[a][b] = whole_.world.law[b][a] = law;
    local_->set_law(0, a, b, law);
  }

  void set_motor(WorldIndex, Index m, Real target, Real max_torque) override {
    local_->set_motor(0, m, target, max_torque);
    whole_.mechanisms.motor[m].target = target;
    whole_.mechanisms.motor[m].max_torque = max_torque;
  }

  void set_command(WorldIndex, Index c, double value) override {
    local_->set_command(0, c, value);
    whole_.element.table = local_->arrays().flat[0].element.table;
  }

  void set_pedals(WorldIndex, Index d, double throttle, double brake) override {
    local_->set_pedals(0, d, throttle, brake);
    whole_.element.table = local_->arrays().flat[0].element.table;
  }

  double motor_torque(WorldIndex, Index m) override { return local_->motor_torque(0, m); }
  JointLoad joint_load(WorldIndex, Index j) override { return stepped_ ? local_->joint_load(0, j) : JointLoad{}; }
  JointLoad spring_load(WorldIndex, Index s) override { return stepped_ ? local_->spring_load(0, s) : JointLoad{}; }

  /// The lanes of SumContactImpulse are added part by part, so that each sums its contacts in their order.
  std::vector<Vec3d> contact_forces(const std::vector<WorldBody>& of) override {
    std::vector<Vec3d> force(of.size());
    if (!stepped_ || of.empty()) return force;
    std::vector<Vec3d> share(of.size() * std::size_t(kForceLanes));
    const int last = ranks_.count() - 1, rank = ranks_.rank();
    if (rank > 0) ranks_.exchange({}, std::vector<Letter>{letter(rank - 1, share)});
    add_contact_impulses(of, share);
    if (rank < last) ranks_.exchange(std::vector<Letter>{letter(rank + 1, share)}, {});
    std::vector<Vec3d> sums = joined(ranks_, rank == last ? share : std::vector<Vec3d>{});
    for (std::size_t k = 0; k < sums.size(); ++k) force[k / std::size_t(kForceLanes)] += sums[k];
    for (Vec3d& f : force) f = f * (1.0 / settings_.substep());
    return force;
  }

  std::vector<Contact> contacts(WorldIndex) override {
    if (!stepped_) return {};
    const ContactRange own = stepper_->contacts().own;
    std::vector<Contact> mine = local_->arrays().state.contact.download(own.begin, own.end - own.begin);
    for (Contact& c : mine) {
      c.body_a = scene_body(part_.body[c.body_a]);
      c.body_b = scene_body(part_.body[c.body_b]);
    }
    return joined(ranks_, std::move(mine));
  }

  std::vector<Impulse> impulses(WorldIndex) override {
    if (!stepped_) return {};
    const ContactRange own = stepper_->contacts().own;
    return joined(ranks_, local_->latest().impulse.download(own.begin, own.end - own.begin));
  }

  Snapshot snapshot(WorldIndex) override {
    Snapshot p = own_snapshot();
    p.place_of_body = whole_.place_of_body;
    p.position = joined(ranks_, p.position);
    p.orientation = joined(ranks_, p.orientation);
    p.velocity = joined(ranks_, p.velocity);
    p.key = joined(ranks_, p.key);
    p.impulse = joined(ranks_, p.impulse);
    std::vector<Index> counts;
    for (std::size_t i = 0; i < p.contact_end.size(); ++i) counts.push_back(p.contact_end[i] - p.contact_begin[i]);
    set_contacts(p, joined(ranks_, std::move(counts)));
    return p;
  }

  std::vector<std::string> each_part(const Work& work) override {
    const std::string mine = work(own_snapshot(), ranks_.rank());
    std::vector<std::string> all;
    for (const std::vector<char>& text : gathered(ranks_, std::vector<char>(mine.begin(), mine.end())))
      all.emplace_back(text.begin(), text.end());
    return all;
  }

  void restore(WorldIndex, const Snapshot& from) override {
    require_fit(from, whole_.size(), false);
    if (from.place_of_body != whole_.place_of_body) whole_ = rearranged(whole_, from.place_of_body, settings_);
    whole_.world = from.world;
    whole_.mechanisms.motor = from.motor;
    divide(from);
    stepped_ = false;
  }

  void replace(WorldIndex w, const SceneWorld& world) override { replace(w, flatten(world, w, settings_)); }

  void replace(WorldIndex, FlatWorld world) override {
    whole_ = std::move(world);
    divide(start_of(whole_));
    stepped_ = false;
  }

  const StepSettings& settings() const override { return settings_; }

  std::vector<PartShare> shares() override {
    const auto& count = stepper_->contacts().count;  // empty before the part's first step
    std::vector<PartShare> all;
    double sum = 0;
    for (std::size_t p = 0; p + 1 < border_.size(); ++p) {
      all.push_back({border_[p + 1] - border_[p], count.empty() ? 0 : count[p][0]});
      sum += double(all[p].bodies) + double(all[p].contacts);
    }
    for (PartShare& s : all) s.load = (double(s.bodies) + double(s.contacts)) / sum;
    return all;
  }

 private:
  /// Gives each rank about as much to do.
  void divide(const Snapshot& at) {
    border_ = borders(whole_, at, ranks_.count());
    fault_ = packed(at.fault);
    build(at);
  }

  /// The rank's part, at positions that its halo is found for.
  void build(const Snapshot& at) {
    stepper_.reset();  // before the new ones ask for memory
    local_.reset();
    part_ = part_of(whole_, at, border_, ranks_.rank());
    FlatWorld flat = restricted(whole_, part_);
    check_memory(flat.size(), at);
    const Snapshot local = restricted(at, whole_, part_, flat);
    stepper_.emplace(ranks_, part_, flat);
    std::vector<FlatWorld> alone;
    alone.push_back(std::move(flat));
    local_ = std::make_unique<SimulationOn<Exec>>(exec_, std::move(alone), settings_, WorldSize{});
    State<Exec>& s = local_->arrays().state;
    s.strangeness.upload(part_.strangeness);
    s.partial_tiles = 4;
    reserve_contacts(s, s.contact_capacity);
    local_->restore(0, local);
    s.turning = turning_ = turning_ || s.turning;  // of a world in one piece it stays
    stepper_->reserve(s, settings_);
    steps_ = at.steps;
    outdated_ = false;
  }

  /// All ranks throw OutOfMemory when the part of one does not fit into its GPU's free memory.
  void check_memory(const WorldSize& own, const Snapshot& at) {
    const std::optional<double> free = free_memory(!std::is_same_v<Exec, Cpu>);
    if (!free) return;
    const double needed = device_bytes({own}, settings_, turning_ || needs_turning(whole_.world, settings_));
    const auto all = joined(ranks_, std::vector<PartMemory>{{needed, *free}});
    const auto short_of = [](const PartMemory& m) { return m.needed - m.free; };
    const PartMemory worst = *std::max_element(all.begin(), all.end(),
                                               [&](const auto& a, const auto& b) { return short_of(a) < short_of(b); });
    if (short_of(worst) <= 0) return;
    const int gpus = gpus_that_do(whole_, at, settings_, worst.free);
    throw OutOfMemory(memory_sentence("the largest of " + std::to_string(ranks_.count()) + " parts of the world",
                                      worst.needed, worst.free, gpus));
  }

  /// Finds the halo anew, or sorts the bodies where they have mixed and divides them anew.
  void renew(bool sorts) {
    const Snapshot now = snapshot(0);
    fault_ = packed(now.fault);
    if (sorts) {
      const std::vector<BodyIndex> place = spatial_order(now.position, whole_.world);
      if (have_mixed(now.position, place, whole_.world)) {
        FlatWorld sorted = rearranged(whole_, composed(whole_.place_of_body, place), settings_);
        const Snapshot then = rearranged(now, whole_, sorted);
        const WorldParameters present = whole_.world;
        whole_ = std::move(sorted);
        whole_.world = present;
        return divide(then);
      }
    }
    build(now);
  }

  bool owns(BodyIndex place) const {
    return place >= border_[std::size_t(ranks_.rank())] && place < border_[std::size_t(ranks_.rank()) + 1];
  }
  bool holds(BodyIndex place) const { return std::binary_search(part_.body.begin(), part_.body.end(), place); }
  BodyIndex local_place(BodyIndex place) const {
    GONOGO_ASSERT(holds(place));
    return BodyIndex(std::lower_bound(part_.body.begin(), part_.body.end(), place) - part_.body.begin());
  }

  /// `place`: in the engine's order.
  BodyIndex scene_body(BodyIndex place) const {
    if (in_scene_.size() != whole_.place_of_body.size() || whole_.place_of_body[in_scene_[place]] != place) {
      in_scene_.resize(whole_.place_of_body.size());
      for (std::size_t b = 0; b < in_scene_.size(); ++b) in_scene_[whole_.place_of_body[b]] = BodyIndex(b);
    }
    return in_scene_[place];
  }

  /// The first of all parts and of all time; its body in the engine's order.
  Fault fault() {
    Fault mine = unpacked(local_->arrays().state.fault.read(0));
    if (mine.flags != 0) mine.body = part_.body[mine.body];
    PackedFault first = fault_;
    for (const PackedFault part : joined(ranks_, std::vector<PackedFault>{packed(mine)})) first = std::min(first, part);
    return unpacked(first);
  }

  /// As InParts says.
  Snapshot own_snapshot() {
    Snapshot p = local_->snapshot(0);
    OwnState mine = own_state(p);
    p.world = whole_.world;
    p.place_of_body = ranks_.rank() == 0 ? whole_.place_of_body : std::vector<BodyIndex>{};
    p.fault = fault();
    p.motor = whole_.mechanisms.motor;
    p.position = std::move(mine.position);
    p.orientation = std::move(mine.orientation);
    p.velocity = std::move(mine.velocity);
    p.key = std::move(mine.key);
    p.impulse = std::move(mine.impulse);
    set_contacts(p, mine.contacts);
    return p;
  }

  /// `counts`: by shape, one after the other.
  static void set_contacts(Snapshot& p, const std::vector<Index>& counts) {
    p.contact_begin.clear();
    p.contact_end.clear();
    Index at = 0;
    for (const Index count : counts) {
      p.contact_begin.push_back(at);
      p.contact_end.push_back(at += count);
    }
  }

  OwnState own_state(const Snapshot& local) const {
    OwnState own;
    const BodyIndex begin = part_.own_begin, end = part_.own_end;
    own.position = {local.position.begin() + begin, local.position.begin() + end};
    own.orientation = {local.orientation.begin() + begin, local.orientation.begin() + end};
    own.velocity = {local.velocity.begin() + begin, local.velocity.begin() + end};
    const std::vector<ShapeIndex> shape = shapes_in_world(whole_, part_);
    for (std::size_t i = 0; i < shape.size(); ++i) {
      if (!owns(whole_.shape[shape[i]].body)) continue;
      own.contacts.push_back(local.contact_end[i] - local.contact_begin[i]);
      for (Index k = local.contact_begin[i]; k < local.contact_end[i]; ++k) {
        const ShapeIndex other = other_shape(local.key[k]);
        own.key.push_back(shifted_key(local.key[k], shape[other] - other));
        own.impulse.push_back(local.impulse[k]);
      }
    }
    return own;
  }

  void add_contact_impulses(const std::vector<WorldBody>& of, std::vector<Vec3d>& share) {
    const ContactRange own = stepper_->contacts().own;
    const auto contact = local_->arrays().state.contact.download(own.begin, own.end - own.begin);
    const auto impulse = local_->latest().impulse.download(own.begin, own.end - own.begin);
    for (std::size_t k = 0; k < of.size(); ++k) {
      const BodyIndex place = whole_.place_of_body.at(std::size_t(of[k].body));
      if (!holds(place)) continue;
      const BodyIndex b = local_place(place);
      for (std::size_t i = 0; i < contact.size(); ++i) {
        const auto lane = std::size_t((stepper_->contacts().before + std::int64_t(i)) % kForceLanes);
        Vec3d& sum = share[k * std::size_t(kForceLanes) + lane];
        if (contact[i].body_a == b) sum += static_cast<Vec3d>(impulse[i].linear);
        if (contact[i].body_b == b) sum -= static_cast<Vec3d>(impulse[i].linear);
      }
    }
  }

  Exec exec_;
  StepSettings settings_;
  Ranks& ranks_;
  FlatWorld whole_;                // as it entered, with the present laws, gravity, motors and commands
  std::vector<BodyIndex> border_;  // [rank + 1] in the engine's order
  Part part_;
  std::optional<PartStepper<Exec>> stepper_;
  std::unique_ptr<SimulationOn<Exec>> local_;
  Index steps_ = 0;               // taken
  bool stepped_ = false;          // since the world entered or was restored
  bool outdated_ = false;         // bodies were set
  bool turning_ = false;          // see State
  PackedFault fault_ = kNoFault;  // the first one before the part was built
  mutable std::vector<BodyIndex> in_scene_;
};

}  // namespace gonogo::sim
