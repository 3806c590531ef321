#include "pipeline/lab/scenes/picture.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "pipeline/report/film/video.h"
#include "pipeline/report/picture/render.h"
#ifdef GONOGO_WITH_PICTURES
#include "pipeline/report/figure/line_plot.h"
#include "pipeline/report/figure/trial_figure.h"
#endif

namespace gonogo::lab {
namespace {

constexpr int kWidth = 1280, kHeight = 720;

std::string text_of(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Speed that one body in twenty exceeds [m/s]; not zero.
double high_speed(const sim::Capture& state) {
  std::vector<double> speed;
  for (const sim::BodyState& b : state.body) speed.push_back(length(b.velocity));
  const auto at = speed.begin() + std::ptrdiff_t(speed.size() * 19 / 20);
  std::nth_element(speed.begin(), at, speed.end());
  return std::max(*at, 1e-3);
}

report::Model moving_parts(const ManyScene& scene, const sim::Capture& state, double high) {
  sim::SceneWorld shown = scene.world;
  for (sim::Shape& s : shown.shape)
    if (sim::is_fixed(shown.mass[s.body])) s.type = sim::ShapeType::none;
  return report::model_of(
      shown, state, {scene.show_by_material ? report::GrainColour::material : report::GrainColour::speed, 0, high, -1});
}

std::filesystem::path frame_path(const std::filesystem::path& folder, std::size_t k) {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%06zu.png", k);
  return folder / name;
}

}  // namespace

void require_pictures(bool video) {
#ifndef GONOGO_WITH_PICTURES
  throw InputError("this build has no pictures (--picture, --video, --plot); configure with -DGONOGO_PICTURES=ON");
#endif
  if (video) report::require_ffmpeg();
}

SnapshotView view_of(const ManyScene& scene, const std::vector<const sim::Capture*>& states) {
  SnapshotView view;
  report::Model all;
  std::vector<double> high;
  for (const sim::Capture* state : states) {
    const report::Model model = moving_parts(scene, *state, 1);
    all.ball.insert(all.ball.end(), model.ball.begin(), model.ball.end());
    all.face.insert(all.face.end(), model.face.begin(), model.face.end());
    all.floor = state == states.front() ? model.floor : std::min(all.floor, model.floor);
    high.push_back(high_speed(*state));
  }
  const auto at = high.begin() + std::ptrdiff_t((high.size() - 1) * 3 / 4);
  std::nth_element(high.begin(), at, high.end());
  view.high_speed = *at;
  view.camera = report::frame_model(all, 0.5, 0.3, double(kWidth) / kHeight, {0.03, 0.12, 0.12, 0.15});
  return view;
}

#ifdef GONOGO_WITH_PICTURES
namespace {

void add_bar(report::TrialCaption& caption, double high) {
  caption.bar_label = "speed [m/s]";
  caption.bar_high = high;
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const report::Light light = report::bar_colour((k + 0.5) / steps);
    for (const Real part : {light.x, light.y, light.z}) caption.bar_rgb.push_back(report::srgb(part));
  }
}

}  // namespace

void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state,
                   const SnapshotView& view, int threads) {
  const report::Model model = moving_parts(scene, state, view.high_speed);
  report::TrialCaption caption;
  caption.title = scene.name;
  caption.facts = {{"bodies", std::to_string(scene.world.body.size())}, {"time", text_of("%.2f s", state.time)}};
  if (!scene.show_by_material) add_bar(caption, view.high_speed);
  report::write_trial_figure(path, report::render(model, view.camera, kWidth, kHeight, threads), caption);
}

void draw_watched(const std::filesystem::path& path, const ManyScene& scene,
                  const std::vector<std::vector<Measured>>& watched) {
  report::LinePlot plot;
  plot.title = scene.name;
  plot.x_label = watched.front().front().key;
  for (std::size_t k = 1; k < watched.front().size(); ++k) {
    report::PlotLine line{watched.front()[k].key, {}, {}};
    for (const std::vector<Measured>& look : watched)
      line.x.push_back(look.front().value), line.y.push_back(look[k].value);
    plot.lines.push_back(std::move(line));
  }
  report::draw_line_plot(path, plot);
}
#else
void draw_snapshot(const std::filesystem::path&, const ManyScene&, const sim::Capture&, const SnapshotView&, int) {
  require_pictures(false);
}
void draw_watched(const std::filesystem::path&, const ManyScene&, const std::vector<std::vector<Measured>>&) {
  require_pictures(false);
}
#endif

double frame_rate(int count, double every) {
  constexpr double shortest = 6, slowest = 5;  // [s], [1/s]
  return std::min(1 / every, std::max(slowest, count / shortest));
}

void draw_video(const std::filesystem::path& path, const ManyScene& scene, const std::vector<sim::Capture>& states,
                double every, int threads) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("gonogo-bench-" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  constexpr std::size_t looks = 12;
  std::vector<const sim::Capture*> some;
  for (std::size_t k = 0; k < looks; ++k) some.push_back(&states[k * (states.size() - 1) / (looks - 1)]);
  const SnapshotView view = view_of(scene, some);
  for (std::size_t k = 0; k < states.size(); ++k) draw_snapshot(frame_path(folder, k), scene, states[k], view, threads);
  report::make_video(folder, int(states.size()), frame_rate(int(states.size()), every), path);
  std::filesystem::remove_all(folder);
}

}  // namespace gonogo::lab
