#include "base/files/file.h"

#include <set>

#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

TEST_CASE("the content hash is XXH3-128 in canonical form") {
  // Answers of the xxh128sum program: printf '' | xxh128sum, printf a | xxh128sum, printf abc | xxh128sum.
  CHECK(content_hash("") == "99aa06d3014798d86001c324468d497f");
  CHECK(content_hash("a") == "a96faf705af16834e6c632b61e964e1f");
  CHECK(content_hash("abc") == "06b05ab6733a618578af5f94892f3950");
}

TEST_CASE("one flipped bit anywhere changes the hash") {
  const std::string text(1000, 'x');
  std::set<std::string> hashes{content_hash(text)};
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] ^= 1;
    hashes.insert(content_hash(changed));
  }
  CHECK(hashes.size() == text.size() + 1);
}

TEST_CASE("a file hashes like its content, zero bytes included") {
  const TemporaryFolder folder;
  const std::string content("a\0b\n", 4);
  write_file_atomically(folder / "f", content);
  CHECK(file_hash(folder / "f") == content_hash(content));
  std::string large;
  for (int i = 0; i < 600000; ++i) large += std::to_string(i);
  write_file_atomically(folder / "large", large);
  CHECK(file_hash(folder / "large") == content_hash(large));
  CHECK(contains(input_error([&] { file_hash(folder / "none"); }), "no such file"));
}

}  // namespace
}  // namespace gonogo
