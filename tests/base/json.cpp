#include "base/json/json.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/error.h"
#include "base/math/random.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo {
namespace {

Json parse(const std::string& text) { return Json::parse(text, "x.json"); }

TEST_CASE("every double survives text and back with the same bits") {
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const double x = std::bit_cast<double>(random_bits(7, 0, i));
    if (!std::isfinite(x)) continue;
    const double back = parse("[" + Json(x).dump() + "]").items()[0].number();
    REQUIRE(std::bit_cast<std::uint64_t>(back) == std::bit_cast<std::uint64_t>(x));
  }
}

TEST_CASE("whole numbers keep all their digits") {
  CHECK(parse("9223372036854775807").integer() == std::numeric_limits<std::int64_t>::max());
  CHECK(parse("-9223372036854775808").integer() == std::numeric_limits<std::int64_t>::min());
  CHECK(parse("18446744073709551615").unsigned_integer() == std::numeric_limits<std::uint64_t>::max());
  for (const char* text : {"18446744073709551615", "9223372036854775808", "9223372036854775807"})
    CHECK(parse(text).dump() == text);
  CHECK(input_error([] { parse("18446744073709551615").integer(); }) != "");
  CHECK(input_error([] { parse("-1").unsigned_integer(); }) != "");
}

TEST_CASE("text with every kind of value prints back to itself") {
  const std::string text = R"({"z":[1,-2.5,true,false,null],"a":{"empty":{},"none":[]},"text":"tab\t \"quote\" é"})";
  CHECK(parse(text).dump() == text);
  CHECK(parse(parse(text).dump(2)).dump() == text);
}

TEST_CASE("objects keep the order of their keys") {
  Json object = Json::object();
  object["zebra"] = 1;
  object["ape"] = 2;
  object["zebra"] = 3;
  CHECK(object.dump() == R"({"zebra":3,"ape":2})");
}

/// The fields of the refusal of a text: file, JSON path, line, column.
InputPlace place_of(const std::string& text) {
  try {
    parse(text);
  } catch (const PlacedInputError& error) {
    return error.place;
  }
  FAIL("the text was accepted");
  return {};
}

TEST_CASE("a syntax error names the file, the line and the column") {
  const std::string missing_comma = "{\n \"a\": 1\n  \"bee\": 2\n}";
  CHECK(contains(input_error([&] { parse(missing_comma); }), "x.json: line 3, column 3: not valid JSON"));
  CHECK(contains(input_error([] { parse(""); }), "x.json: line 1, column 1: "));
  CHECK(contains(input_error([] { parse("{\"a\": 1} trailing"); }), "not valid JSON"));
  CHECK(contains(input_error([] { parse("{\"a\": NaN}"); }), "not valid JSON"));
  const InputPlace place = place_of(missing_comma);
  CHECK(place.file == "x.json");
  CHECK(place.path == "");
  CHECK(place.line == 3);
  CHECK(place.column == 3);
}

TEST_CASE("columns count characters, not bytes, and lines of both kinds") {
  CHECK(place_of("[\"\u00e4\u00f6\u00fc\" 1]").column == place_of("[\"aou\" 1]").column);
  CHECK(place_of("[\"aou\" 1]").column == 8);
  CHECK(place_of("[1,\r\n2,,3]").line == 2);
  CHECK(place_of("[1,\r\n2,,3]").column == 3);
  CHECK(place_of("[1, 2").line == 1);
  CHECK(place_of("[1,\n2\n").line >= 2);
}

TEST_CASE("a key given twice is named by its path") {
  const InputPlace place = place_of(R"({"bed": [{}, {"size": 1, "size": 2}]})");
  CHECK(place.path == "bed[1].size");
  CHECK(place.line == 0);
}

TEST_CASE("what would lose data is refused") {
  CHECK(contains(input_error([] { parse(R"({"a": 1, "b": {"a": 2}, "a": 3})"); }), "\"a\" appears twice"));
  CHECK(parse(R"({"a": 1, "b": {"a": 2}})").at("b").at("a").integer() == 2);
  CHECK(contains(input_error([] { parse("[1,\n1e999]"); }), "line 2, column 1: the number 1e999 is too large"));
}

TEST_CASE("nesting has a limit instead of a stack overflow") {
  const auto nested = [](int depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  CHECK(parse(nested(512)).dump() == nested(512));
  CHECK(contains(input_error([&] { parse(nested(100000)); }), "nested deeper than 512"));
}

TEST_CASE("bytes that are not UTF-8 print as a replacement character") {
  CHECK(Json(std::string("a\xff")).dump() == "\"a\xEF\xBF\xBD\"");
}

TEST_CASE("NaN prints as null") {
  CHECK(Json(std::nan("")).dump() == "null");
  CHECK(Json(std::numeric_limits<double>::infinity()).dump() == "null");
}

TEST_CASE("asking for another type says what was found") {
  CHECK(contains(input_error([] { parse("\"five\"").number(); }), "found text \"five\""));
  CHECK(contains(input_error([] { parse("{}").at("mass"); }), "\"mass\" is missing"));
}

}  // namespace
}  // namespace gonogo
