// The command line itself: words that are no command, options that are none, values out of range.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "base/files/file.h"
#include "pipeline/report/figure/captioned.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

TEST_CASE("a word that is no command is answered with the nearest one") {
  check_refusal(run_gonogo({"docter"}), 2, {"\"docter\" is no command", "did you mean \"doctor\"?"});
  check_refusal(run_gonogo({}), 2, {"no command given", "doctor"});
}

TEST_CASE("a word below a command that is no command there is answered with the nearest one") {
  check_refusal(run_gonogo({"soil", "tst"}), 2, {"\"tst\" is no command of gonogo soil", "did you mean \"test\"?"});
  check_refusal(run_gonogo({"soil", "test", "sheer"}), 2, {"did you mean \"shear\"?", "see gonogo soil test --help"});
  check_refusal(run_gonogo({"soil"}), 2, {"gonogo soil needs a command", "calibrate", "see gonogo soil --help"});
}

TEST_CASE("options that are unknown are answered with the nearest one") {
  const auto refused = [](const std::vector<std::string>& words, const std::string& nearest) {
    check_refusal(run_gonogo(words), 2, {"is no option of gonogo " + words[0], "did you mean \"" + nearest + "\"?"});
  };
  refused({"doctor", "--thread", "2"}, "--threads");
  refused({"train", "--datset", "a.h5", "--out", "b.h5"}, "--dataset");  // rather than that --dataset is missing
  refused({"train", "--dataset", "a.h5", "--out", "b.h5", "--hold-uot=5"}, "--hold-out");
  refused({"validate", "wheels", "--nomnial"}, "--nominal");
  check_refusal(run_gonogo({"--jsn", "doctor"}), 2, {"\"--jsn\" is no option of gonogo", "\"--json\""});
  const Ending far = run_gonogo({"doctor", "--zzzzzzzzzz"});
  check_refusal(far, 2, {"\"--zzzzzzzzzz\" is no option of gonogo doctor", "see gonogo doctor --help"});
  CHECK_FALSE(contains(far.err, "did you mean"));
}

TEST_CASE("values out of range and words too many are refused") {
  check_refusal(run_gonogo({"doctor", "--threads", "-3"}), 2, {"--threads", "-3", "0 to 4096"});
  check_refusal(run_gonogo({"doctor", "--threads", "two"}), 2, {"--threads", "two"});
  check_refusal(run_gonogo({"doctor", "run"}), 2, {"\"run\" is one word more", "gonogo doctor --help"});
  check_refusal(run_gonogo({"simulate", "--vehicle", "hmmwv", "--wheel-rolling", "-1"}), 2,
                {"--wheel-rolling", "-1", "0 to 10"});
}

TEST_CASE("options of a vehicle's trial are refused beside a study, with the key that they are there") {
  const std::string study = std::string(GONOGO_SOURCE_DIR) + "/configs/studies/demo.json";
  check_refusal(run_gonogo({"simulate", study, "--wheel-rolling", "1"}), 2, {"--vehicle", "trial.wheel_rolling"});
  check_refusal(run_gonogo({"simulate", study, "--compliant-tyres"}), 2, {"--vehicle", "trial.compliant_tyres"});
}

TEST_CASE("under --json an error is an object on stdout, too") {
  const TemporaryFolder folder;
  const std::string study = folder / "study.json";
  const auto design = [&](const std::string& text) {
    write_file_atomically(study, text);
    return run_gonogo({"design", study, "--json"});
  };
  check_json_refusal(run_gonogo({"doctor", "--thread", "2", "--json"}), 2, "bad_input", {"--threads"});
  check_json_refusal(run_gonogo({"--json"}), 2, "bad_input", {});
  const Json syntax =
      check_json_refusal(design("{\"study\": \"a\",\n \"seed\" 1}"), 2, "bad_input", {"line 2, column 9"});
  CHECK(syntax.at("file").string() == study);
  CHECK(syntax.at("line").integer() == 2);
  CHECK(syntax.at("column").integer() == 9);
  CHECK(syntax.find("path") == nullptr);
  Json value = Json::read(GONOGO_SOURCE_DIR "/configs/studies/demo.json");
  value["vehicle"] = GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv_quarter.json";  // the study's folder is another one
  value["soil"]["calibration"] = GONOGO_SOURCE_DIR "/configs/soils/calibration_90mm.json";
  value["design"]["points"] = "many";
  const Json schema = check_json_refusal(design(value.dump()), 2, "bad_input", {"design.points"});
  CHECK(schema.at("file").string() == study);
  CHECK(schema.at("path").string() == "design.points");
  CHECK(schema.find("line") == nullptr);
  const Json missing =
      check_json_refusal(run_gonogo({"design", "/none.json", "--json"}), 2, "bad_input", {"no such file"});
  CHECK(missing.at("file").string() == "/none.json");
  check_json_refusal(run_gonogo({"dataset", "summary", "/none.h5", "--json"}), 2, "bad_input", {"/none.h5"});
#ifdef GONOGO_WITH_TORCH
  check_json_refusal(run_gonogo({"train", "--dataset", "/none.h5", "--out", "m.h5", "--json"}), 2, "bad_input",
                     {"/none.h5"});
#endif
}

TEST_CASE("a result that is complete but bad holds its error") {
  const std::string file = GONOGO_SOURCE_DIR "/tests/data/fclib/Rover1040.dat";
  const Ending ending =
      run_gonogo({"validate", "fclib", file, "--solver", "nsgs", "--iterations", "1", "--limit", "1e-12", "--json"});
  check_json_refusal(ending, 1, "failure", {"1 of 1 problems"});
  CHECK(Json::parse(ending.out, "stdout").at("problems").items().size() == 1);
}

TEST_CASE("options of the program stand before or after the command") {
  const TemporaryFolder folder;
  for (const auto& words : {std::vector<std::string>{"--json", "--threads", "2", "doctor", "--out", folder.path()},
                            std::vector<std::string>{"doctor", "--out", folder.path(), "--threads", "2", "--json"}}) {
    const Ending ending = run_gonogo(words);
    CHECK(ending.exit_code == 0);
    CHECK(Json::parse(ending.out, "stdout").at("out_writable").boolean());
  }
  CHECK(files_below(folder.path()).empty());
}

TEST_CASE("a timed scene names the solver that was asked for") {
  for (const char* solver : {"apgd", "jacobi_scan"}) {
    const Ending ending = run_gonogo(
        {"bench", "tank", "--spheres", "300", "--solver", solver, "--iterations", "20", "--repeats", "3", "--json"});
    REQUIRE(ending.exit_code == 0);
    const Json json = Json::parse(ending.out, "stdout");
    CHECK(json.at("solver").string() == solver);
    CHECK(json.at("iterations").number() == 20);
    CHECK(json.at("ns_per_contact_iteration_solver").number() > 0);
  }
}

TEST_CASE("pictures and videos that cannot be made are refused before the trial runs") {
  const TemporaryFolder folder;
  const std::string study = std::string(GONOGO_SOURCE_DIR) + "/configs/studies/demo.json";
  if (!report::pictures_available()) {
    check_refusal(run_gonogo({"simulate", study, "--picture", folder / "a.png"}), 2, {"--picture", "GONOGO_PICTURES"});
    check_refusal(run_gonogo({"dataset", "plot", "none.h5", "--out", folder / "plots"}), 2, {"GONOGO_PICTURES"});
    CHECK(files_below(folder.path()).empty());
    return;
  }
  RunOptions bare;
  bare.before = [] { ::setenv("PATH", "/nowhere", 1); };
  const std::string video = folder / "out.mp4";
  check_refusal(run_gonogo({"simulate", study, "--video", video}, bare), 2, {"--video", "ffmpeg", "install"});
  check_refusal(run_gonogo({"simulate", study, "--picture", folder / "a.png", "--size", "big"}), 2, {"--size big"});
  check_refusal(run_gonogo({"simulate", study, "--picture", folder / "a.png", "--size", "12x9"}), 2, {"320x180"});
  check_refusal(run_gonogo({"simulate", study, "--vtk", folder / "vtk", "--every", "0"}), 2, {"--every"});
  check_refusal(run_gonogo({"simulate", study, "--colour", "smell"}), 2, {"--colour", "speed", "height"});
  CHECK(files_below(folder.path()).empty());
}

TEST_CASE("a GPU that is not there is refused before any work") {
  RunOptions none;
  none.before = [] { ::setenv("CUDA_VISIBLE_DEVICES", "", 1); };
  for (const char* scene : {"bed", "batch", "wheel", "tank", "collide", "silo", "drum", "screen", "pebbles", "nut",
                            "ball", "crater", "collapse"})
    check_refusal(run_gonogo({"bench", scene, "--backend", "cuda"}, none), 2, {"CUDA", "ask for the cpu backend"});
  const TemporaryFolder folder;
  const std::string study = std::string(GONOGO_SOURCE_DIR) + "/configs/studies/demo.json";
  check_refusal(run_gonogo({"campaign", "run", study, "--out", folder / "out", "--device", "cuda"}, none), 2,
                {"GPU", "--device cpu"});
  check_refusal(run_gonogo({"campaign", "run", study, "--out", folder / "out", "--gpus", "2"}, none), 2,
                {"GPU", "--device cpu"});
  check_refusal(run_gonogo({"campaign", "run", study, "--out", folder / "out", "--gpus", "2", "--device", "cpu"}, none),
                2, {"a number of GPUs is given, and the device is to be cpu"});
  CHECK(files_below(folder.path()).empty());
  check_refusal(run_gonogo({"bench", "bed", "--backend", "tpu"}), 2, {"--backend", "cpu", "cuda"});
  check_refusal(run_gonogo({"bench", "tank", "--spheres", "7"}), 2, {"--spheres", "100"});
  check_refusal(run_gonogo({"bench", "wheel", "--solver", "magic"}), 2, {"--solver", "apgd", "jacobi"});
  check_refusal(run_gonogo({"bench", "tank", "--solver", "magic"}), 2, {"--solver", "apgd", "jacobi_scan"});
  check_refusal(run_gonogo({"bench", "wheel", "--target", "magic"}), 2, {"--target", "ccp", "coulomb"});
}

TEST_CASE("bench collapse takes the seed of its packing, 1 by default, and refuses what is none") {
  const auto height = [](std::vector<std::string> more) {
    std::vector<std::string> words = {"bench", "collapse",  "--spheres", "100",   "--iterations",
                                      "20",    "--repeats", "0",         "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return Json::parse(run_gonogo(words).out, "stdout").at("height_over_radius").number();
  };
  const double usual = height({});
  CHECK(height({"--seed", "1"}) == usual);
  CHECK(height({"--seed", "2"}) != usual);
  check_refusal(run_gonogo({"bench", "collapse", "--seed", "-1"}), 2, {"--seed", "-1"});
  check_refusal(run_gonogo({"bench", "collapse", "--seed", "red"}), 2, {"--seed", "red"});
}

TEST_CASE("a negative seed is refused, not taken for the greatest") {
  const std::string study = GONOGO_SOURCE_DIR "/configs/studies/demo.json";
  check_refusal(run_gonogo({"simulate", study, "--seed", "-1"}), 2, {"--seed", "-1", "0 or a positive"});
  check_refusal(run_gonogo({"soil", "test", "triaxial", "--seed", "-3"}), 2, {"--seed", "-3", "0 or a positive"});
}

TEST_CASE("validate fclib solves the problems it is given, and fails when one stays above the limit") {
  const std::string file = GONOGO_SOURCE_DIR "/tests/data/fclib/Rover1040.dat";
  const Ending solved = run_gonogo({"validate", "fclib", file, "--json"});
  CHECK(solved.exit_code == 0);
  const Json problem = Json::parse(solved.out, "stdout").at("problems").items().at(0);
  CHECK(problem.at("problem").string() == "Rover1040.dat");
  CHECK(problem.at("contacts").integer() == 5);
  CHECK(problem.at("siconos_error").number() < 1e-8);
  const Ending above =
      run_gonogo({"validate", "fclib", file, "--solver", "nsgs", "--iterations", "1", "--limit", "1e-12"});
  CHECK(above.exit_code == 1);
  CHECK(contains(above.out, "Rover1040.dat"));
  CHECK(contains(above.err, "1 of 1 problems ended above the error 1e-12"));
  const TemporaryFolder impulses;
  const Ending two = run_gonogo(
      {"validate", "fclib", file, "--solver", "ppa,pdip", "--limit", "1e-8", "--impulses", impulses.path(), "--json"});
  CHECK(two.exit_code == 0);
  const Json solutions = Json::parse(two.out, "stdout").at("problems");
  CHECK(solutions.items().at(0).at("solver").string() == "ppa");
  CHECK(solutions.items().at(1).at("solver").string() == "pdip");
  const std::string by_pdip = read_file(impulses / "Rover1040.dat.pdip.txt");
  CHECK(std::count(by_pdip.begin(), by_pdip.end(), '\n') == 5);
  CHECK(std::count(by_pdip.begin(), by_pdip.end(), ' ') == 10);
  CHECK(files_below(impulses.path()).size() == 2);
  check_refusal(run_gonogo({"validate", "fclib", "/none.dat"}), 2, {"/none.dat", "no such file or folder"});
  const TemporaryFolder folder;
  check_refusal(run_gonogo({"validate", "fclib", folder.path()}), 2, {"holds no .hdf5 or .dat file"});
  write_file_atomically(folder / "cut.dat", "3\n5\n0\n15\n");
  check_refusal(run_gonogo({"validate", "fclib", folder.path()}), 2, {"cut.dat: line 4", "the file ends where"});
}

TEST_CASE("the version names the revision") {
  const Ending ending = run_gonogo({"--version"});
  CHECK(ending.exit_code == 0);
  CHECK(ending.out.rfind("gonogo 0.", 0) == 0);
}

TEST_CASE("a result that cannot be written is a failure") {
  RunOptions full;
  full.before = [] { ::dup2(::open("/dev/full", O_WRONLY), STDOUT_FILENO); };
  check_refusal(run_gonogo({"doctor", "--json"}, full), 1, {"standard output", "cannot write"});
}

TEST_CASE("a folder that cannot be written fails the doctor") {
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms{0555});
  RunOptions ordinary;
  ordinary.before = become_ordinary_user;
  const Ending ending = run_gonogo({"doctor", "--json", "--out", folder / "sub"}, ordinary);
  CHECK(ending.exit_code == 2);
  CHECK_FALSE(Json::parse(ending.out, "stdout").at("out_writable").boolean());
  CHECK(contains(ending.err, "cannot write there"));
}

}  // namespace
}  // namespace gonogo
