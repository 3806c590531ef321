#include "pipeline/campaign/study/study.h"

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace {

std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "s.json", text);
  return input_error([&] { read_study(folder / "s.json"); });
}

TEST_CASE("a study's frame is read and its paths start at its folder") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "s.json",
                        R"({"study": "demo", "seed": 42, "vehicle": "../v.json", "design": {"points": 4}})");
  const Study study = read_study(folder / "s.json");
  CHECK(study.name == "demo");
  CHECK(study.seed == 42);
  CHECK(study.vehicle == folder.path() / "../v.json");
  CHECK(study.region.empty());
  CHECK(study.gravity == kGravity);
  CHECK(study.section("design").integer("points") == 4);
  CHECK(contains(input_error([&] { study.section("trial"); }), "s.json: trial: missing"));
}

TEST_CASE("what is wrong with a study is said with its place") {
  CHECK(
      contains(refusal(R"({"study": "a", "seed": 1, "desing": {}})"), "desing: unknown key; did you mean \"design\"?"));
  CHECK(contains(refusal(R"({"study": "a"})"), "seed: missing"));
  CHECK(contains(refusal(R"({"study": "a", "seed": -1})"), "seed: value -1 is outside the allowed range: at least 0"));
  CHECK(contains(refusal(R"({"study": "a", "seed": 1.5})"), "seed: expected a whole number"));
  CHECK(
      contains(refusal(R"({"study": "a", "seed": 1, "gravity": 0})"), "gravity: value 0 is outside the allowed range"));
  CHECK(contains(refusal(R"({"study": "", "seed": 1})"), "study: the name is empty"));
  CHECK(contains(refusal(R"({"study": "a", "seed": 1, "trial": 5})"), "trial: expected an object"));
  CHECK(contains(refusal(R"({"study": "a", "seed": 1, "vehicle": {}})"), "vehicle: expected text"));
  CHECK(contains(input_error([] { read_study("/nowhere/s.json"); }), "/nowhere/s.json: no such file"));
}

TEST_CASE("the largest seed is read exactly") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "s.json", R"({"study": "a", "seed": 9223372036854775807})");
  CHECK(read_study(folder / "s.json").seed == 9223372036854775807u);
}

}  // namespace
}  // namespace gonogo::campaign
