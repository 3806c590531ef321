// Words of commands: a shell gives back what was put in.
#include "base/shell.h"

#include "tests/fault/shell.h"
#include "tests/support/catch.h"

namespace gonogo {

TEST_CASE("a plain word stays as it is, and any other goes into quotes") {
  CHECK(shell_word("out/my-map_2.tif") == "out/my-map_2.tif");
  CHECK(shell_word("two words.tif") == "'two words.tif'");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("it's") == R"('it'\''s')");
}

TEST_CASE("a shell reads back every word as it was") {
  std::string all;
  for (int c = 1; c < 256; ++c) all += char(c);
  for (const std::string word :
       {"a b", "a'b", "'", "$(false)", "`false`; false", "a\\b", "\"", "*", "~", "a&b|c>d", "ä é", ""})
    CHECK(shell("printf '[%s]' " + shell_word(word)).output == "[" + word + "]");
  CHECK(shell("printf %s " + shell_word(all)).output == all);
}

}  // namespace gonogo
