#include "base/file.h"
#include "base/units.h"
#include "pipeline/lab/soil/soil_tests.h"
#include "pipeline/report/figure/pictures.h"
#include "pipeline/report/film/shot.h"

namespace gonogo::lab {
namespace {

/// The grains in colours of their height.
void draw_scene(const std::filesystem::path& path, const std::string& title, const terrain::TestScene& scene,
                int threads) {
  double low = 1e30, high = -1e30;
  for (const sim::Shape& s : scene.world.shape) {
    if (s.type != sim::ShapeType::sphere || sim::is_fixed(scene.world.mass[std::size_t(s.body)])) continue;
    const double z = sim::centre_of(s, scene.end.body[std::size_t(s.body)]).z + double(s.size.x);
    low = std::min(low, z);
    high = std::max(high, z);
  }
  // Walls would hide the grains.
  sim::SceneWorld shown = scene.world;
  std::erase_if(shown.shape, [](const sim::Shape& s) { return s.type == sim::ShapeType::plane; });
  const report::Model model =
      report::model_of(shown, scene.end, {.colour = report::GrainColour::height, .low = low, .high = high});
  const report::ShotFile file{.path = path, .threads = threads};
  const report::Camera camera =
      report::frame_model(model, 16 * kDegree, 16 * kDegree, double(file.width) / file.height, report::kCaptionMargins);
  report::Caption caption{.title = title};
  report::add_bar(caption, "height of grain [m]", low, high);
  report::write_shot(file, model, camera, caption);
}

}  // namespace

void write_soil_test(const std::filesystem::path& folder, const std::string& test, const SoilTestOutcome& outcome,
                     int threads) {
  create_folder(folder);
  write_file_atomically(folder / (test + ".csv"), outcome.csv);
  report::draw_line_plot(folder / (test + ".png"), outcome.plot);
  if (report::pictures_available())
    draw_scene(folder / (test + "_bed.png"), outcome.plot.title, outcome.scene, threads);
  write_file_atomically(folder / (test + ".json"), outcome.json.dump(2) + "\n");
}

}  // namespace gonogo::lab
