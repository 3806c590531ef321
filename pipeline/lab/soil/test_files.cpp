#include "base/file.h"
#include "base/units.h"
#include "pipeline/lab/soil/soil_tests.h"
#ifdef GONOGO_WITH_PICTURES

#include "pipeline/report/figure/trial_figure.h"
#include "pipeline/report/picture/render.h"
#endif

namespace gonogo::lab {
namespace {

#ifdef GONOGO_WITH_PICTURES
constexpr int kWidth = 1280, kHeight = 720, kBarSteps = 128;

/// The grains in colours of their height.
void draw_scene(const std::filesystem::path& path, const std::string& title, const terrain::TestScene& scene,
                int threads) {
  double low = 1e30, high = -1e30;
  for (const sim::Shape& s : scene.world.shape) {
    if (s.type != sim::ShapeType::sphere || sim::is_fixed(scene.world.mass[std::size_t(s.body)])) continue;
    const double z = sim::centre_of(s, scene.end.body[std::size_t(s.body)]).z + double(s.size.x);
    low = std::min(low, z), high = std::max(high, z);
  }
  // Walls would hide the grains.
  sim::SceneWorld shown = scene.world;
  std::erase_if(shown.shape, [](const sim::Shape& s) { return s.type == sim::ShapeType::plane; });
  const report::Model model = report::model_of(shown, scene.end, {report::GrainColour::height, low, high, -1});
  const report::Camera camera =
      report::frame_model(model, 16 * kDegree, 16 * kDegree, double(kWidth) / kHeight, {0.03, 0.12, 0.12, 0.15});
  report::TrialCaption c;
  c.title = title;
  c.bar_label = "height of grain [m]", c.bar_low = low, c.bar_high = high;
  for (int k = 0; k < kBarSteps; ++k) {
    const report::Light light = report::bar_colour((k + 0.5) / kBarSteps);
    for (const Real part : {light.x, light.y, light.z}) c.bar_rgb.push_back(report::srgb(part));
  }
  report::write_trial_figure(path, report::render(model, camera, kWidth, kHeight, threads), c);
}
#endif

}  // namespace

void write_soil_test(const std::filesystem::path& folder, const std::string& test, const SoilTestOutcome& outcome,
                     [[maybe_unused]] int threads) {
  create_folder(folder);
  write_file_atomically(folder / (test + ".csv"), outcome.csv);
#ifdef GONOGO_WITH_PICTURES
  report::draw_line_plot(folder / (test + ".png"), outcome.plot);
  draw_scene(folder / (test + "_bed.png"), outcome.plot.title, outcome.scene, threads);
#endif
  write_file_atomically(folder / (test + ".json"), outcome.json.dump(2) + "\n");
}

}  // namespace gonogo::lab
