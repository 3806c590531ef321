#include "pipeline/app/run/stage.h"

#include "base/error.h"
#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::app {

namespace {

/// A stage that copies its input value into a file and counts how often it works.
struct Copier {
  TemporaryFolder folder;
  int worked = 0;

  bool run(const std::string& value) {
    Stage stage{.name = "copy", .outputs = {"out/value.txt"}, .inputs = Json::object(), .work = [&] {
                  ++worked;
                  write_file_atomically(folder / "out/value.txt", value);
                }};
    stage.inputs["value"] = value;
    return run_stage(folder.path(), stage);
  }
};

TEST_CASE("a stage is done once and again only when an input changes") {
  Copier copier;
  CHECK(copier.run("a"));
  CHECK_FALSE(copier.run("a"));
  CHECK(copier.run("b"));
  CHECK_FALSE(copier.run("b"));
  CHECK(copier.worked == 2);
  CHECK(read_file(copier.folder / "out/value.txt") == "b");
}

TEST_CASE("a stage is done again when its output is altered, gone, or its stamp is damaged") {
  Copier copier;
  copier.run("a");
  write_file_atomically(copier.folder / "out/value.txt", "A");
  CHECK(copier.run("a"));
  std::filesystem::remove(copier.folder / "out/value.txt");
  CHECK(copier.run("a"));
  write_file_atomically(copier.folder / "stamps/copy.json", "{\"schema\": ");
  CHECK(copier.run("a"));
  write_file_atomically(copier.folder / "stamps/copy.json", R"({"schema": "gonogo/stamp/0"})");
  CHECK(copier.run("a"));
  CHECK_FALSE(copier.run("a"));
  CHECK(read_file(copier.folder / "out/value.txt") == "a");
}

TEST_CASE("a stage that fails or makes nothing leaves no stamp") {
  const TemporaryFolder folder;
  Stage stage{.name = "bad", .outputs = {"x"}, .inputs = Json::object(), .work = [] { throw InputError("no"); }};
  CHECK_THROWS_AS(run_stage(folder.path(), stage), InputError);
  CHECK_FALSE(std::filesystem::exists(folder / "stamps/bad.json"));
  stage.work = [] {};
  CHECK_THROWS_AS(run_stage(folder.path(), stage), DeviceError);
  CHECK_FALSE(std::filesystem::exists(folder / "stamps/bad.json"));
}

TEST_CASE("a failed repetition does not fall back to the stamp of an earlier success") {
  const TemporaryFolder folder;
  bool fails = false;
  Stage stage{.name = "s", .outputs = {"x"}, .inputs = Json::object(), .work = [&] {
                write_file_atomically(folder / "x", "result");
                if (fails) throw InputError("interrupted");
              }};
  stage.inputs["n"] = 1;
  run_stage(folder.path(), stage);
  fails = true;
  stage.inputs["n"] = 2;
  CHECK_THROWS_AS(run_stage(folder.path(), stage), InputError);
  fails = false;
  stage.inputs["n"] = 1;
  CHECK(run_stage(folder.path(), stage));
}

TEST_CASE("the hash of a folder depends on names and contents and on nothing else") {
  const TemporaryFolder a, b;
  for (const auto* folder : {&a, &b}) {
    write_file_atomically(*folder / "map/go.tif", "1");
    write_file_atomically(*folder / "map/sub/reason.tif", "2");
  }
  const std::string hash = path_hash(a / "map");
  CHECK(path_hash(b / "map") == hash);
  write_file_atomically(b / "map/go.tif", "3");
  CHECK(path_hash(b / "map") != hash);
  write_file_atomically(b / "map/go.tif", "1");
  std::filesystem::rename(b / "map/go.tif", b / "map/no.tif");
  CHECK(path_hash(b / "map") != hash);
  CHECK(contains(input_error([&] { path_hash(a / "nothing"); }), "no such file"));
}

}  // namespace
}  // namespace gonogo::app
