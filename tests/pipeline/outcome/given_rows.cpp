// Rows given to an evaluation: how their file is read, and what their scores say.
#include "pipeline/outcome/evaluation/joint_scores.h"

#include <cmath>
#include <cstdio>
#include <functional>

#include "base/files/file.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/trained_model.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

namespace {

const std::string kHeader = [] {
  std::string text;
  for (const Variable& variable : contract().variables) text += variable.name + ",";
  return text + "outcome";
}();

fs::path written(const std::string& text) {
  fs::path path = scratch() / "rows.csv";
  write_file_atomically(path, text);
  return path;
}

using Change = std::function<void(std::vector<double>& variables, std::size_t& outcome)>;

/// Lines of the header's columns for fresh trials, each changed, with `more` behind.
std::string lines_of(std::size_t trials, std::uint64_t seed, const Change& change = {}, const std::string& more = "") {
  const TrainingData data = make_training_data(synthetic_trials(trials, seed), {});
  std::string text;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) {
    std::vector<double> variables(data.table.row(n).begin(), data.table.row(n).end());
    std::size_t outcome = data.table.outcome[n];
    if (change) change(variables, outcome);
    for (const double x : variables) text += Json(x).dump() + ",";
    text += contract().outcomes[outcome].name + more + "\n";
  }
  return text;
}

void opposite_outcome(std::vector<double>&, std::size_t& outcome) {
  const bool passed = passable_outcomes()[outcome] > 0;
  outcome = passed ? contract().outcome_index(Verdict::no_go, Reason::traction)
                   : contract().outcome_index(Verdict::go, Reason::none);
}

/// Scores of the given rows and of the training trials against 300 fresh ones.
Json kinds_with(const fs::path& rows) {
  static const Predictor predictor = Predictor::read(model_file());
  static const learning::TrainingTable trained = make_training_data(synthetic_trials(120, 1), {}).table;
  static const learning::TrainingTable held_out = make_training_data(synthetic_trials(300, 55), {}).table;
  return to_json(joint_scores(predictor, trained, held_out, 1, read_given_rows(rows))).at("kinds");
}

}  // namespace

TEST_CASE("rows are read by their header: weights and occurrences multiply, columns of no meaning count for nothing") {
  const learning::TrainingTable table =
      read_given_rows(written("outcome,colour,weight,slope_along,occurrences\n"
                              "go,3,0.5,12.25,4\n"
                              "no_go/traction,7,0,30,1\n"
                              "no_go/slid_back,1,1e-3,34,2\n"));
  REQUIRE(table.row_count() == 2);  // a weight of 0 leaves a row out
  CHECK(table.weight == std::vector<double>{2, 2e-3});
  CHECK(table.row(0)[contract().variable_index("slope_along")] == 12.25);
  CHECK(std::isnan(table.row(1)[contract().variable_index("cohesion")]));
  CHECK(contract().outcomes[table.outcome[0]].name == "go");
  CHECK(contract().outcomes[table.outcome[1]].name == "no_go/slid_back");
}

TEST_CASE("files of rows that cannot be scored are refused by line and reason") {
  refused([] { read_given_rows(scratch() / "none.csv"); }, "none.csv");
  refused([] { read_given_rows(written("slope_along,cohesion\n1,2\n")); }, "no column \"outcome\"");
  refused([] { read_given_rows(written("slope_along,outcome\n")); }, "no rows");
  refused([] { read_given_rows(written("slope_along,outcome\n1,go\n2,gone\n")); }, "\"gone\" is no outcome");
  refused([] { read_given_rows(written("slope_along,outcome\n1,go\n2,gone\n")); }, "line 3");
  refused([] { read_given_rows(written("slope_along,outcome\nsteep,go\n")); }, "steep");
  refused([] { read_given_rows(written("slope_along,outcome\n1,go,3\n")); }, "has 3 columns, the header 2");
  refused([] { read_given_rows(written("slope_along,outcome,weight\n1,go,-1\n")); }, "at least 0");
  refused([] { kinds_with(written(kHeader + "\n" + lines_of(20, 3))); }, "50 are needed");
  refused([] { kinds_with(written("slope_along,outcome\n1,go\n")); }, "0 of the 1 rows given");
}

TEST_CASE("given rows of the same law score as trials do, others are told from them") {
  const Json real = kinds_with(written(kHeader + "\n" + lines_of(300, 77)));
  const Json steeper =
      kinds_with(written(kHeader + "\n" + lines_of(300, 77, [](std::vector<double>& x, std::size_t&) { x[0] += 12; })));
  const Json opposite = kinds_with(written(kHeader + "\n" + lines_of(300, 77, opposite_outcome)));
  std::printf("AUC in bins: trials %.3f, same law %.3f, steeper %.3f, opposite outcomes %.3f\n",
              real.at("trials").at("auc_bins").number(), real.at("given").at("auc_bins").number(),
              steeper.at("given").at("auc_bins").number(), opposite.at("given").at("auc_bins").number());
  CHECK(real.at("given").at("auc_bins").number() < 0.62);
  CHECK(real.at("given").at("auc_values").number() < 0.62);
  CHECK(steeper.at("given").at("auc_bins").number() > 0.65);
  CHECK(steeper.at("given").at("marginals").at("of").items()[0].string() == "slope_along");
  CHECK(opposite.at("given").at("auc_bins").number() > 0.65);
  CHECK(real.at("given").at("trained_brier").number() < real.at("trials").at("trained_brier").number() + 0.05);
  CHECK(opposite.at("given").at("trained_brier").number() > 0.4);
  for (const char* kind : {"machine", "trials", "gaussian_copula"})
    CHECK(real.at(kind).dump() == opposite.at(kind).dump());  // the other kinds do not see the rows
}

TEST_CASE("weights decide which of the given rows count, and their scale does not") {
  const Json plain = kinds_with(written(kHeader + "\n" + lines_of(300, 77))).at("given");
  const auto mixed = [&](const std::string& good, const std::string& bad) {
    return kinds_with(written(kHeader + ",weight\n" + lines_of(300, 77, {}, "," + good) +
                              lines_of(300, 78, opposite_outcome, "," + bad)))
        .at("given");
  };
  CHECK(kinds_with(written(kHeader + ",weight\n" + lines_of(300, 77, {}, ",8"))).at("given").dump() == plain.dump());
  CHECK(mixed("1", "0").dump() == plain.dump());
  const double faint = mixed("1", "1e-9").at("trained_brier").number(),
               alike = mixed("1", "1").at("trained_brier").number(),
               strong = mixed("1e-9", "1").at("trained_brier").number();
  std::printf(
      "Brier score by rows half of which have the opposite outcome: %.3f where these weigh nothing, %.3f alike, "
      "%.3f where the others do\n",
      faint, alike, strong);
  CHECK(faint < plain.at("trained_brier").number() + 0.05);
  CHECK(alike > faint + 0.05);
  CHECK(strong > alike + 0.05);
}

TEST_CASE("an evaluation reports the rows given beside the other kinds") {
  const Evaluation evaluation =
      evaluate_model(model_file(), dataset_file("fresh_rows.h5", 200, 55), written(kHeader + "\n" + lines_of(300, 77)));
  const JointScores& joint = evaluation.joint;
  REQUIRE(joint.kinds.back().name == "given");
  CHECK(joint.kinds.back().auc_bins < 0.65);
  CHECK(joint_text(joint).find("the rows given") != std::string::npos);

  const Evaluation quick = evaluate_joint(model_file(), scratch() / "fresh_rows.h5", scratch() / "rows.csv");
  const Json whole = to_json(evaluation), part = to_json(quick);
  CHECK(part.at("joint").dump() == whole.at("joint").dump());
  CHECK(part.at("scores").at("model").dump() == whole.at("scores").at("model").dump());
  CHECK(quick.trials == evaluation.trials);
  CHECK(quick.scores.of.size() == 1);
  refused([] { evaluate_model(model_file(), scratch() / "fresh_rows.h5", scratch() / "none.csv"); }, "none.csv");
}
