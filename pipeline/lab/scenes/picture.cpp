#include "pipeline/lab/scenes/picture.h"

#include <algorithm>
#include <cstdio>

#include "pipeline/report/figure/line_plot.h"
#include "pipeline/report/figure/pictures.h"
#include "pipeline/report/film/film.h"
#include "pipeline/report/film/video.h"

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
  return {{"bodies", std::to_string(scene.world.body.size())}, {"time", text_of("%.2f s", state.time)}};
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
                  const std::vector<std::vector<Measured>>& watched) {
  report::LinePlot plot;
  plot.title = scene.name;
  plot.x_label = watched.front().front().key;
  for (std::size_t k = 1; k < watched.front().size(); ++k) {
    report::PlotLine line{watched.front()[k].key, {}, {}};
    for (const std::vector<Measured>& look : watched) {
      line.x.push_back(look.front().value);
      line.y.push_back(look[k].value);
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

}  // namespace gonogo::lab
