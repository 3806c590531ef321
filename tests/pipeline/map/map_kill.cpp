// A map killed at once, at any moment, goes on with the next tile and ends with the bytes of an undisturbed one.
// Alone in its program: the child is forked before any thread runs.
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

#include "base/files/file.h"
#include "base/math/random.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

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
