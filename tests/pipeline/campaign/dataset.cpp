#include "pipeline/campaign/dataset/dataset.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "pipeline/campaign/dataset/check.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/dataset/summary.h"
#include "tests/pipeline/campaign/csv_records.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace {

Dataset sample(std::size_t rows) {
  Dataset dataset;
  for (std::uint64_t i = 0; i < rows; ++i) {
    DesignPoint point{
        .index = i, .seed = random_bits(5, 0, i), .replicate_of = -1, .proposal_density = 1, .variables = {}};
    for (std::size_t v = 0; v < contract().variables.size(); ++v) {
      const Variable& variable = contract().variables[v];
      point.variables.push_back(variable.minimum + (variable.maximum - variable.minimum) * random_unit(6, v, i));
    }
    dataset.records.push_back(closed_form_trial(point));
  }
  dataset.provenance = {.study = "{\"study\": \"test\"}",
                        .contract_hash = "0123",
                        .program_version = "0.1.0",
                        .backend = "cpu",
                        .inputs = {{"vehicle", "abc"}},
                        .libraries = {{"compiler", "x"}, {"libc", "y"}},
                        .files = {{"vehicle", "{\"mass\": 1}\n"}}};
  return dataset;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// Equal bits, except that all not-a-numbers are one.
bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return same_bits(x, y) || (std::isnan(x) && std::isnan(y)); });
}

void check_same(const std::vector<TrialRecord>& a, const std::vector<TrialRecord>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CAPTURE(i);
    CHECK(a[i].point.index == b[i].point.index);
    CHECK(a[i].point.seed == b[i].point.seed);
    CHECK(a[i].point.replicate_of == b[i].point.replicate_of);
    CHECK(same_bits(a[i].point.proposal_density, b[i].point.proposal_density));
    CHECK(same(a[i].point.variables, b[i].point.variables));
    CHECK(a[i].verdict == b[i].verdict);
    CHECK(a[i].reason == b[i].reason);
    CHECK(same(a[i].measures, b[i].measures));
    CHECK(a[i].attempts == b[i].attempts);
    CHECK(a[i].failed_checks == b[i].failed_checks);
  }
}

std::string output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), count);
  REQUIRE(::pclose(pipe) == 0);
  return text;
}

TEST_CASE("a dataset comes back with the same bits") {
  const TemporaryFolder folder;
  const Dataset dataset = sample(300);
  write_dataset(folder / "dataset.h5", dataset);
  const Dataset back = read_dataset(folder / "dataset.h5");
  check_same(back.records, dataset.records);
  CHECK(back.provenance == dataset.provenance);
}

TEST_CASE("same rows and provenance give the same bytes; one bit more gives others") {
  const Dataset dataset = sample(40);
  const std::string bytes = dataset_image(dataset);
  CHECK(dataset_image(sample(40)) == bytes);
  Dataset changed = dataset;
  changed.records[17].measures[0] = std::nextafter(changed.records[17].measures[0], 1.0);
  CHECK(dataset_image(changed) != bytes);
  changed = dataset;
  changed.provenance.inputs[0].second = "abd";
  CHECK(dataset_image(changed) != bytes);
}

TEST_CASE("an empty dataset is a dataset") {
  const TemporaryFolder folder;
  write_dataset(folder / "empty.h5", sample(0));
  CHECK(read_dataset(folder / "empty.h5").records.empty());
}

TEST_CASE("h5dump reads values, units, descriptions and names of codes") {
  const TemporaryFolder folder;
  const Dataset dataset = sample(5);
  write_dataset(folder / "dataset.h5", dataset);
  const std::string file = (folder / "dataset.h5").string();
  const std::string slope = output_of("h5dump -m %.17g -d /variables/slope_along '" + file + "'");
  CHECK(contains(slope, "\"deg\""));
  CHECK(contains(slope, contract().variables[0].label));
  for (const TrialRecord& record : dataset.records) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", record.point.variables[0]);
    CHECK(contains(slope, text));
  }
  const std::string verdict = output_of("h5dump -d /outcome/verdict '" + file + "'");
  CHECK(contains(verdict, "\"go\", \"slow_go\", \"no_go\", \"unknown\""));
  CHECK(contains(output_of("h5dump -d /provenance/study '" + file + "'"), "{\"study\": \"test\"}"));
}

TEST_CASE("CSV comes back with the same bits") {
  const Dataset dataset = sample(300);
  const std::string csv = to_csv(dataset);
  check_same(csv_records(csv), dataset.records);
  CHECK(to_csv({csv_records(csv), {}}) == csv);
  CHECK(contains(csv, ",nan"));
  CHECK_FALSE(contains(csv, "-nan"));
}

TEST_CASE("rows that are not whole are not read") {
  const std::string row = to_row(sample(1).records[0]);
  REQUIRE(parse_record(row));
  for (std::size_t length = 0; length < row.rfind(','); ++length) CHECK_FALSE(parse_record(row.substr(0, length)));
  CHECK_FALSE(parse_record(row + ",1"));
  CHECK_FALSE(parse_record(row + " "));
}

TEST_CASE("JSON holds every trial and the provenance") {
  const Dataset dataset = sample(20);
  const Json json = Json::parse(to_json_text(dataset), "export");
  REQUIRE(json.at("trials").items().size() == 20);
  const Json& trial = json.at("trials").items()[7];
  CHECK(trial.at("seed").unsigned_integer() == dataset.records[7].point.seed);
  CHECK(same_bits(trial.at("friction_angle").number(), dataset.records[7].point.variables[2]));
  CHECK(json.at("provenance").at("study").at("study").string() == "test");
  CHECK(json.at("units").at("slope_along").string() == "deg");
}

TEST_CASE("files that are not a whole dataset of this contract are refused with file and place") {
  const TemporaryFolder folder;
  const std::string bytes = dataset_image(sample(10));
  std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  CHECK(contains(input_error([&] { read_dataset(folder / "cut.h5"); }), "cut.h5"));
  CHECK(contains(input_error([&] { read_dataset(folder / "none.h5"); }), "no such file"));
  Hdf5Writer model;
  model.array("weights", std::vector<double>{1, 2});
  model.save(folder / "model.h5");
  CHECK(contains(input_error([&] { read_dataset(folder / "model.h5"); }), "is no dataset"));
}

TEST_CASE("a summary counts what a by-hand count gives") {
  std::vector<TrialRecord> records = sample(4).records;
  const auto set = [&](std::size_t i, double slope, Verdict verdict, Reason reason, std::int64_t replicate_of) {
    records[i].point.variables[0] = slope;
    records[i].verdict = verdict;
    records[i].reason = reason;
    records[i].point.replicate_of = replicate_of;
    records[i].measures[0] = double(i);
  };
  set(0, 2, Verdict::go, Reason::none, -1);
  set(1, 4.9, Verdict::slow_go, Reason::none, 0);
  set(2, -0.1, Verdict::no_go, Reason::traction, 0);
  set(3, 5, Verdict::unknown, Reason::simulation_failed, 1);
  records[3].failed_checks = check_residual | check_energy;
  const DatasetSummary summary = summarise(records);
  CHECK(summary.by_verdict ==
        std::map<std::string, std::size_t>{{"go", 1}, {"slow_go", 1}, {"no_go", 1}, {"unknown", 1}});
  CHECK(summary.by_reason.at("none") == 2);
  CHECK(summary.replicates == 3);
  CHECK(summary.replicate_pairs == 2);
  CHECK(summary.replicate_agree == 1);
  REQUIRE(summary.failed.size() == 1);
  CHECK(summary.failed.front().first == records[3].point.index);
  CHECK(contains(to_text(summary), "(residual+energy)"));
  CHECK(summary.measures[0].minimum == 0);
  CHECK(summary.measures[0].mean == 1.5);
  REQUIRE(summary.slope.size() == 3);
  CHECK(summary.slope[0].from == -5);
  CHECK(summary.slope[0].no_go == 1);
  CHECK(summary.slope[1].go == 1);
  CHECK(summary.slope[1].slow_go == 1);
  CHECK(summary.slope[2].unknown == 1);
  CHECK(contains(to_text(summary), "1 of 2\n"));
  CHECK(to_json(summary).at("slope_along").items()[1].at("go").integer() == 1);
}

TEST_CASE("a sound dataset has no faults, and each planted fault is named") {
  CHECK(faults_of(sample(40)).empty());
  const auto faults_with = [](auto change) {
    Dataset dataset = sample(40);
    change(dataset.records);
    const std::vector<std::string> faults = faults_of(dataset);
    REQUIRE(faults.size() == 1);
    return faults.front();
  };
  using Records = std::vector<TrialRecord>;
  CHECK(contains(faults_with([](Records& r) { r.push_back(r[3]); }), "trial 3: comes after trial 39"));
  CHECK(contains(faults_with([](Records& r) { r[5].point.variables[0] = 46; }), "trial 5: slope_along is 46 deg"));
  CHECK(contains(faults_with([](Records& r) { r[5].point.variables[2] = std::nan(""); }),
                 "trial 5: friction_angle is nan"));
  CHECK(contains(faults_with([](Records& r) { r[5].point.proposal_density = 0; }), "proposal density is 0"));
  CHECK(contains(faults_with([](Records& r) { r[5].attempts = 3; }), "took 3 attempts"));
  CHECK(contains(faults_with([](Records& r) { r[9].point.replicate_of = 20; }), "does not come before it"));
  CHECK(contains(faults_with([](Records& r) { r[9].point.replicate_of = 2; }), "other variables than"));
  const std::string wrong = faults_with([](Records& r) {
    r[5].verdict = Verdict::go;
    r[5].reason = Reason::traction;
  });
  CHECK(contains(wrong, "trial 5: verdict go with reason traction"));
  CHECK(contains(faults_with([](Records& r) { r[6].failed_checks = check_too_fast; }), "with failed checks too_fast"));
}

TEST_CASE("differences of datasets: none with themselves, every changed bit, row and input otherwise") {
  const Dataset a = sample(30);
  CHECK(difference(a, a).none());
  Dataset b = a;
  b.records[4].measures[0] = std::nextafter(b.records[4].measures[0], 1e9);
  b.records.erase(b.records.begin() + 7);
  b.provenance.backend = "cuda, X";
  const DatasetDifference d = difference(a, b);
  CHECK(d.common == 29);
  CHECK(d.only_first == std::vector<std::uint64_t>{7});
  CHECK(d.only_second.empty());
  REQUIRE(d.rows.size() == 1);
  CHECK(d.rows[0].index == 4);
  CHECK(d.rows[0].column == contract().measures[0].name);
  CHECK(d.provenance == std::vector<std::string>{"backend: cpu against cuda, X"});
}

TEST_CASE("pairs of two datasets: verdicts that change, and measures where both pass") {
  Dataset a = sample(6), b;
  const std::size_t slip = contract().measure_index("slip");
  const auto set = [&](TrialRecord& record, Verdict verdict, Reason reason, double value) {
    record.verdict = verdict;
    record.reason = reason;
    record.measures[slip] = value;
  };
  for (std::size_t n = 0; n < 6; ++n) set(a.records[n], Verdict::go, Reason::none, 0.1);
  set(a.records[3], Verdict::no_go, Reason::traction, 0.9);
  b = a;
  set(b.records[0], Verdict::go, Reason::none, 0.2);
  set(b.records[1], Verdict::slow_go, Reason::none, 0.4);
  set(b.records[2], Verdict::no_go, Reason::traction, 1.0);
  set(b.records[3], Verdict::slow_go, Reason::none, 0.5);
  set(b.records[4], Verdict::unknown, Reason::simulation_failed, kNaN);
  b.records[5].point.variables[0] += 1;
  const PairedTrials pairs = paired(a, b);
  CHECK(pairs.pairs == 4);
  CHECK(pairs.verdicts ==
        std::map<std::pair<std::string, std::string>, std::size_t>{
            {{"go", "go"}, 1}, {{"go", "slow_go"}, 1}, {{"go", "no_go"}, 1}, {{"no_go", "slow_go"}, 1}});
  CHECK(pairs.now_pass == 1);
  CHECK(pairs.now_fail == 1);
  const MeasureChange& change = pairs.measures[slip];
  CHECK(change.pairs == 2);
  CHECK(change.mean == Approx(0.2));
  CHECK(change.error == Approx(0.1));  // of 0.1 and 0.3
  CHECK(to_text(pairs).find("1 equal, 1 from go to no_go, 1 from go to slow_go, 1 from no_go to slow_go; 1 pass now, "
                            "1 fail now") != std::string::npos);
  CHECK(to_text(paired(a, Dataset{})).empty());
  CHECK(to_json(pairs).at("measures").at("slip").at("mean").number() == Approx(0.2));
}

TEST_CASE("datasets of one study merge into the whole, overlapping or growing; others are refused") {
  const Dataset whole = sample(30);
  Dataset first = whole, second = whole;
  first.records.erase(first.records.begin() + 20, first.records.end());
  second.records.erase(second.records.begin(), second.records.begin() + 10);
  const Dataset merged = merge_datasets({second, first}, {"b", "a"});
  CHECK(difference(merged, whole).none());
  Dataset other = first;
  other.provenance.inputs[0].second = "changed";
  const std::string refused = input_error([&] { merge_datasets({second, other}, {"b", "a"}); });
  CHECK(
      contains(refused, "b and a: their trials depend on different inputs (content of vehicle: abc against changed)"));
  other = first;
  other.records[15].measures[0] += 1;
  CHECK(contains(input_error([&] { merge_datasets({second, other}, {"b", "a"}); }), "a: trial 15 has another result"));
  other = first;
  first.provenance.study = R"({"study": "test", "design": {"points": 20, "method": "sobol"}})";
  second.provenance.study = R"({"study": "test", "design": {"points": 40, "method": "sobol"}})";
  CHECK(merge_datasets({first, second}, {"a", "b"}).records.size() == 30);
}

}  // namespace
}  // namespace gonogo::campaign
