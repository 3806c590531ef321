// The main job met with bad input and bad luck: one sentence, a non-zero exit status, nothing lost, nothing
// half-written.
#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

/// Refused before any work: bad input, one sentence, and no output folder.
void check_refused_at_once(const StudyFolder& s, const std::vector<std::string>& parts) {
  check_refusal(run_gonogo(s.run_words()), 2, parts);
  CHECK(files_below(s.out()).empty());
}

TEST_CASE("missing study") {
  const StudyFolder s;
  check_refusal(run_gonogo({"run", s.path("none.json"), "--out", s.out()}), 2, {"none.json: no such file"});
  check_refusal(run_gonogo({"run", s.path(""), "--out", s.out()}), 2, {"is a folder"});
}

TEST_CASE("missing vehicle") {
  StudyFolder s;
  s.study["vehicle"] = "wheels/none.json";
  s.write();
  check_refused_at_once(s, {"wheels/none.json: no such file"});
}

TEST_CASE("missing vehicle whose cone index counts") {
  StudyFolder s;
  s.study["map"]["cone_index_of"] = "wheels/none.json";
  s.write();
  check_refused_at_once(s, {"wheels/none.json: no such file"});
}

TEST_CASE("missing region") {
  StudyFolder s;
  s.study["region"] = "none.json";
  s.write();
  check_refused_at_once(s, {"none.json: no such file"});
}

TEST_CASE("missing raster") {
  StudyFolder s;
  s.write();
  fs::remove(s.path("elevation.asc"));
  check_refused_at_once(s, {"elevation.asc", "no such file"});
}

TEST_CASE("unreadable raster") {
  StudyFolder s;
  s.write();
  write_file_atomically(s.path("elevation.asc"), "this is no raster");
  check_refused_at_once(s, {"elevation.asc"});
}

TEST_CASE("raster cut short") {
  StudyFolder s;
  s.write();
  const std::string whole = read_file(s.path("elevation.asc"));
  write_file_atomically(s.path("elevation.asc"), whole.substr(0, whole.size() / 2));
  check_refused_at_once(s, {"elevation.asc"});
}

TEST_CASE("raster without coordinate system") {
  StudyFolder s;
  s.write();
  fs::remove(s.path("elevation.prj"));
  check_refused_at_once(s, {"elevation.asc", "coordinate system"});
}

TEST_CASE("raster in degrees") {
  StudyFolder s;
  s.write();
  write_file_atomically(s.path("elevation.prj"), kGeographicWkt);
  check_refused_at_once(s, {"elevation.asc", "degrees"});
}

TEST_CASE("negative parameter") {
  StudyFolder s;
  s.study["design"]["points"] = -5;
  s.write();
  check_refused_at_once(s, {"study.json: design.points: value -5 is outside the allowed range"});
}

TEST_CASE("not-a-number parameter") {
  StudyFolder s;
  s.write();
  std::string text = read_file(s.path("study.json"));
  const auto at = text.find("\"seed\": ") + 8;
  text.replace(at, text.find(',', at) - at, "NaN");
  write_file_atomically(s.path("study.json"), text);
  check_refused_at_once(s, {"study.json: line", "not valid JSON"});
}

TEST_CASE("range outside the contract") {
  StudyFolder s;
  s.study["design"]["ranges"]["slope_along"] = Json::Array{0, 80};
  s.write();
  check_refused_at_once(s, {"study.json: design.ranges.slope_along", "80", "45"});
}

TEST_CASE("unknown key") {
  StudyFolder s;
  s.study["desing"] = Json::object();
  s.write();
  check_refused_at_once(s, {"study.json: desing: unknown key; did you mean \"design\"?"});
}

TEST_CASE("unknown key in a section") {
  for (const char* section : {"design", "trial", "learning", "map"}) {
    StudyFolder s;
    s.study[section]["zzz"] = 1;
    s.write();
    check_refused_at_once(s, {std::string("study.json: ") + section + ".zzz: unknown key"});
  }
}

TEST_CASE("wrong type") {
  StudyFolder s;
  s.study["design"]["points"] = "many";
  s.write();
  check_refused_at_once(s, {"study.json: design.points: expected a number", "found text \"many\""});
}

TEST_CASE("missing section") {
  StudyFolder s;
  s.study["trial"] = nullptr;
  s.write();
  check_refused_at_once(s, {"study.json: trial: expected an object"});
}

TEST_CASE("no write permission") {
  StudyFolder s;
  s.write();
  s.make_readable_for_all();
  fs::create_directory(s.out());
  fs::permissions(s.out(), fs::perms{0555});
  RunOptions ordinary;
  ordinary.before = become_ordinary_user;
  check_refusal(run_gonogo(s.run_words(), ordinary), 2,
                {"cannot write here", "Permission denied", "fix its permissions"});
  CHECK(files_below(s.out()).empty());
}

TEST_CASE("a file where the output folder should be") {
  StudyFolder s;
  s.write();
  write_file_atomically(s.out(), "a file");
  check_refusal(run_gonogo(s.run_words()), 2, {"cannot create this folder"});
  CHECK(read_file(s.out()) == "a file");
}

TEST_CASE("full disk") {
  StudyFolder s;
  s.write();
  RunOptions full;
  full.before = [] { limit_file_size(2000); };
  const Ending ending = run_gonogo(s.run_words(), full);
  check_refusal(ending, 1, {"cannot write"});
  check_nothing_half_written(s.out());
  CHECK(run_gonogo(s.run_words()).exit_code == 0);  // with space again, the same command finishes
}

}  // namespace
}  // namespace gonogo
