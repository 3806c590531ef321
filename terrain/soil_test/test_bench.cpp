#include "terrain/soil_test/test_bench.h"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"

namespace gonogo::terrain {

/// A world that waits for steps.
struct WaitingTest {
  sim::WorldIndex world = 0;
  Index steps = 0;
  std::vector<sim::BodyIndex> measured;
  StepsTaken taken;
};

namespace {

void begin(WaitingTest& w, Index steps, const std::vector<sim::BodyIndex>& measured) {
  GONOGO_ASSERT(steps >= 0);
  w.steps = steps;
  w.measured = measured;
  w.taken = {};
  w.taken.mean_force.resize(measured.size());
}

std::vector<Vec3d> measured_forces(sim::Simulation& simulation, const std::vector<WaitingTest*>& all) {
  std::vector<sim::WorldBody> bodies;
  for (const WaitingTest* w : all)
    for (const sim::BodyIndex b : w->measured) bodies.push_back({w->world, b});
  return bodies.empty() ? std::vector<Vec3d>{} : simulation.contact_forces(bodies);
}

/// Takes as many steps as every one of these worlds waits for. A world that failed waits for no more.
void step_together(sim::Simulation& simulation, const std::vector<WaitingTest*>& all) {
  Index count = all.front()->steps;
  bool measures = false;
  for (const WaitingTest* w : all) {
    count = std::min(count, w->steps);
    measures = measures || !w->measured.empty();
  }
  const Index stride = measures ? 1 : count;
  for (Index done = 0; done < count; done += stride) {
    stop_if_cancelled();
    simulation.advance(stride);
    const std::vector<sim::StepReport> reports = simulation.reports();
    const std::vector<Vec3d> forces = measured_forces(simulation, all);
    auto force = forces.begin();
    for (WaitingTest* w : all) {
      w->taken.last = reports[std::size_t(w->world)];
      // As if it stepped alone: reports between the steps that it asked for are those of other worlds.
      if (!w->measured.empty() || done + stride == w->steps)
        w->taken.worst_residual = std::max(w->taken.worst_residual, w->taken.last.rms_residual);
      for (Vec3d& sum : w->taken.mean_force) sum += *force++;
    }
    if (std::any_of(all.begin(), all.end(), [](const WaitingTest* w) { return w->taken.last.flags != 0; })) {
      count = done + stride;
      break;
    }
  }
  for (WaitingTest* w : all) w->steps = w->taken.last.flags != 0 ? 0 : w->steps - count;
}

StepsTaken result_of(const WaitingTest& w, Index steps) {
  StepsTaken taken = w.taken;
  for (Vec3d& force : taken.mean_force) force = force * (1.0 / double(steps));
  return taken;
}

class OwnSeat : public TestSeat {
 public:
  OwnSeat(const sim::SceneWorld& world, const sim::StepSettings& settings, int threads)
      : simulation_(sim::make_simulation(sim::Backend::cpu, {world}, settings, threads)) {}

  StepsTaken take(Index steps, const std::vector<sim::BodyIndex>& measured) override {
    WaitingTest w;
    begin(w, steps, measured);
    while (w.steps > 0) step_together(*simulation_, {&w});
    return result_of(w, steps);
  }

  void with(const std::function<void(sim::Simulation&, sim::WorldIndex)>& f) override { f(*simulation_, 0); }

 private:
  std::unique_ptr<sim::Simulation> simulation_;
};

constexpr std::size_t kMostAtOnce = 1024;

}  // namespace

std::unique_ptr<TestSeat> own_seat(const sim::SceneWorld& world, const sim::StepSettings& settings, int threads) {
  return std::make_unique<OwnSeat>(world, settings, threads);
}

/// Where tests on a GPU wait for each other. New worlds are seated only when no seated one waits for steps, so that
/// tests that take the same number of steps share one batch from one phase to the next.
class TestBench::Hall {
 public:
  Hall(sim::Backend backend, int threads) : backend_(backend), threads_(threads) {}

  void run(std::size_t count, const std::function<void(std::size_t)>& job) {
    for (std::size_t begin = 0; begin < count && !failure_; begin += kMostAtOnce)
      run_at_once(begin, std::min(count, begin + kMostAtOnce), job);
    if (failure_) std::rethrow_exception(failure_);
  }

  std::unique_ptr<TestSeat> seat(const sim::SceneWorld& world, const sim::StepSettings& settings) {
    auto guest = std::make_unique<Guest>(*this, world, settings);
    std::unique_lock lock(mutex_);
    arrivals_.push_back(guest.get());
    wait(lock, *guest);
    return guest;
  }

 private:
  struct Guest;

  struct Batch {
    std::unique_ptr<sim::Simulation> simulation;
    std::vector<Guest*> guests;
  };

  struct Guest : TestSeat {
    Guest(Hall& of, const sim::SceneWorld& world, const sim::StepSettings& with)
        : hall(of), scene(world), settings(with) {}
    ~Guest() override {
      const std::lock_guard lock(hall.mutex_);
      std::erase(hall.arrivals_, this);
      if (batch) hall.leave(*this);
    }
    StepsTaken take(Index steps, const std::vector<sim::BodyIndex>& measured) override {
      std::unique_lock lock(hall.mutex_);
      begin(waiting, steps, measured);
      if (steps > 0) hall.wait(lock, *this);
      return result_of(waiting, steps);
    }
    void with(const std::function<void(sim::Simulation&, sim::WorldIndex)>& f) override {
      const std::lock_guard lock(hall.mutex_);
      f(*batch->simulation, waiting.world);
    }

    Hall& hall;
    sim::SceneWorld scene;  // until it is seated
    sim::StepSettings settings;
    WaitingTest waiting;
    std::shared_ptr<Batch> batch;
    bool served = false;
    std::condition_variable woken;
  };

  void run_at_once(std::size_t begin, std::size_t end, const std::function<void(std::size_t)>& job) {
    running_ = end - begin;
    std::vector<std::jthread> threads;
    for (std::size_t k = begin; k < end; ++k) threads.emplace_back([this, &job, k] { run_one(job, k); });
  }

  void run_one(const std::function<void(std::size_t)>& job, std::size_t k) {
    std::exception_ptr own;
    try {
      job(k);
    } catch (...) {
      own = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    --running_;
    if (own) fail(own);
    serve();
  }

  void wait(std::unique_lock<std::mutex>& lock, Guest& guest) {
    guest.served = false;
    --running_;
    waiting_.push_back(&guest);
    serve();
    guest.woken.wait(lock, [&] { return guest.served; });
    if (failure_) std::rethrow_exception(failure_);
  }

  void wake(Guest& guest) {
    std::erase(waiting_, &guest);
    guest.served = true;
    ++running_;
    guest.woken.notify_one();
  }

  /// Works while every test waits.
  void serve() {
    try {
      while (running_ == 0 && !waiting_.empty()) {
        if (failure_) return fail(failure_);
        if (!step_seated()) seat_arrivals();
      }
    } catch (...) {
      fail(std::current_exception());
    }
  }

  void fail(const std::exception_ptr& why) {
    if (!failure_) failure_ = why;
    while (!waiting_.empty()) wake(*waiting_.back());
  }

  /// The others go on without its world.
  void leave(const Guest& guest) {
    Batch& batch = *guest.batch;
    std::erase(batch.guests, &guest);
    if (batch.guests.empty()) {
      std::erase_if(batches_, [&](const auto& b) { return b.get() == &batch; });
      return;
    }
    try {
      batch.simulation->replace(guest.waiting.world, sim::vacant_world());
    } catch (...) {  // leaving must not throw
      fail(std::current_exception());
    }
  }

  bool step_seated() {
    bool stepped = false;
    for (const auto& batch : batches_) {
      std::vector<WaitingTest*> all;
      for (Guest* g : batch->guests)
        if (g->waiting.steps > 0) all.push_back(&g->waiting);
      if (all.empty()) continue;
      step_together(*batch->simulation, all);
      stepped = true;
      for (Guest* g : std::vector<Guest*>(batch->guests))
        if (!g->served && g->waiting.steps == 0) wake(*g);
    }
    return stepped;
  }

  /// Arrivals with the settings of the first one become a batch.
  void seat_arrivals() {
    GONOGO_ASSERT(!arrivals_.empty());
    const sim::StepSettings settings = arrivals_.front()->settings;
    const auto batch = std::make_shared<Batch>();
    sim::Scene scene;
    for (Guest* g : arrivals_)
      if (g->settings == settings) {
        g->waiting.world = sim::WorldIndex(scene.size());
        batch->guests.push_back(g);
        scene.push_back(std::move(g->scene));
      }
    std::erase_if(arrivals_, [&](const Guest* g) { return g->settings == settings; });
    batch->simulation = sim::make_simulation(backend_, scene, settings, threads_);
    batches_.push_back(batch);
    for (Guest* g : batch->guests) {
      g->batch = batch;
      wake(*g);
    }
  }

  const sim::Backend backend_;
  const int threads_;
  std::mutex mutex_;
  std::size_t running_ = 0;  // jobs that do not wait
  std::vector<Guest*> waiting_, arrivals_;
  std::vector<std::shared_ptr<Batch>> batches_;
  std::exception_ptr failure_;
};

TestBench::TestBench(sim::Backend backend, int threads, bool together) : backend_(backend), threads_(threads) {
  sim::require_backend(backend);
  if (together) hall_ = std::make_unique<Hall>(backend, threads);
}

TestBench::~TestBench() = default;

void TestBench::run(std::size_t count, const std::function<void(std::size_t)>& job) {
  if (hall_)
    hall_->run(count, job);
  else
    for_each_on_host(count, 1, job, threads_);
}

std::unique_ptr<TestSeat> TestBench::seat(const sim::SceneWorld& world, const sim::StepSettings& settings,
                                          int threads) {
  return hall_ ? hall_->seat(world, settings) : own_seat(world, settings, threads);
}

}  // namespace gonogo::terrain
