// A map too large for its page, served to a real browser: zoomed in, it draws the GeoTIFFs' own cells.
#include <cmath>
#include <cstdlib>
#include <thread>

#include "base/files/file.h"
#include "base/json/json.h"
#include "pipeline/map/map_view.h"
#include "terrain/raster/raster_source.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using terrain::RasterSource;
using terrain::Tile;

namespace {

constexpr int kSide = 1200;  // more cells than a page holds: it keeps one of four

/// Hills of up to 35 degrees.
MapRequest hills(const TemporaryFolder& folder) {
  test::make_wavy_region(folder, "hills", {kSide, 40, 6, 9});
  return test::request_of_region(folder, "map");
}

Json colour_of(const std::string& hex) {
  Json::Array rgb;
  for (const std::size_t at : {1, 3, 5}) rgb.push_back(Json(std::stoi(hex.substr(at, 2), nullptr, 16)));
  return Json(rgb);
}

/// Cells about a corner of four tiles.
Json expected_cells(const std::filesystem::path& map) {
  const RasterSource go = RasterSource::open_elevation(map / "go.tif");
  const Tile verdict = go.read({480, 480, 64, 64});
  const Tile p =
      RasterSource::open_on_grid(map / "p_go.tif", go.grid(), terrain::RasterKind::classes).read({480, 480, 64, 64});
  Json cells = Json::array();
  for (int row = 1; row < 64; row += 5)
    for (int column = 2; column < 64; column += 7) {
      const auto& info = contract().info(Verdict(int(verdict.at(column, row))));
      Json cell = Json::object();
      cell["column"] = 480 + column;
      cell["row"] = 480 + row;
      cell["go"] = info.code;
      cell["colour"] = colour_of(info.colour);
      cell["p_go"] = std::isnan(p.at(column, row)) ? Json() : Json(double(p.at(column, row)));
      cells.push_back(cell);
    }
  return cells;
}

}  // namespace

TEST_CASE(
    "a served map of many cells draws the GeoTIFFs' cells in a browser that zooms in, and reads them on a click") {
  const TemporaryFolder folder;
  const MapRequest request = hills(folder);
  const MapSummary summary = make_map(request);
  CHECK(summary.area.share(Verdict::go) > 0.2);
  CHECK(summary.area.share(Verdict::no_go) > 0.05);
  Json expected = Json::object();
  expected["title"] = "hills";
  expected["cells"] = expected_cells(request.out);
  write_file_atomically(request.out / "view_expected.json", expected.dump());

  const MapView view(request.out);
  HttpServer server("127.0.0.1", 0);
  std::thread serving([&] { server.run([&](const std::string& path) { return view.answer(path); }); });
  const char* pictures = std::getenv("GONOGO_PAGE_PICTURES");  // folder for screenshots, to look at
  const std::string command =
      std::string("python3 '" GONOGO_SOURCE_DIR "/tests/page/check_view.py' '" GONOGO_BROWSER "' 'http://127.0.0.1:") +
      std::to_string(server.port()) + "/' '" + request.out.string() + "'" +
      (pictures ? std::string(" '") + pictures + "'" : "");
  CHECK(std::system(command.c_str()) == 0);
  server.stop();
  serving.join();
}
