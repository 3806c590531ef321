#include "base/json/config.h"

#include "base/error.h"
#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

Config parse(const std::string& text) { return Config::parse(text, "dir/study.json"); }

TEST_CASE("an unknown key is reported with its path and the nearest valid key") {
  const Config config = parse(R"({"trial": {"step_s": 0.001, "durtion_s": 2}})");
  const Config trial = config.object("trial");
  trial.number("step_s");
  trial.number_or("duration_s", 1);
  trial.number_or("load_n", 1);
  CHECK_NOTHROW(config.finish());
  const std::string message = input_error([&] { trial.finish(); });
  CHECK(contains(message, "dir/study.json: trial.durtion_s: unknown key"));
  CHECK(contains(message, "did you mean \"duration_s\"?"));
}

TEST_CASE("keys asked for through a copy count as known") {
  const Config config = parse(R"({"a": 1})");
  const Config copy = config;  // NOLINT(performance-unnecessary-copy-initialization): the copy is what is tested
  copy.number("a");
  CHECK_NOTHROW(config.finish());
}

TEST_CASE("numbers outside their range name the value and the range") {
  const Config config = parse(R"({"friction": -0.5, "list": [1, 2, 99]})");
  CHECK(contains(input_error([&] { config.number("friction", {.minimum = 0, .maximum = 2}); }),
                 "friction: value -0.5 is outside the allowed range: between 0 and 2"));
  CHECK(contains(input_error([&] { config.number_or("friction", 1, {.minimum = 0}); }), "at least 0"));
  CHECK(contains(input_error([&] { config.numbers("list", {.maximum = 10}); }), "list[2]: value 99"));
  CHECK(config.number("friction", {.minimum = -0.5}) == -0.5);
}

TEST_CASE("a range never contains NaN") {
  CHECK_FALSE(Range{}.contains(std::numeric_limits<double>::quiet_NaN()));
  CHECK(Range{}.contains(std::numeric_limits<double>::infinity()));
}

TEST_CASE("a wrong type says what was expected and what was found") {
  const Config config = parse(R"({"mass": "heavy", "on": 1, "name": 3, "n": 2.5, "part": [], "list": {}})");
  CHECK(contains(input_error([&] { config.number("mass"); }), "mass: expected a number any number, found text"));
  CHECK(contains(input_error([&] { config.boolean_or("on", false); }), "expected true or false, found number 1"));
  CHECK(contains(input_error([&] { config.text("name"); }), "expected text in quotes, found number 3"));
  CHECK(contains(input_error([&] { config.integer("n"); }), "expected a whole number"));
  CHECK(contains(input_error([&] { config.object("part"); }), "part: expected an object { }, found list"));
  CHECK(contains(input_error([&] { config.objects("list"); }), "expected a list, found object"));
  CHECK(contains(input_error([&] { config.choice("mass", {"light", "medium"}); }), "not one of: light, medium"));
}

TEST_CASE("a missing key is named; fallbacks are used only when the key is absent") {
  const Config config = parse(R"({"a": 4})");
  CHECK(contains(input_error([&] { config.number("b"); }), "b: missing"));
  CHECK(config.number_or("b", 7) == 7);
  CHECK(config.number_or("a", 7) == 4);
  CHECK(config.integer_or("a", 7) == 4);
  CHECK(config.text_or("t", "x") == "x");
  CHECK_FALSE(config.object_if("o").has_value());
}

TEST_CASE("elements of lists and members of objects know their path") {
  const Config config = parse(R"({"soils": [{"phi": 30}, {"phi": "x"}], "table": {"sand": {"c": -1}}})");
  CHECK(contains(input_error([&] { config.objects("soils")[1].number("phi"); }), "soils[1].phi: expected a number"));
  const auto members = config.object("table").members();
  REQUIRE(members.size() == 1);
  CHECK(members[0].first == "sand");
  CHECK(contains(input_error([&] { members[0].second.number("c", {.minimum = 0}); }), "table.sand.c: value -1"));
}

TEST_CASE("a refusal holds file and path in fields of their own") {
  const Config config = parse(R"({"bed": {"size_m": [1, 2, -3]}})");
  try {
    config.object("bed").numbers("size_m", {.minimum = 0});
    FAIL("accepted");
  } catch (const PlacedInputError& error) {
    CHECK(error.place.file == "dir/study.json");
    CHECK(error.place.path == "bed.size_m[2]");
    CHECK(error.place.line == 0);
  }
}

TEST_CASE("paths are relative to the folder of the file") {
  const Config config = parse(R"({"vehicle": "../vehicles/a.json", "region": "/data/r.json"})");
  CHECK(config.path("vehicle") == std::filesystem::path("dir/../vehicles/a.json"));
  CHECK(config.path("region") == std::filesystem::path("/data/r.json"));
}

TEST_CASE("files that are missing, folders or not objects are refused by name") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "list.json", "[1]");
  CHECK(contains(input_error([&] { Config::read(folder / "none.json"); }), "none.json: no such file"));
  CHECK(contains(input_error([&] { Config::read(folder.path()); }), "is a folder"));
  CHECK(contains(input_error([&] { Config::read(folder / "list.json"); }), "expected an object"));
}

}  // namespace
}  // namespace gonogo
