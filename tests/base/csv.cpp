// Tables of text as spreadsheets, R and databases write them.
#include "base/files/csv.h"

#include <filesystem>
#include <map>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/json.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
namespace fs = std::filesystem;

namespace {

using Cells = std::vector<std::vector<std::string>>;

Cells cells_of(const std::string& text) {
  const TemporaryFolder folder;
  write_file_atomically(folder / "table.csv", text);
  Cells cells;
  for (const CsvLine& line : read_csv_lines(folder / "table.csv", "rows")) cells.push_back(line.cell);
  return cells;
}

std::string refusal(const std::string& text) {
  return input_error([&] { cells_of(text); });
}

}  // namespace

TEST_CASE("the tables of csv-spectrum have the rows that their JSON says") {
  int tables = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(GONOGO_SOURCE_DIR) / "tests/base/csv_spectrum")) {
    if (entry.path().extension() != ".csv") continue;
    INFO(entry.path());
    fs::path answer = entry.path();
    const Json rows = Json::read(answer.replace_extension(".json"));
    const std::vector<CsvLine> lines = read_csv_lines(entry.path(), "rows");
    REQUIRE(lines.size() == rows.items().size() + 1);
    std::size_t n = 1;
    for (const Json& row : rows.items()) {
      std::map<std::string, std::string> read, expected;
      REQUIRE(lines[n].cell.size() == lines[0].cell.size());
      for (std::size_t k = 0; k < lines[0].cell.size(); ++k) read[lines[0].cell[k]] = lines[n].cell[k];
      for (const auto& [name, value] : row.members()) expected[name] = value.string();
      CHECK(read == expected);
      ++n;
    }
    ++tables;
  }
  CHECK(tables == 11);
}

TEST_CASE("a table reads the same with any separator, byte order mark and line ends") {
  const Cells plain = {{"mukey", "name", "sand"}, {"464399", "Example, complex", "40"}, {"464401", "Water", "NA"}};
  CHECK(cells_of("mukey,name,sand\n464399,\"Example, complex\",40\n464401,Water,NA\n") == plain);
  CHECK(cells_of("\xef\xbb\xbf\"mukey\";\"name\";\"sand\"\r\n464399;Example, complex;40\r\n464401;Water;NA\r\n") ==
        plain);
  CHECK(cells_of("# by hand\n\nmukey\tname\tsand\r464399\tExample, complex\t40\r464401\t Water\tNA") == plain);
  CHECK(cells_of("sep=;\nmukey;name;sand\n464399;Example, complex;40;\n464401;Water;NA;\n") == plain);
}

TEST_CASE("a comma between semicolons is a decimal sign, unless a number of the table has a point") {
  CHECK(cells_of("a;b\n1,5;-2,5e3\nx,y;7\n") == Cells{{"a", "b"}, {"1.5", "-2.5e3"}, {"x,y", "7"}});
  CHECK(cells_of("a;b\n1,500;2.5\n") == Cells{{"a", "b"}, {"1,500", "2.5"}});
  CHECK(cells_of("a;b\n1,500,000;2\n") == Cells{{"a", "b"}, {"1,500,000", "2"}});
  CHECK(cells_of("a\tb\n1,5\t2\n") == Cells{{"a", "b"}, {"1,5", "2"}});
}

TEST_CASE("a table that cannot be read is refused with the line") {
  CHECK(contains(refusal("a,b\n1,\"2\n3,4\n"), "table.csv: line 2: a quote begins and does not end"));
  CHECK(contains(refusal("a,b\n1,\"2\"3\n"), "line 2: text follows a quote"));
  CHECK(contains(refusal("\xff\xfe"
                         "a"),
                 "UTF-16"));
  CHECK(contains(refusal("PK\x03\x04 and more"), "as .xlsx and .ods files are"));
  CHECK(contains(refusal(std::string("a,b\n1,3\x00"
                                     "2\n",
                                     10)),
                 "bytes of value 0"));
  CHECK(contains(refusal("# nothing\n"), "holds no rows"));
}

TEST_CASE("cells that are written as a record are read back") {
  const std::vector<std::string> cells = {"# number",   "plain",    "with, comma", "with \"quotes\"",
                                          "two\nlines", " blanks ", "a;b",         ""};
  CHECK(cells_of("a,b,c,d,e,f,g,h\n" + csv_row(cells) + "\n")[1] == cells);
}

TEST_CASE("a cell without a value is told from a number") {
  for (const char* word : {"", "NA", "NaN", "NULL"}) CHECK(is_missing(word));
  CHECK_FALSE(is_missing("0"));
  CHECK(csv_number("t", 1, "-2.5e3") == -2500);
  CHECK(csv_number("t", 1, " +10. ") == 10);
  for (const char* word : {"0x10", "inf", "nan", "1e999", "+-1", "++1", "+", "1 2", "50%", "\u22121"}) {
    INFO(word);
    CHECK_FALSE(cell_number(word));
  }
  CHECK(contains(input_error([] { csv_number("t", 3, "2,5"); }), "line 3: \"2,5\" is no number"));
}
