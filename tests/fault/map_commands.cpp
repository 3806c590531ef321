// From trials to a map by the program alone: model, its members, a map, another with a wider interval, a route, two
// maps compared; and the smallest rasters that there are.
#include <cmath>
#include <sstream>

#include "base/files/file.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "terrain/raster/raster_source.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/pipeline/outcome/synthetic_trials.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"
#include "tests/terrain/translate.h"

namespace gonogo {
namespace {

using terrain::RasterKind;
using terrain::RasterSource;
using terrain::Tile;

const std::string kHmmwv = GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv.json";

/// Ground of `side` x `side` cells that grows steeper eastward, sandy but for clay in its southern half.
std::string make_region(const TemporaryFolder& folder, int side) {
  std::vector<float> height, soil;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      height.push_back(float(1000 + 0.05 * column * column));
      soil.push_back(row < side / 2 ? 1 : 2);
    }
  test::make_raster(folder / "dem.tif", {.columns = side, .rows = side, .value = height});
  test::make_raster(folder / "soil.tif", {.columns = side, .rows = side, .value = soil, .type = GDT_Byte});
  const std::string values = R"("relative_density": 0.5, "payload": 500, "tyre_friction": 0.8, "source": "made"}]})";
  write_file_atomically(folder / "region.json", R"({"schema": "gonogo/region/1", "region": "made", "rasters": [
    {"role": "elevation", "file": "dem.tif", "source": "made", "licence": "none",
     "error_m": 0.5, "error_source": "made"},
    {"role": "soil_class", "file": "soil.tif", "source": "made", "licence": "none"}], "soils": [
    {"code": 1, "name": "ground", "texture": "sand", "samples": [{"friction_angle": 33, "cohesion": 2, )" +
                                                    values +
                                                    R"(, {"code": 2, "name": "wet clay", "texture": "clay", "samples": [
     {"friction_angle": 21, "cohesion": 3, )" + values +
                                                    "]}");
  return folder / "region.json";
}

/// A model of synthetic trials, with members.
void train(const TemporaryFolder& folder, int members) {
  campaign::write_dataset(folder / "dataset.h5", {outcome::synthetic_trials(160, 4), {}});
  write_file_atomically(folder / "study.json", R"({"study": "t", "seed": 1, "learning": {"epochs": 20, "folds": 2}})");
  const Ending ending = run_gonogo({"train", "--dataset", folder / "dataset.h5", "--study", folder / "study.json",
                                    "--out", folder / "model.h5", "--members", std::to_string(members)});
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
}

Json map(const TemporaryFolder& folder, const std::string& out, const std::vector<std::string>& more) {
  std::vector<std::string> words = {
      "map", "--model", folder / "model.h5", "--region", folder / "region.json", "--out", folder / out, "--json"};
  words.insert(words.end(), more.begin(), more.end());
  const Ending ending = run_gonogo(words);
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
  return Json::parse(ending.out, "stdout");
}

Tile layer(const std::filesystem::path& file) {
  const auto grid = RasterSource::open_elevation(file.parent_path() / "go.tif").grid();
  return RasterSource::open_on_grid(file, grid, RasterKind::classes).read({0, 0, grid.columns, grid.rows});
}

TEST_CASE("trials, a model with members, maps, a route and a comparison by the program alone") {
  const TemporaryFolder folder;
  make_region(folder, 60);
  train(folder, 3);
  map(folder, "alone", {"--whole-vehicle", kHmmwv});
  const Json spread = map(folder, "spread",
                          {"--whole-vehicle", kHmmwv, "--members", folder / "model.member1.h5",
                           folder / "model.member2.h5", folder / "model.member3.h5"});
  CHECK(spread.at("share").at("go").number() > 0.05);
  const auto width = [&](const std::string& name) {
    const Tile low = layer(folder / (name + "/p_go_low.tif")), high = layer(folder / (name + "/p_go_high.tif"));
    double sum = 0;
    for (int row = 2; row < 28; ++row)
      for (int column = 2; column < 58; ++column) sum += high.at(column, row) - low.at(column, row);
    return sum;
  };
  CHECK(width("spread") > 1.2 * width("alone"));
  CHECK(layer(folder / "spread/p_go.tif").at(5, 5) == layer(folder / "alone/p_go.tif").at(5, 5));
  const Json record = Json::read(folder / "spread/map.json");
  CHECK(record.at("inputs").at("member_hashes").items().size() == 3);
  CHECK(layer(folder / "spread/go.tif").at(5, 5) == int(campaign::Verdict::go));
  CHECK(layer(folder / "spread/reason.tif").at(5, 50) == int(campaign::Reason::soft_soil));

  const auto routed = [&](const std::string& row) {  // straight uphill
    const Ending ending =
        run_gonogo({"route", "--model", folder / "model.h5", "--region", folder / "region.json", "--whole-vehicle",
                    kHmmwv, "--from", "500055," + row, "--to", "500205," + row, "--json"});
    INFO(ending.err);
    const Json answer = Json::parse(ending.out, "stdout");
    const bool found = answer.at("routes").items()[0].at("found").boolean();
    REQUIRE(ending.exit_code == (found ? 0 : 1));
    CHECK(found == (answer.find("dead_end") == nullptr));
    if (!found) CHECK(contains(answer.at("dead_end").at("by").string(), "clay"));
    return found;
  };
  CHECK(routed("4399945"));
  CHECK_FALSE(routed("4399495"));  // soft clay

  const Ending both = run_gonogo({"compare", folder / "alone", folder / "spread", "--out", folder / "both", "--json"});
  REQUIRE(both.exit_code == 0);
  const Json::Array& change = Json::parse(both.out, "stdout").at("change").items();
  CHECK(change.at(1).at("cells").integer() + change.at(2).at("cells").integer() == 0);  // P(go) is the same
}

TEST_CASE("the smallest ground that has a slope is three by three cells; of one pixel a map says nothing") {
  const TemporaryFolder folder;
  make_region(folder, 3);
  train(folder, 0);
  const Json one = map(folder, "one", {"--whole-vehicle", kHmmwv});
  CHECK(one.at("area_km2").number() == Approx(1e-4));
  make_region(folder, 1);
  check_refusal(
      run_gonogo({"map", "--model", folder / "model.h5", "--region", folder / "region.json", "--out", folder / "none"}),
      2, {"dem.tif", "1 x 1", "3 x 3"});
  CHECK_FALSE(std::filesystem::exists(folder / "none"));
}

}  // namespace
namespace {

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t from = text.find(before);
  REQUIRE(from != std::string::npos);
  const std::size_t begin = from + before.size(), end = text.find(after, begin);
  REQUIRE(end != std::string::npos);
  return text.substr(begin, end - begin);
}

}  // namespace

TEST_CASE("the advice for an elevation model without a coordinate system works when it is followed") {
  StudyFolder study;
  study.write();
  std::filesystem::remove(study.path("elevation.prj"));
  const TemporaryFolder folder;
  const auto map_of = [&](const std::string& dem, const std::string& out) {
    return run_gonogo({"map", "--model", "hmmwv", "--dem", dem, "--soil", "sand, dry", "--out", folder / out});
  };
  const Ending refused = map_of(study.path("elevation.asc"), "none");
  REQUIRE(refused.exit_code == 2);
  std::istringstream command(between(refused.err, "with: gdal_translate -a_srs ", ". A grid"));
  std::string code, in, out;
  command >> code >> in >> out;
  CHECK(code == "EPSG:<code>");
  CHECK(in == study.path("elevation.asc").string());
  CHECK(out == "with_system.tif");
  test::translate(in, "EPSG:32610", folder / "with_system.tif");
  CHECK(map_of(folder / "with_system.tif", "map").exit_code == 0);
  test::translate(in, between(refused.err, "takes -a_srs '", "'"), folder / "site.tif");
  CHECK(map_of(folder / "site.tif", "site").exit_code == 0);
}

}  // namespace gonogo
