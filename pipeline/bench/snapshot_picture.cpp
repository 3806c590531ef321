#include "pipeline/bench/snapshot_picture.h"

#include "base/error.h"
#ifdef GONOGO_WITH_PICTURES
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "pipeline/picture/render.h"
#include "pipeline/report/trial_figure.h"
#endif

namespace gonogo::pipeline {

#ifdef GONOGO_WITH_PICTURES
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

}  // namespace

void require_pictures() {}

void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state, int threads) {
  sim::SceneWorld shown = scene.world;
  for (sim::Shape& s : shown.shape)
    if (sim::is_fixed(shown.mass[s.body])) s.type = sim::ShapeType::none;
  const double high = high_speed(state);
  const Model model = model_of(shown, state, {GrainColour::speed, 0, high, -1});
  const Camera camera = frame_model(model, 0.5, 0.3, double(kWidth) / kHeight, {0.03, 0.12, 0.12, 0.15});
  TrialCaption caption;
  caption.title = scene.name;
  caption.facts = {{"bodies", std::to_string(scene.world.body.size())},
                   {"contacts", std::to_string(state.contact.size())},
                   {"time", text_of("%.2f s", state.time)}};
  caption.bar_label = "speed [m/s]";
  caption.bar_high = high;
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const Light light = bar_colour((k + 0.5) / steps);
    for (const Real part : {light.x, light.y, light.z}) caption.bar_rgb.push_back(srgb(part));
  }
  write_trial_figure(path, render(model, camera, kWidth, kHeight, threads), caption);
}
#else
void require_pictures() {
  throw InputError("this build has no pictures (--picture); configure with -DGONOGO_PICTURES=ON");
}
void draw_snapshot(const std::filesystem::path&, const ManyScene&, const sim::Capture&, int) {}
#endif

}  // namespace gonogo::pipeline
