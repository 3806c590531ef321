// Records survive a torn end, flipped bits and a change of key as promised.
#include "base/files/record_log.h"

#include <filesystem>

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;

TEST_CASE("records are found again under the same key, and forgotten under another") {
  const TemporaryFolder folder;
  {
    RecordLog log(folder / "log", "inputs A");
    log.append(3, "three");
    log.append(1, std::string("o\0e", 3));
    log.append(3, "three again");
  }
  {
    const RecordLog log(folder / "log", "inputs A");
    CHECK(log.read(3) == "three again");
    CHECK(log.read(1) == std::string("o\0e", 3));
    CHECK(log.size_of(1) == 3);
    CHECK_FALSE(log.has(2));
  }
  const RecordLog other(folder / "log", "inputs B");
  CHECK_FALSE(other.has(3));
}

TEST_CASE("wherever the file is cut off, whole records before the cut are found and none after it") {
  const TemporaryFolder folder;
  std::vector<std::uintmax_t> ends;
  {
    RecordLog log(folder / "log", "k");
    for (std::uint32_t i = 0; i < 4; ++i) {
      log.append(i, std::string(20 + 7 * i, char('a' + i)));
      ends.push_back(std::filesystem::file_size(folder / "log"));
    }
  }
  const std::string bytes = read_file(folder / "log");
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    write_file_atomically(folder / "cut", bytes.substr(0, cut));
    RecordLog log(folder / "cut", "k");
    for (std::uint32_t i = 0; i < 4; ++i) REQUIRE(log.has(i) == (cut >= ends[i]));
    log.append(9, "new");
    REQUIRE(RecordLog(folder / "cut", "k").read(9) == "new");
  }
}

TEST_CASE("a flipped bit ends what is found") {
  const TemporaryFolder folder;
  {
    RecordLog log(folder / "log", "k");
    for (std::uint32_t i = 0; i < 3; ++i) log.append(i, std::string(30, char('a' + i)));
  }
  std::string bytes = read_file(folder / "log");
  bytes[bytes.size() - 35] ^= 1;  // in the last record
  write_file_atomically(folder / "log", bytes);
  const RecordLog log(folder / "log", "k");
  CHECK(log.has(1));
  CHECK_FALSE(log.has(2));
}
