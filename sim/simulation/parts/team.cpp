#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "base/format.h"
#include "sim/simulation/parts/divided.h"

namespace gonogo::sim {
namespace {

/// Threads that hold the parts of a world and do the same work at the same time.
class Team {
 public:
  using Work = std::function<void(Simulation&, bool first)>;

  /// `make`: a rank's simulation, called in its thread. Throws what it throws.
  Team(int count, const std::function<std::unique_ptr<Simulation>(Ranks&)>& make) : waiting_(count), count_(count) {
    host_ = std::thread([this, make] {
      try {
        run_in_threads(count_, [&](Ranks& ranks) { serve(ranks, make); });
      } catch (...) {
        fail(std::current_exception());
      }
      finish();
    });
    try {
      wait();
    } catch (...) {
      end();
      host_.join();
      throw;
    }
  }

  ~Team() {
    end();
    host_.join();
  }

  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  /// Calls work(simulation, whether it is the first rank's) in all threads. Throws InputError where all refuse alike;
  /// any other exception ends the team.
  void do_all(const Work& work) {
    {
      const std::lock_guard lock(mutex_);
      if (failure_) std::rethrow_exception(failure_);
      work_ = &work;
      ++turn_;
      waiting_ = count_;
      refusal_ = nullptr;
      changed_.notify_all();
    }
    wait();
  }

 private:
  void serve(Ranks& ranks, const std::function<std::unique_ptr<Simulation>(Ranks&)>& make) {
    std::unique_ptr<Simulation> simulation;
    attempt([&] { simulation = make(ranks); });
    for (Index seen = 0; const Work* work = next(seen);) attempt([&] { (*work)(*simulation, ranks.rank() == 0); });
  }

  /// The work of the next turn, or null at the end.
  const Work* next(Index& seen) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ends_ || turn_ != seen; });
    if (ends_) return nullptr;
    seen = turn_;
    return work_;
  }

  /// All ranks refuse bad input alike and go on. Other trouble ends a rank, and with it all.
  template <class Act>
  void attempt(const Act& act) {
    try {
      act();
    } catch (const InputError&) {
      const std::lock_guard lock(mutex_);
      refusal_ = std::current_exception();
    } catch (...) {
      end();
      throw;
    }
    const std::lock_guard lock(mutex_);
    --waiting_;
    changed_.notify_all();
  }

  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_ == 0 || over_; });
    if (failure_) std::rethrow_exception(failure_);
    if (refusal_) std::rethrow_exception(refusal_);
  }

  /// No more work will come.
  void end() {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    changed_.notify_all();
  }

  void fail(const std::exception_ptr& reason) {
    const std::lock_guard lock(mutex_);
    failure_ = reason;
  }

  void finish() {
    const std::lock_guard lock(mutex_);
    over_ = true;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  const Work* work_ = nullptr;
  Index turn_ = 0;
  int waiting_, count_;
  bool ends_ = false, over_ = false;
  std::exception_ptr refusal_, failure_;
  std::thread host_;  // starts when all else exists
};

/// The whole world, as the one thread of its user sees it.
class TeamSimulation final : public Simulation, public InParts {
  template <class Act>
  void each(const Act& act) {
    team_.do_all([&](Simulation& s, bool) { act(s); });
  }

  /// What the first rank answers; the others answer the same.
  template <class Ask>
  auto first(const Ask& ask) {
    decltype(ask(std::declval<Simulation&>())) answer{};
    team_.do_all([&](Simulation& s, bool is_first) {
      auto own = ask(s);
      if (is_first) answer = std::move(own);
    });
    return answer;
  }

 public:
  TeamSimulation(int count, const StepSettings& settings,
                 const std::function<std::unique_ptr<Simulation>(Ranks&)>& make)
      : settings_(settings), team_(count, make) {}

  void advance(Index count) override {
    each([&](Simulation& s) { s.advance(count); });
  }
  StepReport report(WorldIndex w) override {
    return first([&](Simulation& s) { return s.report(w); });
  }
  std::vector<StepReport> reports() override {
    return first([](Simulation& s) { return s.reports(); });
  }
  WorldStop stop(WorldIndex w) override {
    return first([&](Simulation& s) { return s.stop(w); });
  }
  std::vector<WorldStop> stops() override {
    return first([](Simulation& s) { return s.stops(); });
  }
  MonitorState monitor(WorldIndex w, Index m) override {
    return first([&](Simulation& s) { return s.monitor(w, m); });
  }
  std::vector<MonitorSample> samples(WorldIndex w, Index m, Index begin, Index count) override {
    return first([&](Simulation& s) { return s.samples(w, m, begin, count); });
  }
  BodyState body(WorldIndex w, BodyIndex b) override {
    return first([&](Simulation& s) { return s.body(w, b); });
  }
  void set_body(WorldIndex w, BodyIndex b, const BodyState& state) override {
    each([&](Simulation& s) { s.set_body(w, b, state); });
  }
  void set_bodies(WorldIndex w, const std::vector<BodyIndex>& which, const std::vector<BodyState>& states) override {
    each([&](Simulation& s) { s.set_bodies(w, which, states); });
  }
  std::vector<BodyState> bodies(WorldIndex w) override {
    return first([&](Simulation& s) { return s.bodies(w); });
  }
  BodiesOnDevice bodies_on_device(WorldIndex begin, WorldIndex count) override {
    return first([&](Simulation& s) { return s.bodies_on_device(begin, count); });
  }
  void set_gravity(WorldIndex w, const Vec3& gravity) override {
    each([&](Simulation& s) { s.set_gravity(w, gravity); });
  }
  void set_law(WorldIndex w, int a, int b, const PairLaw& law) override {
    each([&](Simulation& s) { s.set_law(w, a, b, law); });
  }
  void set_motor(WorldIndex w, Index m, Real target, Real max_torque) override {
    each([&](Simulation& s) { s.set_motor(w, m, target, max_torque); });
  }
  void set_command(WorldIndex w, Index c, double value) override {
    each([&](Simulation& s) { s.set_command(w, c, value); });
  }
  void set_pedals(WorldIndex w, Index d, double throttle, double brake) override {
    each([&](Simulation& s) { s.set_pedals(w, d, throttle, brake); });
  }
  double motor_torque(WorldIndex w, Index m) override {
    return first([&](Simulation& s) { return s.motor_torque(w, m); });
  }
  JointLoad joint_load(WorldIndex w, Index j) override {
    return first([&](Simulation& s) { return s.joint_load(w, j); });
  }
  JointLoad spring_load(WorldIndex w, Index i) override {
    return first([&](Simulation& s) { return s.spring_load(w, i); });
  }
  std::vector<Vec3d> contact_forces(const std::vector<WorldBody>& of) override {
    return first([&](Simulation& s) { return s.contact_forces(of); });
  }
  std::vector<Contact> contacts(WorldIndex w) override {
    return first([&](Simulation& s) { return s.contacts(w); });
  }
  std::vector<Impulse> impulses(WorldIndex w) override {
    return first([&](Simulation& s) { return s.impulses(w); });
  }
  Snapshot snapshot(WorldIndex w) override {
    return first([&](Simulation& s) { return s.snapshot(w); });
  }
  void restore(WorldIndex w, const Snapshot& from) override {
    each([&](Simulation& s) { s.restore(w, from); });
  }
  void replace(WorldIndex w, const SceneWorld& world) override {
    each([&](Simulation& s) { s.replace(w, world); });
  }
  void replace(WorldIndex w, FlatWorld world) override {
    each([&](Simulation& s) { s.replace(w, world); });
  }
  const StepSettings& settings() const override { return settings_; }
  std::vector<std::string> each_part(const Work& work) override {
    return first([&](Simulation& s) { return in_parts(s)->each_part(work); });
  }
  std::vector<PartShare> shares() override {
    return first([](Simulation& s) { return s.shares(); });
  }

 private:
  StepSettings settings_;
  Team team_;
};

}  // namespace

std::string loads_text(const std::vector<PartShare>& shares) {
  std::string text = "load of the GPUs";
  for (const PartShare& s : shares) text += line(" %.0f", 100 * s.load);
  return text + " %";
}

std::string shares_text(const std::vector<PartShare>& shares) {
  std::string text;
  for (std::size_t k = 0; k < shares.size(); ++k)
    text += line("%sGPU %d: %d bodies, %d contacts, %.1f %% of the load", k > 0 ? "; " : "", int(k), shares[k].bodies,
                 shares[k].contacts, 100 * shares[k].load);
  return text;
}

std::unique_ptr<Simulation> make_team_simulation(Backend backend, const SceneWorld& world, const StepSettings& settings,
                                                 int parts) {
  require_backend(backend);
  const auto gpus = int(cuda_device_names().size());
  if (backend == Backend::cuda && parts > gpus)
    throw InputError("a world is to be divided over " + std::to_string(parts) + " GPUs; this machine has " +
                     std::to_string(gpus));
  return std::make_unique<TeamSimulation>(parts, settings, [&world, &settings, backend](Ranks& ranks) {
    if (backend == Backend::cuda) use_cuda_device(ranks.rank());
    return make_divided_simulation(backend, world, settings, 1, ranks);
  });
}

}  // namespace gonogo::sim
