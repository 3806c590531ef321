// What sentences advise is done, word for word: commands with their placeholders filled in, options, and changes of
// files.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/files/file.h"
#include "base/shell.h"
#include "tests/fault/program.h"
#include "tests/fault/shell.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// From the first place of `begin` up to `end`, or to the end of the line; `begin` is part of it.
std::string advice(const std::string& text, const std::string& begin, const std::string& end = "\n") {
  const std::size_t from = text.find(begin);
  INFO(text);
  REQUIRE(from != std::string::npos);
  return text.substr(from, text.find(end, from) - from);
}

std::string filled(std::string command, const std::string& placeholder, const std::string& value) {
  const std::size_t at = command.find(placeholder);
  INFO(command);
  REQUIRE(at != std::string::npos);
  return command.replace(at, placeholder.size(), value);
}

std::string filled(std::string command, const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [placeholder, value] : values) command = filled(std::move(command), placeholder, value);
  return command;
}

/// A ground of 24 x 40 cells in files of several kinds, and maps of them.
class Ground {
 public:
  Ground() {
    study_.write();
    gdal("gdal_translate -q", "elevation.asc", "ok.tif");
  }

  fs::path path(const std::string& name) const { return study_.path(name); }

  /// Runs a program of GDAL from one file of this folder to another.
  void gdal(const std::string& command, const std::string& from, const std::string& to) const {
    follow(command + " " + shell_word(path(from).string()) + " " + shell_word(path(to).string()));
  }

  /// Runs a command of a sentence in this folder, for the file that it makes.
  void follow(const std::string& command) const {
    const ShellEnding ending = shell("cd " + shell_word(path("").string()) + " && " + command);
    INFO(command << ": " << ending.output);
    REQUIRE(ending.status == 0);
  }

  Words words(const std::string& dem, const Words& more = {}) const {
    return with({"map", "--model", "hmmwv", "--dem", path(dem), "--soil", "sand", "--moisture", "dry", "--out",
                 path("map " + std::to_string(++count_))},
                more);
  }

  /// What a refused map says.
  std::string refused(const std::string& dem, const Words& more = {}) const {
    const Ending ending = run_gonogo(words(dem, more));
    INFO(ending.err);
    REQUIRE(ending.exit_code == 2);
    return ending.err;
  }

  /// What a made map says.
  std::string made(const std::string& dem, const Words& more = {}) const { return said(words(dem, more)); }

  static std::string said(const Words& words) {
    const Ending ending = run_gonogo(words);
    INFO(ending.err);
    REQUIRE(ending.exit_code == 0);
    return ending.out + ending.err;
  }

  /// The elevations with one of the numbers replaced, as another file.
  void change(const std::string& from, const std::string& to, int rows) const {
    std::istringstream in(read_file(path("elevation.asc")));
    std::string text, line;
    for (int row = 0; std::getline(in, line); ++row) {
      if (line.rfind("NODATA", 0) == 0) continue;  // nothing is declared
      if (row >= 20 && row < 20 + rows) line = from + line.substr(line.find(' '));
      text += line + "\n";
    }
    write_file_atomically(path(to + ".asc"), text);
    fs::copy_file(path("elevation.prj"), path(to + ".prj"));
  }

 private:
  StudyFolder study_;
  mutable int count_ = 0;
};

/// All command lines of the program in a sentence parse.
void check_parses(std::istringstream lines) {
  std::string line;
  while (std::getline(lines, line, ';')) {
    const std::size_t at = line.find("gonogo ");
    if (at == std::string::npos) continue;
    std::istringstream in(line.substr(at + 7));
    Words words{"parse", "--"};
    for (std::string word; in >> word;) words.push_back(word);
    INFO(line);
    CHECK(run_gonogo(words).exit_code == 0);
  }
}

}  // namespace

TEST_CASE("commands for an elevation model that is not as it should be make one that is") {
  const Ground ground;
  const struct {
    std::string make, begin, makes;
    std::vector<std::pair<std::string, std::string>> fill;
  } cases[] = {
      {"gdal_translate -q -gcp 0 0 730000 4368400 -gcp 24 0 730240 4368400 -gcp 0 40 730000 4368000 -a_srs EPSG:32610",
       "gdalwarp -r bilinear",
       "on_a_grid.tif",
       {}},
      {"gdal_translate -q -b 1 -b 1 -b 1 -b 1", "gdal_translate -b 1", "heights.tif", {}},
      {"gdal_translate -q -a_scale 0 -a_offset 0",
       "gdal_translate -a_scale",
       "scaled.tif",
       {{"<scale>", "1"}, {"<offset>", "0"}}}};
  for (const std::string bad : {"bad.tif", "it's bad (1) & $more.tif"})
    for (const auto& c : cases) {
      fs::remove(ground.path(bad));
      fs::remove(ground.path(c.makes));
      ground.gdal(c.make, "ok.tif", bad);
      ground.follow(filled(advice(ground.refused(bad), c.begin), c.fill));
      ground.made(c.makes);
    }
}

TEST_CASE("a raster that lies askew is straightened by the command that its refusal names") {
  const Ground ground;
  write_file_atomically(ground.path("askew.vrt"),
                        std::string("<VRTDataset rasterXSize=\"24\" rasterYSize=\"40\"><SRS>EPSG:32610</SRS>") +
                            "<GeoTransform>730000,9.8,2,4368400,2,-9.8</GeoTransform><VRTRasterBand "
                            "dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"1\">ok.tif"
                            "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
  ground.follow(advice(ground.refused("askew.vrt"), "gdalwarp"));
  ground.made("north_up.tif");
}

/// A virtual raster over ok.tif, 24 x 40 cells.
std::string virtual_raster(const std::string& system, const std::string& transform, const std::string& band) {
  return "<VRTDataset rasterXSize=\"24\" rasterYSize=\"40\"><SRS>" + system + "</SRS><GeoTransform>" + transform +
         "</GeoTransform><VRTRasterBand dataType=\"Float32\" band=\"1\">" + band + "</VRTRasterBand></VRTDataset>";
}

/// The value of a cell in the middle column, by gdallocationinfo.
double value_of(const Ground& ground, const std::string& file, int row = 20) {
  const ShellEnding ending =
      shell("gdallocationinfo -valonly " + shell_word(ground.path(file).string()) + " 12 " + std::to_string(row));
  INFO(ending.output);
  REQUIRE(ending.status == 0);
  return std::stod(ending.output);
}

TEST_CASE("heights in centimetres become metres, not whole ones, by the command that the refusal names") {
  const Ground ground;
  ground.gdal("gdal_translate -q -ot Int32 -scale 0 1 0 100", "ok.tif", "whole.tif");
  write_file_atomically(ground.path("cm.vrt"),
                        virtual_raster("EPSG:32610", "730000,10,0,4368400,0,-10",
                                       "<UnitType>cm</UnitType><SimpleSource><SourceFilename relativeToVRT=\"1\">"
                                       "whole.tif</SourceFilename></SimpleSource>"));
  ground.follow(filled(advice(ground.refused("cm.vrt"), "gdal_calc.py"), "<metres>", "0.01"));
  ground.made("metres.tif");
  CHECK(value_of(ground, "metres.tif") == Approx(value_of(ground, "ok.tif")).margin(0.0051));
}

TEST_CASE("degrees that are said to be metres are called degrees by the command that the refusal names") {
  const Ground ground;
  write_file_atomically(ground.path("degrees.vrt"),
                        virtual_raster("EPSG:32610", "-120.3,0.0001,0,39.4,0,-0.0001",
                                       "<SimpleSource><SourceFilename relativeToVRT=\"1\">ok.tif</SourceFilename>"
                                       "</SimpleSource>"));
  ground.follow(advice(ground.refused("degrees.vrt"), "gdal_translate -a_srs EPSG:4326"));
  ground.made("in_degrees.tif");
}

TEST_CASE("a raster that does not say where it lies is placed by the command that its refusal names") {
  const Ground ground;
  write_file_atomically(ground.path("lost.vrt"),
                        "<VRTDataset rasterXSize=\"24\" rasterYSize=\"40\"><SRS>EPSG:32610</SRS><VRTRasterBand "
                        "dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"1\">ok.tif"
                        "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
  ground.follow(filled(advice(ground.refused("lost.vrt"), "gdal_translate -a_ullr"),
                       {{"<west>", "730000"}, {"<north>", "4368400"}, {"<east>", "730240"}, {"<south>", "4368000"}}));
  ground.made("placed.tif");
}

TEST_CASE("voids that a second band marks become voids of a mask by the command that the refusal names") {
  const Ground ground;
  ground.follow("gdal_calc.py --quiet -A ok.tif --calc '255 * (A < 2040)' --type Float32 --outfile high.tif");
  ground.follow("gdalbuildvrt -q -separate both.vrt ok.tif high.tif");
  ground.gdal("gdal_translate -q -colorinterp_2 alpha -co ALPHA=YES", "both.vrt", "marked.tif");
  ground.follow(advice(ground.refused("marked.tif"), "gdal_translate -b 1 -mask 2"));
  const std::string made = ground.made("masked.tif"), go = advice(made, ground.path("map ").string());
  CHECK(value_of(ground, fs::path(go).lexically_relative(ground.path("")).string(), 0) == 255);
  CHECK(value_of(ground, fs::path(go).lexically_relative(ground.path("")).string(), 30) < 4);
}

TEST_CASE("an elevation model around the globe is cut by the command that its refusal names") {
  const Ground ground;
  ground.gdal("gdal_translate -q -a_srs EPSG:4326 -a_ullr -150 60 30 -40 -outsize 18000 10000 -co COMPRESS=DEFLATE",
              "ok.tif", "wide.tif");
  ground.follow(filled(advice(ground.refused("wide.tif"), "gdalwarp -te"),
                       {{"<west>", "-121"}, {"<south>", "39"}, {"<east>", "-120"}, {"<north>", "40"}}));
  ground.made("cut.tif");
}

TEST_CASE("tiles in two systems are brought to one by the command that the refusal names") {
  const Ground ground;
  ground.gdal("gdal_translate -q -srcwin 0 0 12 40", "ok.tif", "left.tif");
  ground.gdal("gdal_translate -q -srcwin 12 0 12 40", "ok.tif", "right_there.tif");
  ground.gdal("gdalwarp -q -r bilinear -t_srs EPSG:32611", "right_there.tif", "right.tif");
  const auto map_of = [&](const std::string& right) {
    Json region = Json::read(ground.path("region.json"));
    Json raster;
    for (const auto& [key, value] : region.at("rasters").items().front().members())
      if (key != "file") raster[key] = value;
    raster["files"] = Json::Array{Json("left.tif"), Json(right)};
    region["rasters"] = Json::Array{raster};
    write_file_atomically(ground.path(right + ".json"), region.dump());
    return run_gonogo(
        {"map", "--model", "hmmwv", "--region", ground.path(right + ".json"), "--out", ground.path(right + " map")});
  };
  const Ending apart = map_of("right.tif");
  check_refusal(apart, 2, {"right.tif", "tiles of one raster must share it"});
  ground.follow(advice(apart.err, "gdalwarp"));
  const Ending together = map_of("tile.tif");
  INFO(together.err);
  CHECK(together.exit_code == 0);
}

TEST_CASE("a raster without a system gets one, and the second of two bands is taken out, as sentences say") {
  const Ground ground;
  fs::copy_file(ground.path("elevation.asc"), ground.path("nowhere.asc"));
  const std::string nowhere = ground.refused("nowhere.asc");
  const std::string local = "'LOCAL_CS[\"site\",UNIT[\"metre\",1]]'";
  CHECK(contains(nowhere, "-a_srs " + local));
  for (const std::string& system : {std::string("EPSG:32610"), local}) {
    fs::remove(ground.path("with_system.tif"));
    ground.follow(filled(advice(nowhere, "gdal_translate -a_srs", ". A grid"), "EPSG:<code>", system));
    ground.made("with_system.tif");
  }
  ground.gdal("gdal_translate -q -b 1 -b 1", "ok.tif", "two.tif");
  const std::string said = ground.made("two.tif");
  ground.follow(advice(said, "gdal_translate -b 2"));
  CHECK_FALSE(contains(ground.made("heights.tif"), "two bands"));
}

TEST_CASE("shapes whose numbers are no degrees, or stand the other way round, are mended by the named commands") {
  const Ground ground;
  const auto write = [&](const std::string& name, const std::string& corners) {
    write_file_atomically(ground.path(name),
                          R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":)"
                          R"({"type":"Polygon","coordinates":[[)" +
                              corners + "]]}}]}");
  };
  const auto way = [&](const std::string& avoid) {
    return run_gonogo({"route", "--model", "hmmwv", "--dem", ground.path("ok.tif"), "--soil", "sand, dry", "--from",
                       "730020,4368020", "--to", "730200,4368060", "--avoid", ground.path(avoid), "--out",
                       ground.path("way.gpkg")});
  };
  write("a b.geojson", "[730100,4368200],[730150,4368200],[730150,4368250],[730100,4368200]");
  const Ending metres = way("a b.geojson");
  check_refusal(metres, 2, {"a b.geojson", "is no longitude and latitude"});
  ground.follow(filled(advice(metres.err, "ogr2ogr"), "<code>", "32610"));
  CHECK(way("with_system.gpkg").exit_code == 0);
  write("b a.geojson", "[39.4327,-120.3265],[39.4327,-120.3260],[39.4330,-120.3260],[39.4327,-120.3265]");
  const Ending swapped = way("b a.geojson");
  check_refusal(swapped, 2, {"b a.geojson", "if latitudes stand first"});
  ground.follow(advice(swapped.err, "ogr2ogr"));
  CHECK(way("swapped.gpkg").exit_code == 0);
}

TEST_CASE("an undeclared void is declared by the command that the remark names, whatever the format") {
  const Ground ground;
  ground.change("-9999", "void", 3);
  const std::string said = ground.made("void.asc");
  CHECK(contains(said, "3 cells of the elevation hold -9999"));
  ground.follow(advice(said, "gdal_translate -a_nodata"));
  CHECK_FALSE(contains(ground.made("declared.tif"), "-9999"));
}

TEST_CASE("advice about a raster in a .zip, and in a folder with a long name, can be followed as it stands") {
  const Ground ground;
  ground.change("-9999", "void", 3);
  const std::string folder = std::string(120, 'a') + " " + std::string(120, 'b');
  fs::create_directories(ground.path(folder));
  for (const char* name : {"void.asc", "void.prj"}) fs::copy_file(ground.path(name), ground.path(folder) / name);
  ground.follow("python3 -m zipfile -c 'in a zip.zip' void.asc void.prj");
  for (const std::string& file : {folder + "/void.asc", std::string("in a zip.zip")}) {
    fs::remove(ground.path("declared.tif"));
    const std::string said = ground.made(file);
    CHECK(contains(said, "3 cells of the elevation hold -9999"));
    ground.follow(advice(said, "gdal_translate -a_nodata"));
    CHECK_FALSE(contains(ground.made("declared.tif"), "-9999"));
  }
}

TEST_CASE("heights in feet are taken by the option, and by the key of the region, that the refusal names") {
  const Ground ground;
  ground.gdal("gdal_translate -q -a_srs EPSG:32610 -scale 0 1 0 6", "ok.tif", "feet.tif");
  const std::string said = ground.refused("feet.tif");
  CHECK(contains(said, "--height-unit ft"));
  CHECK(contains(said, "\"unit\": \"ft\" of the elevation"));
  ground.made("feet.tif", {"--height-unit", "ft"});
  Json region = Json::read(ground.path("region.json"));
  Json raster = region.at("rasters").items().front();
  raster["file"] = "feet.tif";
  raster["unit"] = "ft";
  region["rasters"] = Json::Array{raster};
  write_file_atomically(ground.path("feet.json"), region.dump());
  Ground::said({"map", "--model", "hmmwv", "--region", ground.path("feet.json"), "--out", ground.path("map of feet")});
}

TEST_CASE("what a map leaves open is closed by the options that its remarks name") {
  const Ground ground;
  const Words bare{"map", "--model", "hmmwv", "--dem", ground.path("ok.tif"), "--out"};
  const std::string open = Ground::said(with(bare, {ground.path("open")}));
  CHECK(contains(open, "name a soil with --soil, and a moisture with --moisture"));
  CHECK(contains(open, "fix one with --set"));
  const std::string closed =
      Ground::said(with(bare, {ground.path("closed"), "--soil", "sand", "--moisture", "dry", "--set", "payload=500"}));
  CHECK_FALSE(contains(closed, "name a soil with"));
  const std::string averaged = advice(open, "P(go) is averaged over", "; fix one"),
                    fewer = advice(closed, "P(go) is averaged over", "; fix one");
  CHECK(contains(averaged, "payload"));
  CHECK_FALSE(contains(fewer, "payload"));
}

TEST_CASE("values and names that a refusal of a map allows are taken") {
  const Ground ground;
  CHECK(contains(run_gonogo({"map", "--model", "hmmwv", "--dem", ground.path("ok.tif"), "--soil", "sand", "--moisture",
                             "damp", "--out", ground.path("m")})
                     .err,
                 "use dry, moist or wet"));
  const std::string range = advice(ground.refused("ok.tif", {"--set", "payload=5000"}), "had ", ";");
  double low = -1, high = -1;
  REQUIRE(std::sscanf(range.c_str(), "had %lf to %lf", &low, &high) == 2);
  for (const double value : {low, high}) ground.made("ok.tif", {"--set", "payload=" + std::to_string(value)});
  const Ending nameless =
      run_gonogo({"map", "--dem", ground.path("ok.tif"), "--soil", "sand", "--out", ground.path("m")});
  std::string names = advice(nameless.err, "models ship for: ").substr(17);
  for (char& c : names) c = c == ',' ? ' ' : c;
  std::istringstream in(names);
  int count = 0;
  for (std::string name; in >> name; ++count) {
    INFO(name);
    const Ending parsed = run_gonogo({"infer", "--model", name, "--set", "slope_along=5"});
    CHECK(parsed.exit_code == 0);
  }
  CHECK(count >= 3);
}

TEST_CASE("the way to a model of one's own vehicle is made of commands that parse, and begins") {
  const Ground ground;
  const Ending ending = run_gonogo(
      {"map", "--vehicle", "m113", "--dem", ground.path("ok.tif"), "--soil", "sand", "--out", ground.path("none")});
  REQUIRE(ending.exit_code == 2);
  const std::string way = advice(ending.err, "gonogo vehicle study", "; then give");
  CHECK(contains(way, "gonogo campaign run"));
  CHECK(contains(way, "gonogo train"));
  check_parses(std::istringstream(way));
  std::string study = filled(advice(way, "gonogo vehicle study", ";"), "gonogo", gonogo_program().string());
  study = filled(study, "m113_study.json", ground.path("m113_study.json").string());
  CHECK(shell(study).status == 0);
  const Ending design = run_gonogo({"design", ground.path("m113_study.json")});
  INFO(design.err);
  CHECK(design.exit_code == 0);
}

TEST_CASE("commands for a vehicle whose file and name hold blanks are words that a shell takes apart") {
  const Ground ground;
  Json vehicle = Json::read(fs::path(GONOGO_SOURCE_DIR) / "configs/vehicles/m113.json");
  vehicle["vehicle"] = "Bob's tank";
  write_file_atomically(ground.path("my tank.json"), vehicle.dump());
  const Ending ending = run_gonogo({"map", "--vehicle", ground.path("my tank.json"), "--dem", ground.path("ok.tif"),
                                    "--soil", "sand", "--out", ground.path("none")});
  REQUIRE(ending.exit_code == 2);
  INFO(ending.err);
  const std::string study = advice(ending.err, "gonogo vehicle study", ";").substr(7);
  ground.follow(gonogo_program().string() + " " + study);
  CHECK(fs::exists(ground.path("Bob's tank_study.json")));
  CHECK(contains(ending.err, R"(--model 'out/Bob'\''s tank/model.h5')"));
}

TEST_CASE("a route does what the refusal of one without a question offers") {
  const Ground ground;
  const Words bare{"route", "--model", "hmmwv", "--dem", ground.path("ok.tif"), "--soil", "sand, dry"};
  const Ending nothing = run_gonogo(bare);
  REQUIRE(nothing.exit_code == 2);
  for (const char* option : {"--from", "--to", "--reach", "--isochrones", "--regions", "--costmap", "--grid-map"})
    CHECK(contains(nothing.err, option));
  const Words from{"--from", "730020,4368020"};
  Ground::said(with(with(bare, from), {"--to", "730120,4368060", "--out", ground.path("a.gpkg")}));
  Ground::said(with(with(bare, from), {"--reach", ground.path("reach.tif")}));
  Ground::said(with(with(bare, from), {"--isochrones", ground.path("bands.gpkg")}));
  Ground::said(with(bare, {"--regions", ground.path("regions.gpkg")}));
  const Ending wrong = run_gonogo(with(bare, {"--costmap", ground.path("a.png")}));
  CHECK(contains(wrong.err, "give it as .yaml"));
  Ground::said(with(bare, {"--costmap", ground.path("a.yaml")}));
  Ground::said(with(bare, {"--grid-map", ground.path("grid.tif")}));
  const Ending text = run_gonogo(with(with(bare, from), {"--to", "730120,4368060", "--out", ground.path("a.txt")}));
  CHECK(contains(text.err, "use .gpkg, .geojson or .gpx"));
  for (const char* name : {"b.gpkg", "b.geojson", "b.gpx"})
    Ground::said(with(with(bare, from), {"--to", "730120,4368060", "--out", ground.path(name)}));
}

TEST_CASE("rows are written with the extensions, and questions asked in the ways, that refusals name") {
  const TemporaryFolder folder;
  const Words rows{"sample", "--model", "quarter_wheel_90mm", "--rows", "10", "--out"};
  CHECK(contains(run_gonogo(with(rows, {folder / "a.txt"})).err, ".csv or .h5"));
  for (const char* name : {"a.csv", "a.h5"}) Ground::said(with(rows, {folder / name}));
  const Ending nothing = run_gonogo({"infer", "--model", "hmmwv", "--set", "slope=5"});
  REQUIRE(nothing.exit_code == 2);
  const Ending misspelt = run_gonogo({"soil", "fitt"});
  CHECK(run_gonogo({"help", "soil", advice(misspelt.err, "did you mean \"", "\"?").substr(14)}).exit_code == 0);
}

TEST_CASE("a file of another format opens with --allow-network, as its refusal says") {
  const Ground ground;
  write_file_atomically(ground.path("raw.vrt"),
                        "<VRTDataset rasterXSize=\"24\" rasterYSize=\"40\"><SRS>EPSG:32610</SRS>"
                        "<GeoTransform>730000,10,0,4368400,0,-10</GeoTransform><VRTRasterBand dataType=\"Float32\" "
                        "band=\"1\" subClass=\"VRTRawRasterBand\"><SourceFilename relativeToVRT=\"1\">raw.bin"
                        "</SourceFilename></VRTRasterBand></VRTDataset>");
  std::string zeros(24 * 40 * 4, '\0');
  for (std::size_t k = 3; k < zeros.size(); k += 4) zeros[k] = 0x42, zeros[k - 1] = char(k / 96 % 2);
  write_file_atomically(ground.path("raw.bin"), zeros);
  CHECK(contains(ground.refused("raw.vrt"), "--allow-network"));
  ground.made("raw.vrt", {"--allow-network"});
}

TEST_CASE("each spelling of a name that is a file and a texture makes the map that the remark promises") {
  const Ground ground;
  const Words bare{"map", "--model", "hmmwv", "--dem", ground.path("ok.tif"), "--out"};
  const std::string file = Ground::said(with(bare, {ground.path("file"), "--soil", "sandy_loam"}));
  CHECK(contains(file, "the USDA texture of that name, which is written with a blank"));
  CHECK_FALSE(contains(Ground::said(with(bare, {ground.path("texture"), "--soil", "sandy loam"})), "sandy_loam"));
}

}  // namespace gonogo
