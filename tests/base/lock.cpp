#include "base/files/file.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "base/error.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

/// Whether the message names the process that has the folder, which is of this test program.
bool names_holder(const std::string& message) {
  return contains(message, "another run is using this folder (process ") &&
         contains(message, ", test_base_lock); wait");
}

/// How a second process fares with the folder: 0 it got the lock, 1 it was told that another holds it.
int second_process(const std::filesystem::path& folder) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(names_holder(input_error([&] { lock_folder(folder); })) ? 1 : 0);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}

TEST_CASE("a folder belongs to one process until that process lets go") {
  const TemporaryFolder folder;
  {
    const FileLock lock = lock_folder(folder / "out");
    CHECK(second_process(folder / "out") == 1);
    CHECK(!lock_folder_if_free(folder / "out").has_value());
  }
  CHECK(second_process(folder / "out") == 0);
  const auto held = lock_folder_if_free(folder / "out");
  CHECK(held.has_value());
  CHECK(second_process(folder / "out") == 1);
}

TEST_CASE("a killed process leaves no lock behind") {
  const TemporaryFolder folder;
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FileLock lock = lock_folder(folder.path());
    if (::write(ready[1], "x", 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char byte;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK(second_process(folder.path()) == 1);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(second_process(folder.path()) == 0);
}

TEST_CASE("a file in the way of the folder is reported") {
  const TemporaryFolder folder;
  { const FileLock lock = lock_folder(folder.path()); }
  CHECK(contains(input_error([&] { lock_folder(folder / ".lock"); }), "cannot create this folder"));
}

}  // namespace
}  // namespace gonogo
