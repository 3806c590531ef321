// Benchmark files that cannot be used are refused by a sentence that names file, place and remedy.
#include <filesystem>
#include <fstream>

#include "base/files/file.h"
#include "pipeline/lab/wheels/benchmark.h"
#include "pipeline/lab/wheels/report.h"
#include "pipeline/lab/wheels/run.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::lab;

namespace fs = std::filesystem;

namespace {

/// A benchmark that ships, changed, in a folder of its own.
class Changed {
 public:
  explicit Changed(const std::string& name) : folder_(fs::temp_directory_path() / "gonogo_wheel_files"), name_(name) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    const fs::path from = fs::path(GONOGO_SOURCE_DIR) / "configs/benchmarks";
    for (const auto& file : fs::directory_iterator(from)) fs::copy(file.path(), folder_ / file.path().filename());
  }
  ~Changed() { fs::remove_all(folder_); }

  Changed& with(const std::string& file, const std::string& was, const std::string& is) {
    std::string text = read_file(folder_ / file);
    const std::size_t at = text.find(was);
    REQUIRE(at != std::string::npos);
    text.replace(at, was.size(), is);
    write_file_atomically(folder_ / file, text);
    return *this;
  }
  std::string file() const { return (folder_ / (name_ + ".json")).string(); }
  void refused_with(const std::string& words) const {
    refused([&] { read_benchmark(file()); }, words);
  }

 private:
  fs::path folder_;
  std::string name_;
};

}  // namespace

TEST_CASE("a benchmark as it ships is read from any folder") {
  CHECK(read_benchmark(Changed("ding_lugs").file()).point.size() == 6);
}

TEST_CASE("a benchmark without source, units or scatter's source is refused") {
  Changed("ding_lugs").with("ding_lugs.json", "\"source\"", "\"origin\"").refused_with("source");
  Changed("ding_lugs").with("ding_lugs.csv", "pull_N", "pull").refused_with("has no unit; write pull_N");
  Changed("ding_lugs").with("ding_lugs.csv", "sinkage_m", "sinkage_in").refused_with("sinkage_in");
  Changed("ding_lugs").with("ding_lugs.json", "\"no_source\": \"how", "\"note\": \"how").refused_with("source");
  Changed("ding_lugs").with("ding_lugs.json", "\"licence\"", "\"license\"").refused_with("licence");
}

TEST_CASE("what cannot be led or measured is refused") {
  Changed("mgru3_rover").with("mgru3_rover.json", "[\"slope\"]", "[\"slip_angle\"]").refused_with("led");
  Changed("mgru3_rover")
      .with("mgru3_rover.json", "[\"slope\"]", "[\"slip\", \"slip_angle\"]")
      .with("mgru3.csv", "slope_deg,slip", "slip_angle_deg,slip")
      .refused_with("slip_angle of a whole vehicle");
  Changed("ding_lugs").with("ding_lugs.csv", "torque_N_m", "side_force_N").refused_with("slip_angle");
  Changed("ding_lugs").with("ding_lugs.csv", "slip,", "slope_deg,").refused_with("\"slip\", which is led");
  Changed("ding_lugs").with("ding_lugs.csv", "14.0", "many").refused_with("line 3: \"many\" is no number");
  Changed("ding_lugs").with("ding_lugs.json", "\"load_N\": 80,", "").refused_with("load_N");
  Changed("cmu_smooth").with("cmu_smooth.json", "\"slip_at\"", "\"load_N\": 20, \"slip_at\"").refused_with("load_N");
  Changed("ding_lugs").with("ding_lugs.json", "[0.3, 0.7]", "[0.6, 0.7]").refused_with("range");
  Changed("ding_lugs").with("ding_lugs.json", "\"dry\"", "\"wet\"").refused_with("dry");
  Changed("ding_lugs").with("ding_lugs.json", "worst_factor", "luck").refused_with("measure");
}

TEST_CASE("a soil that the table does not reach is refused with the reach and the benchmark's name") {
  Benchmark b = read_benchmark("ding_lugs");
  b.soil.friction_angle.low = b.soil.friction_angle.high = 59;
  WheelRun run;
  run.calibration = fs::path(GONOGO_SOURCE_DIR) / "configs/soils/calibration_32mm.json";
  refused([&] { run_wheels({b}, run); }, "benchmark ding_lugs");
  refused([&] { run_wheels({b}, run); }, "choose one between");
}

TEST_CASE("a cohesion fitted far above a wheel's stress is small under the wheel, and what is assumed is said") {
  Benchmark b = read_benchmark("ding_lugs");
  CHECK(mean_stress(b) == Approx(80 / (0.165 * 0.5 * b.vehicle.wheel.front().radius)).epsilon(0.01));
  const terrain::MacroscopicSoil measured{.friction_angle = 32, .cohesion = 2000};
  b.soil.cohesion.low = b.soil.cohesion.high = 2;
  CHECK(acting_soil(b, measured).cohesion == 2000);
  CHECK(contains(strength_remark(b), "does not say its normal stresses"));
  b.soil.tests[0].normal_stress = Range{20, 200};
  CHECK(acting_soil(b, measured).cohesion < 700);
  CHECK(acting_soil(b, measured).friction_angle > 32);
  CHECK(contains(strength_remark(b), "a power law through the ends of the tested envelope, 20 to 200 kPa"));
  b.soil.tests[0].normal_stress = Range{1, 200};
  CHECK(acting_soil(b, measured).cohesion == 2000);
  CHECK(strength_remark(b).empty());
}

TEST_CASE("lugs finer than half a grain are marked coarse") {
  WheelOutcome o;
  o.lug_grains = 0.9;
  CHECK(o.coarse());
  o.lug_grains = 1.2;
  CHECK_FALSE(o.coarse());
  o.lug_grains = 0;  // no lugs
  CHECK_FALSE(o.coarse());
}

TEST_CASE("trials of an earlier run are read from its file as they were written") {
  const Benchmark b = read_benchmark("ding_smooth");
  WheelOutcome o;
  o.bed = {0.0165, 1.26, 0.58, 0.13, 3.2};
  o.grains_per_width = 10;
  o.trials = 6;
  o.failed = 1;
  o.varied = {"wheel friction 0.3"};
  o.predictor.name = kOurs;
  for (std::size_t i = 0; i < b.point.size(); ++i)
    o.predictor.point.push_back({{Quantity::pull, {double(i), 0.1, double(i) - 1, double(i) + 2}}});
  o.predictor.point[2].clear();  // failed
  const TemporaryFolder folder;
  Json all;
  all[b.name] = as_json(report_of(b, o, {}, {}));
  const fs::path file = folder / "wheels.json";
  write_file_atomically(file, all.dump());
  const WheelOutcome back = read_outcomes(file, {b}).front();
  CHECK(back.bed.length == 1.26);
  CHECK(back.failed == 1);
  CHECK(back.varied == o.varied);
  CHECK(as_text(report_of(b, back, {}, {})) == as_text(report_of(b, o, {}, {})));
  CHECK(as_json(report_of(b, back, {}, {})).dump() == all[b.name].dump());

  refused([&] { read_outcomes(file, {read_benchmark("ding_lugs")}); }, "ding_lugs");
  Benchmark other = b;
  other.point[1].led[Quantity::slip] = 0.15;
  refused([&] { read_outcomes(file, {other}); }, "run its trials again");
  other.point.pop_back();
  refused([&] { read_outcomes(file, {other}); }, "has 6 points");
}
