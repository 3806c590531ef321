#include "pipeline/campaign/study/contract.h"

#include <set>

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo::campaign {

namespace {

const std::string& file_text() {
  static const std::string text = read_file(GONOGO_SOURCE_DIR "/configs/schema/variables.json");
  return text;
}

/// The schema with one piece of text exchanged, which must be there.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = file_text();
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  return input_error([&] { parse_contract(text, "schema.json"); });
}

TEST_CASE("the compiled-in schema is the file, byte for byte") { CHECK(contract_text() == file_text()); }

TEST_CASE("the contract holds every entry of the schema in its order") {
  const Json schema = Json::parse(file_text(), "schema");
  const Contract& c = contract();
  REQUIRE(c.variables.size() == schema.at("variables").items().size());
  REQUIRE(c.measures.size() == schema.at("measures").items().size());
  for (std::size_t i = 0; i < c.variables.size(); ++i) {
    const Json& entry = schema.at("variables").items()[i];
    CHECK(c.variables[i].name == entry.at("name").string());
    CHECK(c.variables[i].unit == entry.at("unit").string());
    CHECK(c.variables[i].minimum == entry.at("range").items()[0].number());
    CHECK(c.variables[i].maximum == entry.at("range").items()[1].number());
    CHECK(c.variables[i].encoder.bits == entry.at("encoder").at("bits").integer());
    CHECK(c.variable_index(c.variables[i].name) == i);
  }
  for (std::size_t i = 0; i < c.measures.size(); ++i) {
    CHECK(c.measures[i].name == schema.at("measures").items()[i].at("name").string());
    CHECK(c.measure_index(c.measures[i].name) == i);
  }
}

TEST_CASE("outcomes are the verdicts and reasons of a valid trial, each once") {
  const Contract& c = contract();
  std::set<std::string> names;
  for (std::size_t i = 0; i < c.outcomes.size(); ++i) {
    names.insert(c.outcomes[i].name);
    CHECK(c.outcome_index(c.outcomes[i].verdict, c.outcomes[i].reason) == i);
    CHECK(c.outcomes[i].verdict != Verdict::unknown);
  }
  CHECK(names == std::set<std::string>{"go", "slow_go", "no_go/slope_unstable", "no_go/rollover", "no_go/slid_back",
                                       "no_go/power", "no_go/sinkage", "no_go/traction", "no_go/obstacle",
                                       "no_go/timeout"});
  CHECK(c.outcomes[0].name == "go");
  CHECK(c.outcomes[1].name == "slow_go");
  CHECK(contains(input_error([&] { c.outcome_index(Verdict::unknown, Reason::simulation_failed); }), "not an outcome"));
  CHECK(contains(input_error([&] { c.outcome_index(Verdict::go, Reason::traction); }), "not an outcome"));
}

TEST_CASE("enumerators and schema agree on names and codes") {
  CHECK(contract().info(Verdict::no_go).name == "no_go");
  CHECK(contract().info(Reason::none).name == "none");
  CHECK(contract().info(Reason::outside_sampled).code == int(Reason::outside_sampled));
  CHECK(contract().info(Reason::traction).label == "no traction");
}

TEST_CASE("a misspelt variable or measure is answered with the nearest one") {
  CHECK(contains(input_error([] { contract().variable_index("slope_allong"); }), "did you mean \"slope_along\"?"));
  CHECK(contains(input_error([] { contract().variable_index("cohesin"); }), "did you mean \"cohesion\"?"));
  CHECK(contains(input_error([] { contract().measure_index("slp"); }), "did you mean \"slip\"?"));
}

TEST_CASE("a schema that disagrees with the program is refused") {
  CHECK(refusal(file_text()) == "");
  CHECK(contains(refusal(changed(R"("name": "go", "code": 1)", R"("name": "go", "code": 7)")), "verdicts[0]"));
  CHECK(contains(refusal(changed(R"("name": "slid_back")", R"("name": "slid_down")")), "reasons[3]"));
  CHECK(contains(refusal(changed(R"("range": [-45, 45])", R"("range": [45, -45])")), "variables[0].range"));
  CHECK(contains(refusal(changed(R"("name": "cohesion")", R"("name": "payload")")), "\"payload\" appears twice"));
  CHECK(contains(refusal(changed(R"("verdicts": ["no_go"])", R"("verdicts": ["nogo"])")), "did you mean \"no_go\"?"));
  CHECK(contains(refusal(changed(R"("prior": "region")", R"("pryor": "region")")), "prior: missing"));
  CHECK(contains(refusal(changed("\"#1a9641\"", "\"green\"")), "colour"));
  CHECK(contains(refusal(changed("gonogo/variables/1", "gonogo/variables/9")), "schema"));
}

}  // namespace
}  // namespace gonogo::campaign
