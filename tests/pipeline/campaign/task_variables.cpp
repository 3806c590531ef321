// Sizes of obstacles as variables of a design: what trials, datasets and tables make of them, and what is refused.
#include "pipeline/campaign/study/contract.h"

#include <algorithm>

#include "base/files/file.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/design/design.h"
#include "pipeline/campaign/trial/trial.h"
#include "pipeline/campaign/trial/world.h"
#include "tests/pipeline/campaign/csv_records.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/short_trial.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace {

std::size_t index(const char* name) { return contract().variable_index(name); }

/// A study of the quarter vehicle on coarse grains: its task, and what its design says of sizes and beds.
struct StudyFile {
  TemporaryFolder folder;

  Study with(const std::string& task, const std::string& ranges, const std::string& fixed = R"("bed_depth": 0.3)",
             const std::string& bed = R"({"length_m": 3.2, "width_m": 0.7, "packing_seeds": 1})") {
    const std::string configs = std::string(GONOGO_SOURCE_DIR) + "/configs/";
    write_file_atomically(folder / "study.json", R"({"study": "sizes", "seed": 4, "vehicle": ")" + configs +
                                                     R"(vehicles/hmmwv_quarter.json", "soil": {"calibration": ")" +
                                                     configs + R"(soils/calibration_90mm.json"},
        "trial": {"task": )" + task + R"(, "bed": )" +
                                                     bed + R"(},
        "design": {"method": "sobol", "points": 16, "ranges": {"slope_along": [-2, 2])" +
                                                     ranges + R"(},
          "fixed": {"slope_across": 0, "friction_angle": 34, "cohesion": 0, "relative_density": 0.5, "payload": 0,
                    "tyre_friction": 0.8, "commanded_speed": 1.5, )" +
                                                     fixed + "}}}");
    return read_study(folder / "study.json");
  }

  TrialSetup setup(const std::string& task, const std::string& ranges,
                   const std::string& fixed = R"("bed_depth": 0.3)") {
    return read_trial_setup(with(task, ranges, fixed), std::filesystem::temp_directory_path() / "gonogo-test-beds");
  }
};

const std::string kDitch = R"({"type": "ditch"})", kSizes = R"(, "ditch_width": [0.3, 1], "ditch_depth": [0.05, 0.2])";

DesignPoint ditch_point(double width, double depth) {
  DesignPoint p = design_point(0, 34, 0.3);
  p.variables[index("ditch_width")] = width;
  p.variables[index("ditch_depth")] = depth;
  return p;
}

}  // namespace

TEST_CASE("a variable of a task is named after its type and its number") {
  const std::vector<TaskNumber> ditch = task_numbers("ditch"), step = task_numbers("step");
  REQUIRE(ditch.size() == 2);
  CHECK((ditch[0].key == "width_m" && ditch[0].variable == index("ditch_width")));
  CHECK((ditch[1].key == "depth_m" && ditch[1].variable == index("ditch_depth")));
  REQUIRE(step.size() == 1);
  CHECK((step[0].key == "height_m" && step[0].variable == index("step_height")));
  CHECK(task_numbers("climb").empty());
  const std::vector<TaskNumber> wheel = task_numbers("single_wheel");
  REQUIRE(wheel.size() == 2);
  CHECK((wheel[0].key == "slip" && wheel[0].variable == index("single_wheel_slip")));
  CHECK((wheel[1].key == "slip_angle_deg" && wheel[1].variable == index("single_wheel_slip_angle")));
}

TEST_CASE("a design samples the sizes of obstacles that it names, and all others are 0") {
  StudyFile file;
  const Study study = file.with(kDitch, kSizes);
  const std::vector<DesignPoint> points = make_design(read_design(study.section("design"), study.seed));
  for (const DesignPoint& p : points) {
    CHECK((p.variables[index("ditch_width")] > 0.3 && p.variables[index("ditch_width")] < 1));
    CHECK((p.variables[index("ditch_depth")] > 0.05 && p.variables[index("ditch_depth")] < 0.2));
    CHECK(p.variables[index("step_height")] == 0);
  }
  // A design without them has the points that it had before there were such variables: its first ones are the same.
  const Study climb = file.with(R"({"type": "climb"})", "");
  const std::vector<DesignPoint> plain = make_design(read_design(climb.section("design"), climb.seed));
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CHECK(plain[i].variables[index("slope_along")] == points[i].variables[index("slope_along")]);
    CHECK_FALSE(has_task_values(plain[i].variables));
  }
}

TEST_CASE("a trial of varied sizes stands on the bed, and drives the way, of one whose study gives these sizes") {
  StudyFile file;
  const TrialSetup varied = file.setup(kDitch, kSizes);
  const DesignPoint p = ditch_point(0.7, 0.15);
  const TrialSetup own = setup_at(varied, p);
  const TrialSetup given = file.setup(R"({"type": "ditch", "width_m": 0.7, "depth_m": 0.15})", "");
  CHECK(own.task->obstacle_end() == given.task->obstacle_end());
  CHECK(own.test_distance == given.test_distance);
  CHECK(own.run_in_distance == 0);
  CHECK(varied.task->obstacle_end() == 1.2);  // 0.2 m and the widest
  const terrain::Packing a = settled_bed(own, inputs_of(p)), b = settled_bed(given, inputs_of(p));
  REQUIRE(a.grain.size() == b.grain.size());
  for (std::size_t i = 0; i < a.grain.size(); ++i) CHECK(length(a.grain[i].position - b.grain[i].position) == 0);
  const terrain::Packing deeper = settled_bed(setup_at(varied, ditch_point(0.7, 0.2)), inputs_of(p));
  CHECK(deeper.grain.size() < a.grain.size());

  const TrialSetup step = file.setup(R"({"type": "step"})", R"(, "step_height": [0.05, 0.5])");
  DesignPoint high = design_point(0, 34, 0.3);
  high.variables[index("step_height")] = 0.125;
  CHECK(setup_at(step, high).task->rise() == 0.125);
  CHECK(step.task->rise() == 0.5);
}

TEST_CASE("the record of a trial of varied sizes is that of the trial whose study gives them") {
  StudyFile file;
  const DesignPoint p = ditch_point(0.5, 0.1);
  const auto cut_short = [](TrialSetup s) {
    s.time_limit = 0.3;
    s.ramp_time = s.min_drive_time = 0.1;
    s.park_time = 0.05;
    s.bed_settle_time = 0.05;
    s.numerics = {2e-3, 1, 20, 0};
    return s;
  };
  DesignPoint plain = p;
  plain.variables[index("ditch_width")] = plain.variables[index("ditch_depth")] = 0;
  const TrialRecord varied = run_trial(cut_short(file.setup(kDitch, kSizes)), p);
  const TrialRecord given =
      run_trial(cut_short(file.setup(R"({"type": "ditch", "width_m": 0.5, "depth_m": 0.1})", "")), plain);
  CHECK(varied.verdict == given.verdict);
  CHECK(varied.reason == given.reason);
  for (std::size_t m = 0; m < varied.measures.size(); ++m) {
    INFO(contract().measures[m].name);
    CHECK((varied.measures[m] == given.measures[m] || (varied.measures[m] != varied.measures[m])));
  }
}

TEST_CASE("datasets and tables hold the sizes of obstacles where trials have them, and else the columns of before") {
  const TemporaryFolder folder;
  Dataset plain, ditches;
  plain.provenance.study = ditches.provenance.study = "{}";
  for (std::uint64_t i = 0; i < 6; ++i) {
    DesignPoint p = design_point(double(i), 34, 0.3);
    p.index = i;
    plain.records.push_back(closed_form_trial(p));
    p = ditch_point(0.3 + 0.1 * double(i), 0.1);
    p.index = i;
    ditches.records.push_back(closed_form_trial(p));
  }
  write_dataset(folder / "plain.h5", plain);
  write_dataset(folder / "ditches.h5", ditches);
  CHECK_FALSE(contains(read_file(folder / "plain.h5"), "ditch"));
  CHECK_FALSE(contains(to_csv(plain), "ditch"));
  CHECK_FALSE(contains(to_json_text(plain), "ditch"));
  CHECK(contains(to_csv(ditches), ",commanded_speed,ditch_width,ditch_depth,step_height,"));
  const Dataset a = read_dataset(folder / "plain.h5"), b = read_dataset(folder / "ditches.h5");
  const auto c = csv_records(to_csv(plain)), d = csv_records(to_csv(ditches));
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(a.records[i].point.variables == plain.records[i].point.variables);
    CHECK(b.records[i].point.variables == ditches.records[i].point.variables);
    CHECK(c[i].point.variables == plain.records[i].point.variables);
    CHECK(d[i].point.variables == ditches.records[i].point.variables);
  }
  // A row of a ditch cut off at its last columns is no row of a trial without one.
  const std::string row = to_row(ditches.records[0]);
  CHECK(parse_record(row));
  for (std::size_t at = row.rfind(','); at != std::string::npos && at > 0; at = row.rfind(',', at - 1))
    CHECK_FALSE(parse_record(row.substr(0, at)));
}

TEST_CASE("a file of points may have columns of sizes") {
  StudyFile file;
  Study study = file.with(kDitch, kSizes);
  write_file_atomically(file.folder / "points.csv", "slope_along,ditch_width,ditch_depth\n1,0.4,0.1\n2,0.6,0.15\n");
  std::string text = read_file(file.folder / "study.json");
  const auto from = text.find(R"("method")"), to = text.find(R"("fixed")");
  text.replace(from, to - from, R"("method": "csv", "file": "points.csv", )");
  write_file_atomically(file.folder / "study.json", text);
  study = read_study(file.folder / "study.json");
  const std::vector<DesignPoint> points = make_design(read_design(study.section("design"), study.seed));
  REQUIRE(points.size() == 2);
  CHECK(points[1].variables[index("ditch_width")] == 0.6);
  CHECK(points[1].variables[index("step_height")] == 0);
  const TrialSetup setup = read_trial_setup(study);
  CHECK(setup_at(setup, points[1]).task->obstacle_end() == Approx(0.8));
}

TEST_CASE("sizes that the task does not take are refused in one sentence") {
  StudyFile file;
  const auto refuse = [&](const std::string& task, const std::string& ranges, const std::string& word,
                          const std::string& fixed = R"("bed_depth": 0.3)") {
    refused([&] { file.setup(task, ranges, fixed); }, word);
  };
  refuse(R"({"type": "climb"})", kSizes, "ranges.ditch_width: trials of type climb have no such number");
  refuse(R"({"type": "step", "height_m": 0.1})", kSizes, "trials of type step have no such number");
  refuse(R"({"type": "ditch", "width_m": 1})", kSizes, "trial.task gives width_m already; keep one of the two");
  refuse(R"({"type": "ditch", "width_m": 1, "depth_m": 0.1})", "", "trial.task gives depth_m already",
         R"("bed_depth": 0.3, "ditch_depth": 0.2)");
  refuse(kDitch, R"(, "ditch_width": [0.3, 1])",
         "trial.task.depth_m: missing; give it, or a range or value of ditch_depth");
  refuse(kDitch, R"(, "ditch_width": [0.3, 1], "ditch_depth": [0.05, 0.25])", "make bed_depth 0.43 m or more");
  refuse(kDitch, R"(, "ditch_width": [0, 1], "ditch_depth": [0.05, 0.2])", "width_m");
  refuse(kDitch, R"(, "ditch_width": [0.3, 4], "ditch_depth": [0.05, 0.2])", "needs a bed of");
  CHECK_NOTHROW(file.setup(kDitch, kSizes, R"("bed_depth": 0.3, "step_height": 0)"));

  const TrialSetup climb = file.setup(R"({"type": "climb"})", ""), ditch = file.setup(kDitch, kSizes);
  refused([&] { setup_at(climb, ditch_point(0.5, 0.1)); }, "ditch_width: trials of type climb have no such number");
  refused([&] { setup_at(ditch, design_point(0, 34, 0.3)); }, "trial.task");
  refused([&] { settled_bed(setup_at(ditch, ditch_point(0.5, 0.29)), inputs_of(ditch_point(0.5, 0.29))); },
          "bed deeper");
}

}  // namespace gonogo::campaign
