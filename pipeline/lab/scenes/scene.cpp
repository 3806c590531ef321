#include "pipeline/lab/scenes/scene.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "base/units.h"
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/chart.h"
#include "pipeline/report/figure/film.h"
#include "sim/io/vtk_series.h"
#include "sim/scene/penalty_setup.h"
#include "sim/simulation/parts/divided.h"

namespace gonogo::lab {
namespace {

/// Steps of a scene, with its drive called when it is due.
class Driven {
 public:
  Driven(const ManyScene& scene, sim::Simulation& simulation) : scene_(scene), simulation_(simulation) {}

  double time() const { return double(steps_) * simulation_.settings().step; }

  void advance(int count) {
    for (int k = 0; k < count;) {
      const int steps = std::min(due(), count - k);
      simulation_.advance(steps);
      steps_ += steps;
      k += steps;
    }
  }

  /// Seconds of a step in a sample that no drive interrupts.
  double sample(int steps) {
    if (due() < steps) advance(due());
    due();
    const double time = seconds_per_step(simulation_, 1, steps);
    steps_ += steps;
    return time;
  }

  sim::StageTimes timed_step() {
    due();
    ++steps_;
    return sim::by_stage(simulation_).timed_step();
  }

 private:
  /// Drives where it is time to; returns how many steps follow until the next one.
  int due() {
    const int since = int(steps_ % kStepsPerDrive);
    if (since == 0 && driven_at_ != steps_ && scene_.drive) scene_.drive(simulation_, time());
    driven_at_ = since == 0 ? steps_ : driven_at_;
    return kStepsPerDrive - since;
  }

  const ManyScene& scene_;
  sim::Simulation& simulation_;
  std::int64_t steps_ = 0, driven_at_ = -1;
};

void check_flags(const ManyScene& scene, sim::Simulation& simulation) {
  if (const sim::StepReport report = simulation.report(0); report.flags != 0)
    throw DeviceError(scene.name + ": " + sim::description(report.fault, scene.settings.step));
}

/// Frames of a run while it goes on.
class Frames {
 public:
  Frames(const ManyScene& scene, const ManyRun& run) : run_(run) {
    if (!run.vtk.empty()) series_.emplace(run.vtk, scene.world);
  }

  void add(sim::Simulation& simulation) {
    if (!series_ && run_.video.empty()) return;
    sim::Capture state = sim::capture_world(simulation, 0);
    if (series_) series_->write(state);
    if (run_.video.empty()) return;
    state.contact = {};
    held_.push_back(std::move(state));
  }

  void finish(const ManyScene& scene) const {
    if (!run_.video.empty()) draw_video(run_.video, scene, held_, run_.every, run_.on.threads);
  }

 private:
  const ManyRun& run_;
  std::optional<sim::VtkSeries> series_;
  std::vector<sim::Capture> held_;
};

int steps_in(double time, const ManyScene& scene) { return std::max(1, int(std::lround(time / scene.settings.step))); }

/// The scene's duration, in stretches between frames and looks.
void play(const ManyScene& scene, const ManyRun& run, sim::Simulation& simulation, Driven& driven, ManyResult& r) {
  Frames frames(scene, run);
  const int all = int(std::lround(scene.duration / scene.settings.step)), per_frame = steps_in(run.every, scene),
            per_look = scene.watch ? steps_in(scene.watch_every, scene) : all;
  for (int done = 0;;) {
    check_flags(scene, simulation);
    if (done % per_frame == 0 || done == all) frames.add(simulation);
    if (scene.watch && (done % per_look == 0 || done == all))
      r.watched.push_back(scene.watch(simulation, driven.time()));
    if (done == all) break;
    stop_if_cancelled();
    const int steps = std::min({all - done, per_frame - done % per_frame, per_look - done % per_look});
    driven.advance(steps);
    done += steps;
  }
  frames.finish(scene);
}

void time_steps(const ManyRun& run, sim::Simulation& simulation, Driven& driven, ManyResult& r) {
  std::vector<double> samples;
  std::vector<sim::StageTimes> stages;
  for (int k = 0; k < run.repeats; ++k) samples.push_back(driven.sample(run.steps_per_sample));
  const double time = median(samples);
  r.ms_per_step = time * 1e3;
  const bool divided = run.on.gpus > 1;  // the stages of several GPUs are not timed
  for (int k = 0; k < (divided ? 0 : run.repeats); ++k) stages.push_back(driven.timed_step());
  const double updates = double(simulation.report(0).contact_count) * r.iterations;
  r.ns_per_contact_iteration = time * 1e9 / updates;
  if (divided) return;
  r.stages = median_times(stages);
  const double solve = r.stages.of(sim::Stage::solve);
  r.ns_per_contact_iteration_solver = solve * 1e9 / updates;
  r.copy_bandwidth = sim::copy_bandwidth(run.on.backend, run.on.threads);
  r.bandwidth_share = sim::by_stage(simulation).solver_traffic() * r.iterations / solve / r.copy_bandwidth;
}

}  // namespace

sim::StageTimes median_times(const std::vector<sim::StageTimes>& samples) {
  sim::StageTimes times;
  for (int k = 0; k < sim::kStageCount; ++k) {
    std::vector<double> of_stage;
    for (const sim::StageTimes& sample : samples) of_stage.push_back(sample.seconds[k]);
    times.seconds[k] = median(of_stage);
  }
  return times;
}

std::function<std::vector<SceneNumber>(sim::Simulation&, double time)> over_time(
    std::function<std::vector<SceneNumber>(sim::Simulation&)> measure) {
  return [measure = std::move(measure)](sim::Simulation& simulation, double time) {
    std::vector<SceneNumber> m = measure(simulation);
    m.insert(m.begin(), {"time_s", time});
    return m;
  };
}

ManyResult run_many(const ManyScene& scene, const ManyRun& run) {
  sim::require_backend(run.on.backend);
  if (!run.plot.empty() && !scene.watch)
    throw InputError("--plot: the scene " + scene.name + " records nothing over time; leave the option out");
  if (!run.picture.empty() || !run.video.empty() || !run.plot.empty()) require_pictures(!run.video.empty());
  const double start = seconds();
  const auto simulation = run.on.gpus > 1
                              ? sim::make_team_simulation(run.on.backend, scene.world, scene.settings, run.on.gpus)
                              : sim::make_simulation(run.on.backend, {scene.world}, scene.settings, run.on.threads);
  Driven driven(scene, *simulation);
  driven.advance(1);
  ManyResult r;
  r.build_seconds = seconds() - start;
  play(scene, run, *simulation, driven, r);
  r.run_seconds = seconds() - start - r.build_seconds;
  if (scene.measure) r.measured = scene.measure(*simulation);
  if (!run.picture.empty()) {
    const sim::Capture state = sim::capture_world(*simulation, 0);
    draw_snapshot(run.picture, scene, state, view_of(scene, {&state}), run.on.threads);
  }
  if (!run.plot.empty()) draw_watched(run.plot, scene, r.watched);
  r.bodies = std::int64_t(scene.world.body.size());
  r.iterations = scene.settings.iterations;
  if (run.repeats > 0) time_steps(run, *simulation, driven, r);
  check_flags(scene, *simulation);
  r.contacts = simulation->report(0).contact_count;
  r.residual_m_per_s = simulation->report(0).rms_residual;
  return r;
}

namespace {

/// The smallest sphere that moves.
struct Smallest {
  double radius = std::numeric_limits<double>::infinity(), density = 0;
};

Smallest smallest_sphere(const sim::SceneWorld& world) {
  Smallest found;
  for (const sim::Shape& s : world.shape) {
    const double inverse = world.mass[s.body].inverse_mass.x, radius = s.size.x;
    if (s.type != sim::ShapeType::sphere || !(inverse > 0) || radius >= found.radius) continue;
    found = {radius, 3 / (4 * kPi * radius * radius * radius * inverse)};
  }
  return found;
}

}  // namespace

void set_penalty(ManyScene& scene, const Softness& softness) {
  sim::StepSettings& s = scene.settings;
  if (!sim::is_penalty(s.contact)) return;
  const Smallest sphere = smallest_sphere(scene.world);
  if (!(sphere.density > 0)) throw InputError(scene.name + ": penalty contact needs a sphere that moves");
  const double speed = std::sqrt(2 * kGravity * scene.world.size.z);
  s.penalty = sim::law_of_overlap(softness.overlap, speed, sphere.radius, sphere.density, softness.restitution);
  s.envelope = 0;  // only overlaps push
  s.cohesion_range = 0;
  s.step = Real(softness.share_of_step * sim::critical_step(scene.world, s).step);
}

std::vector<Sphere> loose_lattice(const Spheres& spec, const Vec3d& corner, Index nx, Index ny, Index nz,
                                  const std::function<bool(const Vec3d&)>& inside, std::size_t max_count) {
  std::vector<Sphere> spheres;
  std::uint64_t draw = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * random_unit(spec.seed, 0, draw++); };
  const double pitch = spec.pitch(), aside = 0.005 * spec.largest_diameter();
  for (Index z = 0; z < nz; ++z)
    for (Index y = 0; y < ny; ++y)
      for (Index x = 0; x < nx; ++x) {
        const double dx = between(-aside, aside), dy = between(-aside, aside), size = between(-1, 1);
        const Vec3d at = corner + Vec3d{(x + 0.5) * pitch + dx, (y + 0.5) * pitch + dy, (z + 0.5) * pitch};
        if (spheres.size() < max_count && inside(at))
          spheres.push_back({at, spec.diameter / 2 * (1 + spec.size_spread * size)});
      }
  return spheres;
}

std::vector<Sphere> loose_column(const Spheres& spec, double radius) {
  const double inside = radius * std::cos(kPi / kSegments) - spec.largest_diameter() / 2;
  const auto across = Index(std::ceil(2 * radius / spec.pitch()));
  const double corner = -across * spec.pitch() / 2;
  return loose_lattice(
      spec, {corner, corner, 0}, across, across, 4 * spec.count / (across * across) + 8,
      [&](const Vec3d& p) { return p.x * p.x + p.y * p.y < inside * inside; }, std::size_t(spec.count));
}

sim::BodyIndex add_wall(sim::SceneWorld& world, sim::TriangleMesh mesh, int material) {
  sim::Shape s;
  s.type = sim::ShapeType::mesh;
  s.surface = world.add_mesh(std::move(mesh));
  s.body = world.add_body({}, sim::fixed_body());
  s.material = material;
  s.group = 1;
  world.add_shape(s);
  return s.body;
}

sim::StepSettings many_step_settings(const Spheres& spec, int iterations, const sim::ContactMethod& solver) {
  sim::StepSettings s;
  s.step = Real(2e-3);
  s.iterations = iterations;
  s.contact = solver.contact;
  s.iteration = solver.iteration;
  s.envelope = Real(0.06 * spec.diameter);
  s.recovery_speed = Real(std::sqrt(kGravity * spec.diameter) / 10);
  return s;
}

void add_plane(sim::SceneWorld& world, sim::BodyIndex body, const Vec3d& at, const Quat& turn) {
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = body;
  plane.offset_B = static_cast<Vec3>(at);
  plane.turn_B = turn;
  world.add_shape(plane);
}

Quat towards(int axis, double sign) {
  const Real c = Real(std::sqrt(0.5)), s = Real(sign * std::sqrt(0.5));
  return axis == 0 ? Quat{c, 0, s, 0} : Quat{c, -s, 0, 0};
}

double fall_time(double height) { return std::sqrt(2 * height / kGravity); }

double height_of(const std::vector<Sphere>& spheres) {
  double height = 0;
  for (const Sphere& s : spheres) height = std::max(height, s.centre.z + s.radius);
  return height;
}

namespace {

constexpr int kWidth = 1280, kHeight = 720;

/// Speed that one body in twenty exceeds [m/s]; not zero.
double high_speed(const sim::Capture& state) {
  std::vector<double> speed;
  for (const sim::BodyState& b : state.body) speed.push_back(length(b.velocity));
  const auto at = speed.begin() + std::ptrdiff_t(speed.size() * 19 / 20);
  std::nth_element(speed.begin(), at, speed.end());
  return std::max(*at, 1e-3);
}

/// The scene's world without the shapes of fixed bodies.
sim::SceneWorld moving_parts(const ManyScene& scene) {
  sim::SceneWorld shown = scene.world;
  for (sim::Shape& s : shown.shape)
    if (sim::is_fixed(shown.mass[s.body])) s.type = sim::ShapeType::none;
  return shown;
}

report::GrainColour colour_of(const ManyScene& scene) {
  return scene.show_by_material ? report::GrainColour::material : report::GrainColour::speed;
}

std::string bar_label(const ManyScene& scene) { return scene.show_by_material ? "" : "speed [m/s]"; }

report::Model model_of(const ManyScene& scene, const sim::SceneWorld& shown, const sim::Capture& state, double high) {
  return report::model_of(shown, state, {.colour = colour_of(scene), .low = 0, .high = high});
}

std::vector<report::Fact> facts_of(const ManyScene& scene, const sim::Capture& state) {
  return {{"bodies", std::to_string(scene.world.body.size())}, {"time", line("%.2f s", state.time)}};
}

}  // namespace

void require_pictures(bool video) {
  report::require_pictures("--picture, --video, --plot");
  if (video) report::require_ffmpeg();
}

SnapshotView view_of(const ManyScene& scene, const std::vector<const sim::Capture*>& states) {
  const sim::SceneWorld shown = moving_parts(scene);
  SnapshotView view;
  report::Model all;
  std::vector<double> high;
  for (const sim::Capture* state : states) {
    const report::Model model = model_of(scene, shown, *state, 1);
    all.ball.insert(all.ball.end(), model.ball.begin(), model.ball.end());
    all.face.insert(all.face.end(), model.face.begin(), model.face.end());
    all.floor = state == states.front() ? model.floor : std::min(all.floor, model.floor);
    high.push_back(high_speed(*state));
  }
  const auto at = high.begin() + std::ptrdiff_t((high.size() - 1) * 3 / 4);
  std::nth_element(high.begin(), at, high.end());
  view.high_speed = *at;
  view.camera = report::frame_model(all, 0.5, 0.3, double(kWidth) / kHeight, report::kCaptionMargins);
  return view;
}

void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state,
                   const SnapshotView& view, int threads) {
  report::Caption caption{.title = scene.name, .facts = facts_of(scene, state)};
  if (!scene.show_by_material) report::add_bar(caption, bar_label(scene), 0, view.high_speed);
  report::write_shot({.path = path, .width = kWidth, .height = kHeight, .threads = threads},
                     model_of(scene, moving_parts(scene), state, view.high_speed), view.camera, caption);
}

void draw_watched(const std::filesystem::path& path, const ManyScene& scene,
                  const std::vector<std::vector<SceneNumber>>& watched) {
  report::LinePlot plot{.title = scene.name, .x_label = watched.front().front().key};
  for (std::size_t k = 1; k < watched.front().size(); ++k) {
    report::PlotLine line{watched.front()[k].key, {}, {}};
    for (const std::vector<SceneNumber>& look : watched) {
      line.add(look.front().value, look[k].value);
    }
    plot.lines.push_back(std::move(line));
  }
  report::draw_line_plot(path, plot);
}

double frame_rate(int count, double every) {
  constexpr double shortest = 6, slowest = 5;  // [s], [1/s]
  return std::min(1 / every, std::max(slowest, count / shortest));
}

void draw_video(const std::filesystem::path& path, const ManyScene& scene, const std::vector<sim::Capture>& states,
                double every, int threads) {
  constexpr std::size_t looks = 12;
  std::vector<const sim::Capture*> some;
  for (std::size_t k = 0; k < looks; ++k) some.push_back(&states[k * (states.size() - 1) / (looks - 1)]);
  const SnapshotView view = view_of(scene, some);
  report::Film film(
      {.video = path,
       .every = 1 / frame_rate(int(states.size()), every),
       .width = kWidth,
       .height = kHeight,
       .colour = colour_of(scene),
       .threads = threads},
      {.title = scene.name, .bar_label = bar_label(scene), .bar_high = view.high_speed, .camera = view.camera});
  const sim::SceneWorld shown = moving_parts(scene);
  for (const sim::Capture& state : states) film.add({.world = shown, .state = state, .facts = facts_of(scene, state)});
  film.finish();
}

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

double seconds_per_step(sim::Simulation& simulation, int repeats, int steps_per_sample) {
  std::vector<double> samples;
  for (int k = 0; k < repeats; ++k) {
    const double start = seconds();
    simulation.advance(steps_per_sample);  // returns when the device has finished
    samples.push_back((seconds() - start) / steps_per_sample);
  }
  return median(samples);
}

}  // namespace gonogo::lab
