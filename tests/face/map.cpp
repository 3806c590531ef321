#include <gonogo/map.h>

#include <cmath>
#include <filesystem>

#include "tests/support/catch.h"

using namespace gonogo::api;

namespace {

const std::filesystem::path kDem =
    std::filesystem::path(GONOGO_SOURCE_DIR) / "configs/regions/sagehen/elevation_10m.tif";

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_face_map";
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

MapRequest request(const std::filesystem::path& out, const std::string& moisture) {
  return {.model = "hmmwv",
          .dem = kDem,
          .soil = "sandy loam",
          .moisture = moisture,
          .mission = {{"payload", 500}},
          .out = out,
          .threads = 2};
}

}  // namespace

TEST_CASE("a map of the face shares its area between verdicts, is read as a raster, and is made once") {
  const Folder folder;
  const MapSummary moist = make_map(request(folder.path / "moist", "moist"));
  double sum = 0;
  for (const auto& [verdict, share] : moist.share) sum += share;
  CHECK(sum == Approx(1));
  CHECK(moist.share.at(Verdict::go) > 0.1);
  CHECK(moist.area_km2 == Approx(745 * 690 * 1e-4).epsilon(0.02));
  CHECK_FALSE(moist.reused);
  CHECK(make_map(request(folder.path / "moist", "moist")).reused);

  const Raster p = read_raster(folder.path / "moist" / "p_go.tif");
  CHECK(p.columns == 745);
  CHECK(p.rows == 690);
  CHECK(p.cell_width == Approx(10));
  CHECK(p.west == Approx(214270));
  CHECK_FALSE(p.crs.empty());
  for (const float value : p.value)
    if (!std::isnan(value)) REQUIRE((value >= 0 && value <= 1));
  CHECK(read_raster(kDem).value.size() == std::size_t(745 * 690));

  make_map(request(folder.path / "dry", "dry"));
  const MapComparison compared = compare_maps(folder.path / "moist", folder.path / "dry", folder.path / "compared");
  CHECK(compared.passing.size() == 5);
  CHECK_FALSE(compared.significance.empty());
  CHECK_FALSE(compared.files.empty());
}

TEST_CASE("routes of the face lead from start to end, the shortest being no longer than the safest") {
  const Folder folder;
  RouteRequest asked;
  asked.map = request({}, "dry");
  asked.start = {218000, 4370000};
  asked.end = {219000, 4371000};
  asked.costs = {"shortest", "safest"};
  asked.lines = folder.path / "way.geojson";
  const std::vector<Route> routes = plan_routes(asked);
  REQUIRE(routes.size() == 2);
  REQUIRE(routes[0].found);
  REQUIRE(routes[1].found);
  CHECK(routes[0].cost == "shortest");
  CHECK(routes[0].length >= std::hypot(1000, 1000) - 1);
  CHECK(routes[0].length <= routes[1].length + 1);
  CHECK(routes[1].chance >= routes[0].chance - 3 * (routes[0].chance_error + routes[1].chance_error));
  CHECK(std::filesystem::exists(asked.lines));
  asked.end = {0, 0};
  CHECK_THROWS_AS(plan_routes(asked), InputError);
}
