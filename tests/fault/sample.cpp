// gonogo sample at the command line: what it writes and prints, and what it answers to bad input.
#include <algorithm>
#include <sstream>

#include "base/files/csv.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "learning/model/model.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

TEST_CASE("gonogo sample writes rows of the shipped model, the same ones every time") {
  const TemporaryFolder folder;
  const std::vector<std::string> words = {"sample", "--model",     "hmmwv",  "--set", "slope_along=12",
                                          "--set",  "payload=500", "--rows", "3000",  "--seed",
                                          "4",      "--json",      "--out"};
  const auto to = [&](const std::string& name, const std::string& threads) {
    std::vector<std::string> line = words;
    line.push_back(folder / name);
    line.insert(line.end(), {"--threads", threads});
    return run_gonogo(line);
  };
  const Ending first = to("a.csv", "1"), second = to("b.csv", "2");
  REQUIRE(first.exit_code == 0);
  CHECK(read_file(folder / "a.csv") == read_file(folder / "b.csv"));
  const Json report = Json::parse(first.out, "stdout");
  CHECK(report.at("rows").integer() == 3000);
  CHECK(report.at("known").at("payload").number() == 500);
  CHECK(report.at("mixed").boolean());
  CHECK(report.at("least_effective_rows").number() > 1000);
  std::istringstream csv(read_file(folder / "a.csv"));
  std::string line;
  std::size_t lines = 0;
  while (std::getline(csv, line)) lines += lines == 0 || line.rfind("12,", 0) == 0;
  CHECK(lines == 3001);

  REQUIRE(to("rows.h5", "1").exit_code == 0);
  const Hdf5Reader in(folder / "rows.h5");
  CHECK(in.array<std::int32_t>("outcome").size() == 3000);
}

TEST_CASE("gonogo sample from the prior agrees with gonogo infer") {
  const TemporaryFolder folder;
  const Ending infer = run_gonogo({"infer", "--model", "hmmwv", "--set", "slope_along=12", "--json"});
  const Ending rows = run_gonogo({"sample", "--model", "hmmwv", "--set", "slope_along=12", "--from", "prior", "--rows",
                                  "4000", "--json", "--out", folder / "rows.csv"});
  REQUIRE(rows.exit_code == 0);
  const double own = Json::parse(infer.out, "stdout").at("p_go").number();
  CHECK(Json::parse(rows.out, "stdout").at("p_go").number() == Approx(own).margin(0.04));
}

TEST_CASE("gonogo infer answers a table row by row as it answers points one by one, however the table is written") {
  const TemporaryFolder folder;
  const Ending one = run_gonogo({"infer", "--model", "hmmwv", "--set", "slope_along=12.5", "--json"});
  const double p_go = Json::parse(one.out, "stdout").at("p_go").number();
  for (const char* table : {"slope_along,payload\n3,\n12.5,\n", "\"slope_along\",\"payload\"\r\n3,NA\r\n12.5,NA\r\n",
                            "\xEF\xBB\xBFslope_along;payload\n3,0;\n12,5;\n", "slope_along\tpayload\n3\t\n12.5\t\n"}) {
    INFO(table);
    write_file_atomically(folder / "points.csv", table);
    const Ending ending =
        run_gonogo({"infer", "--model", "hmmwv", "--csv", folder / "points.csv", "--out", folder / "answers.csv"});
    REQUIRE(ending.exit_code == 0);
    const std::vector<CsvLine> answers = read_csv_lines(folder / "answers.csv", "answers");
    REQUIRE(answers.size() == 3);
    REQUIRE(answers[0].cell[2] == "p_go");
    CHECK(csv_number("answers.csv", 3, answers[2].cell[2]) == Approx(p_go).margin(1e-6));
  }
}

TEST_CASE("gonogo infer says that a table has no points, and writes the header of the answers") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "points.csv", "slope_along,payload\n");
  const Ending ending =
      run_gonogo({"infer", "--model", "hmmwv", "--csv", folder / "points.csv", "--out", folder / "answers.csv"});
  CHECK(ending.exit_code == 0);
  CHECK(contains(ending.err, (folder / "points.csv").string() + ": holds a header and no points"));
  CHECK(read_file(folder / "answers.csv").rfind("slope_along,payload,p_go", 0) == 0);
  CHECK(read_csv_lines(folder / "answers.csv", "answers").size() == 1);
  write_file_atomically(folder / "points.csv", "");
  check_refusal(run_gonogo({"infer", "--model", "hmmwv", "--csv", folder / "points.csv", "--out", folder / "b.csv"}), 2,
                {"points.csv", "holds no points"});
}

TEST_CASE("sample and qubo export warn of a joint distribution that is not the trials', in one sentence") {
  const TemporaryFolder folder;
  learning::Model model = learning::read_model(GONOGO_SOURCE_DIR "/data/quarter_wheel_90mm/model.h5");
  const auto commands = [&](const std::string& file) {
    return std::vector<std::vector<std::string>>{
        {"sample", "--model", file, "--rows", "200", "--out", folder / "rows.csv"},
        {"qubo", "export", "--model", file, "--out", folder / "problem.json"},
        {"sample", "--model", file, "--rows", "200", "--from", "prior", "--out", folder / "rows.csv"}};
  };
  const auto warnings = [&](double auc) {  // of all three commands
    model.provenance["joint"]["auc_values"] = auc;
    learning::write_model(folder / "model.h5", model);
    std::vector<bool> found;
    for (const std::vector<std::string>& command : commands(folder / "model.h5")) {
      const Ending ending = run_gonogo(command);
      REQUIRE(ending.exit_code == 0);
      found.push_back(contains(ending.out, "the machine's joint distribution is not that of its trials"));
      if (found.back()) CHECK(contains(ending.out, auc > 0.5 ? "an AUC of 0.91" : "of its rows pass, and"));
    }
    return found;
  };
  CHECK(warnings(0.91) == std::vector<bool>{true, true, false});  // rows of the prior are not the machine's
  CHECK(warnings(0.4) == std::vector<bool>{false, false, false});
  model.provenance["joint"]["passable"] = model.provenance["joint"]["trials_passable"].number() - 0.2;
  CHECK(warnings(0.4) == std::vector<bool>{true, true, false});
}

TEST_CASE("gonogo sample refuses bad input in one sentence and writes nothing") {
  const TemporaryFolder folder;
  const auto refuse = [&](std::vector<std::string> words, const std::vector<std::string>& parts,
                          const std::string& file = "rows.csv") {
    words.insert(words.begin(), "sample");
    words.insert(words.end(), {"--out", folder / file});
    check_refusal(run_gonogo(words), 2, parts);
    CHECK_FALSE(std::filesystem::exists(folder / file));
  };
  refuse({"--model", "/none.h5"}, {"/none.h5"});
  refuse({"--model", "hmmwv"}, {"rows.txt", ".csv or .h5"}, "rows.txt");
  refuse({"--model", "hmmwv", "--set", "slope_alnog=3"}, {"slope_alnog", "slope_along"});
  refuse({"--model", "hmmwv", "--set", "slope_along=300"}, {"slope_along=300", "outside the allowed range"});
  refuse({"--model", "hmmwv", "--outcome", "gone"}, {"gone"});
  refuse({"--model", "hmmwv", "--rows", "0"}, {"--rows"});
  refuse({"--model", "hmmwv", "--sampler", "gibs"}, {"--sampler", "gibs"});
  refuse({"--model", "hmmwv", "--sampler", "emulator", "--dead-share", "0.7"}, {"--dead-share", "0.7"});
  refuse({"--model", "hmmwv", "--from", "prior", "--sampler", "anneal"}, {"leave out the sampler anneal"});
}

}  // namespace
}  // namespace gonogo
