// The lunar model that ships: a map of lunar ground, and the Earth refused.
#include "pipeline/map/map_request.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/map/write/make_map.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

const std::string kSource = GONOGO_SOURCE_DIR;

MapFiles lunar_files(const TemporaryFolder& folder, const std::string& dem) {
  MapFiles files;
  files.model = "viper";
  files.dem = dem;
  files.soil = "grc1";
  files.set = {"relative_density=0.5"};
  files.out = folder / "map";
  return files;
}

}  // namespace

TEST_CASE("the lunar model that ships was trained on its trials at the Moon's gravity") {
  CHECK(find_model("viper") == find_model("viper_32mm"));
  const TrainedModel model = read_trained_model(find_model("viper"));
  REQUIRE(model.vehicle);
  INFO("model.h5 is older than dataset.h5: train it again (data/viper_32mm/README.md)");
  CHECK(model.is_up_to_date);
  CHECK(model.vehicle->name == "viper");
  CHECK(model.vehicle->fidelity() == "whole vehicle on grains of 32 mm, 6.2 across a wheel, gravity 1.62 m/s2");
}

TEST_CASE("the lunar model maps a lunar crater: its floor goes, its walls do not") {
  const TemporaryFolder folder;
  const MapSummary summary = make_map(read_map_request(lunar_files(folder, kSource + "/data/viper_32mm/crater.tif")));
  CHECK(summary.gravity == 1.62);
  CHECK(summary.area.share(Verdict::go) > 0.3);
  CHECK(summary.area.share(Verdict::no_go) > 0.05);
  const Json inputs = Json::read(folder / "map/map.json").at("inputs");
  CHECK(inputs.at("gravity_m_per_s2").number() == 1.62);
}

TEST_CASE("the lunar model refuses ground of the Earth, and the Earth's model a lunar crater") {
  const TemporaryFolder folder;
  MapFiles files = lunar_files(folder, kSource + "/configs/regions/sagehen/elevation_10m.tif");
  CHECK(contains(input_error([&] { make_map(read_map_request(files)); }),
                 "lies on the Earth with a gravity of 9.81 m/s2, and the trials of the model had 1.62 m/s2"));
  files = lunar_files(folder, kSource + "/data/viper_32mm/crater.tif");
  files.model = "hmmwv";
  CHECK(contains(input_error([&] { make_map(read_map_request(files)); }),
                 "lies on the Moon with a gravity of 1.62 m/s2, and the trials of the model had 9.81 m/s2"));
  CHECK_FALSE(std::filesystem::exists(folder / "map"));
}
