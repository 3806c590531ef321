// A map killed at once, at any moment, goes on with the next tile and ends with the bytes of an undisturbed one.
// Alone in its program: the child is forked before any thread runs.
#include <omp.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>

#include "base/files/file.h"
#include "base/math/random.h"
#include "pipeline/map/write/compare_maps.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

namespace fs = std::filesystem;

constexpr int kSide = 1200;  // 9 tiles

MapRequest request_in(const TemporaryFolder& folder, const char* out) {
  MapRequest request = test::request_of_region(folder, out);
  request.threads = 1;
  return request;
}

void make_region(const TemporaryFolder& folder) { test::make_wavy_region(folder, "waves", {kSide, 60, 37, 53}); }

/// Makes the map in a child that is killed as soon as the file of finished tiles is larger than `bytes`.
bool killed_after(const TemporaryFolder& folder, std::uintmax_t bytes) {
  const pid_t child = fork();
  if (child == 0) {
    make_map(request_in(folder, "killed"));
    _exit(0);
  }
  const auto tiles = folder / "killed/.new/.blocks.scratch";
  std::error_code none;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (const auto size = std::filesystem::file_size(tiles, none); !none && size > bytes) kill(child, SIGKILL);
    usleep(500);
  }
  return WIFSIGNALED(status);
}

}  // namespace

TEST_CASE("a killed map goes on where it was and has the same bytes") {
  setenv("OMP_NUM_THREADS", "1", 1);
  const TemporaryFolder folder;
  make_region(folder);
  REQUIRE(killed_after(folder, 300));  // in the middle of a record
  REQUIRE(killed_after(folder, 14'000'000));
  const MapSummary resumed = make_map(request_in(folder, "killed"));
  CHECK(resumed.tiles_found >= 2);
  CHECK(resumed.tiles_found < 9);
  make_map(request_in(folder, "whole"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "whole")) {
    INFO(entry.path());
    CHECK(read_file(entry.path()) == read_file(folder / "killed" / entry.path().filename().string()));
    ++files;
  }
  CHECK(files > 20);
  int left = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "killed"))
    left += entry.path().filename().string().front() == '.';
  CHECK(left == 0);
}

TEST_CASE("a folder takes one map at a time, and a new map replaces all of the old one") {
  const TemporaryFolder folder;
  test::make_wavy_region(folder, "waves", {60, 60, 37, 53});
  MapRequest first = request_in(folder, "map");
  const MapSummary old = make_map(first);
  write_file_atomically(folder / "map/mine.txt", "kept");
  fs::create_directory(folder / "map/.new");
  {
    const auto lock = lock_folder_if_free(folder / "map/.new");
    REQUIRE(lock);
    first.rules.go = 0.97;
    CHECK(contains(input_error([&] { make_map(first); }), "another run is using this folder"));
  }
  require_whole_map(folder / "map", {"go.tif", "index.html"});
  MapRequest speedless = first;
  speedless.model.hash = "another";
  make_map(speedless);
  const Json record = Json::read(folder / "map/map.json");
  CHECK(record.at("inputs").at("model_hash").string() == "another");
  for (const auto& [name, hash] : record.at("files").members()) {
    INFO(name);
    CHECK(file_hash(folder / "map" / name) == hash.string());
  }
  CHECK(read_file(folder / "map/mine.txt") == "kept");
  CHECK_FALSE(fs::exists(folder / "map/.new"));
}

TEST_CASE("a map of which one file is another's is refused") {
  const TemporaryFolder folder;
  test::make_wavy_region(folder, "waves", {60, 60, 37, 53});
  make_map(request_in(folder, "map"));
  make_map(request_in(folder, "second"));
  std::string bytes = read_file(folder / "map/p_go.tif");
  bytes[bytes.size() / 2] ^= 1;
  write_file_atomically(folder / "map/p_go.tif", bytes);
  CHECK(contains(input_error([&] {
                   compare_maps({folder / "map", folder / "second", folder / "both"});
                 }),
                 "p_go.tif: is not the file that"));
  CHECK_FALSE(make_map(request_in(folder, "map")).reused);
  compare_maps({folder / "map", folder / "second", folder / "both"});
}

namespace {

/// Whether every file that the record names stands in the folder as the record says; the page may be missing.
bool are_of(const fs::path& folder, const Json& record) {
  for (const auto& [name, hash] : record.at("files").members()) {
    if (name == "index.html" && !fs::exists(folder / name)) continue;
    if (!fs::exists(folder / name) || file_hash(folder / name) != hash.string()) return false;
  }
  return true;
}

/// The folder holds a whole map, or one that misses its page or its record alone, or neither page nor record.
bool is_whole_or_none(const fs::path& folder) {
  for (const char* record : {"map.json", ".new/map.json"})
    if (fs::exists(folder / record) && are_of(folder, Json::read(folder / record))) return true;
  return !fs::exists(folder / "map.json") && !fs::exists(folder / "index.html");
}

/// Makes the map in a child that is killed when `when` says so. False when it ended before.
template <class When>
bool killed_when(const MapRequest& request, const When& when) {
  const pid_t child = fork();
  if (child == 0) {
    make_map(request);
    _exit(0);
  }
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0)
    if (when()) kill(child, SIGKILL);
  return WIFSIGNALED(status);
}

}  // namespace

TEST_CASE("a map killed at any moment over an older one leaves the old one, the new one, or none, never a mix") {
  omp_set_num_threads(1);  // a child of a process with several threads cannot start any
  using Clock = std::chrono::steady_clock;
  const TemporaryFolder folder;
  test::make_wavy_region(folder, "waves", {200, 60, 37, 53});
  const fs::path map = folder / "map";
  MapRequest old = request_in(folder, "map"), next = old;
  next.rules.go = 0.97;
  make_map(old);
  const auto begin = Clock::now();
  make_map(next);
  const auto whole = Clock::now() - begin;
  int killed = 0, in_exchange = 0;
  for (int k = 0; k < 12; ++k) {
    make_map(old);
    const auto start = Clock::now();
    killed += killed_when(next, [&] { return Clock::now() - start > whole * (k + 1) / 13; });
    INFO("moment " << k);
    CHECK(is_whole_or_none(map));
  }
  for (int k = 0; k < 12; ++k) {
    make_map(old);
    in_exchange += killed_when(next, [&] { return !fs::exists(map / "map.json"); });
    INFO("exchange " << k);
    CHECK(is_whole_or_none(map));
  }
  CHECK(killed >= 8);
  CHECK(in_exchange >= 1);
  make_map(next);
  CHECK(is_whole_or_none(map));
  CHECK(Json::read(map / "map.json").at("inputs").at("rules").at("go").number() == 0.97);
}

TEST_CASE("one flipped bit anywhere in a map's record is refused, and the map is made again") {
  const TemporaryFolder folder;
  test::make_wavy_region(folder, "waves", {60, 60, 37, 53});
  make_map(request_in(folder, "map"));
  const fs::path record = folder / "map/map.json";
  const std::string whole = read_file(record);
  const std::string content = Json::parse(whole, "map.json").dump();
  int harmless = 0;
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 1000) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ (1 << (at % 8)));
    write_file_atomically(record, bytes);
    std::string read;
    try {
      read = Json::parse(bytes, "map.json").dump();
    } catch (const InputError&) {
    }
    if (read == content) {  // white space
      ++harmless;
      continue;
    }
    INFO("byte " << at);
    CHECK_THROWS_AS(require_whole_map(folder / "map", {"go.tif"}), InputError);
  }
  CHECK(harmless < int(whole.size() / 4));
  CHECK_FALSE(make_map(request_in(folder, "map")).reused);
  CHECK(make_map(request_in(folder, "map")).reused);
}
