#include "base/files/file.h"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <thread>

#include "base/error.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

constexpr uid_t kNobody = 65534;

std::size_t entries(const fs::path& folder) {
  return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Runs `code` in a child process and returns how it ended (as waitpid reports it). Exit code 3: DeviceError whose
/// sentence contains `expected`; 4: InputError that contains it; 5: some other sentence; 0: nothing was thrown.
int status_of_child(const std::string& expected, const std::function<void()>& code) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      code();
      ::_exit(0);
    } catch (const DeviceError& error) {
      ::_exit(contains(error.what(), expected) ? 3 : 5);
    } catch (const InputError& error) {
      ::_exit(contains(error.what(), expected) ? 4 : 5);
    }
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST_CASE("a written file reads back byte for byte and leaves nothing beside it") {
  const TemporaryFolder folder;
  const std::string content("line\r\n\0end", 10);
  write_file_atomically(folder / "a/b/c.txt", content);
  CHECK(read_file(folder / "a/b/c.txt") == content);
  write_file_atomically(folder / "a/b/c.txt", "new");
  CHECK(read_file(folder / "a/b/c.txt") == "new");
  CHECK(entries(folder / "a/b") == 1);
}

TEST_CASE("a process killed between writing and renaming leaves the old file whole") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "data.h5", "old");
  const int status = status_of_child("", [&] {
    replace_file_atomically(folder / "data.h5", [](const fs::path& temporary) {
      write_file_atomically(temporary, "new and longer");
      ::raise(SIGKILL);
    });
  });
  REQUIRE(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGKILL);
  CHECK(read_file(folder / "data.h5") == "old");
}

TEST_CASE("a process killed at any moment leaves one of the two whole files") {
  const TemporaryFolder folder;
  const std::string contents[2] = {std::string(300000, 'a'), std::string(200000, 'b')};
  write_file_atomically(folder / "data", contents[0]);
  for (int attempt = 0; attempt < 20; ++attempt) {
    const pid_t child = ::fork();
    if (child == 0)
      for (int i = 0;; ++i) write_file_atomically(folder / "data", contents[i % 2]);
    std::this_thread::sleep_for(std::chrono::microseconds(500 + 737 * attempt));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string found = read_file(folder / "data");
    CHECK((found == contents[0] || found == contents[1]));
  }
}

TEST_CASE("an exception while writing removes the partial file and keeps the old one") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  const auto write = [](const fs::path& temporary) {
    write_file_atomically(temporary, "half");
    throw InputError("stop");
  };
  CHECK_THROWS_AS(replace_file_atomically(folder / "a.txt", write), InputError);
  CHECK(read_file(folder / "a.txt") == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("the temporary file has the extension of the file it becomes") {
  const TemporaryFolder folder;
  replace_file_atomically(folder / "map.tif", [&](const fs::path& temporary) {
    CHECK(temporary.extension() == ".tif");
    CHECK(temporary.parent_path() == folder.path());
    write_file_atomically(temporary, "x");
  });
}

TEST_CASE("a device that takes no more bytes is reported and the old file stays") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  const int status = status_of_child("a.txt: cannot write", [&] {
    std::signal(SIGXFSZ, SIG_IGN);  // then a write beyond the limit fails, as on a full disk
    const rlimit limit{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    write_file_atomically(folder / "a.txt", std::string(100000, 'x'));
  });
  CHECK(WEXITSTATUS(status) == 3);
  CHECK(read_file(folder / "a.txt") == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("a folder without write permission is reported and keeps its content") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "a.txt", "old");
  ::chmod(folder.path().c_str(), 0555);
  const auto as_ordinary_user = [&](const std::string& expected, const std::function<void()>& code) {
    return WEXITSTATUS(status_of_child(expected, [&] {
      if (::geteuid() == 0 && ::setuid(kNobody) != 0) throw std::runtime_error("cannot become an ordinary user");
      code();
    }));
  };
  CHECK(as_ordinary_user("a.txt: cannot write: Permission denied",
                         [&] { write_file_atomically(folder / "a.txt", "new"); }) == 3);
  CHECK(as_ordinary_user("cannot create this folder", [&] { write_file_atomically(folder / "sub/a.txt", "new"); }) ==
        4);
  ::chmod(folder.path().c_str(), 0755);
  CHECK(read_file(folder / "a.txt") == "old");
  CHECK(entries(folder.path()) == 1);
}

TEST_CASE("reading says what is wrong with the path") {
  const TemporaryFolder folder;
  CHECK(contains(input_error([&] { read_file(folder / "none"); }), "none: no such file"));
  CHECK(contains(input_error([&] { read_file(folder.path()); }), "is a folder"));
  write_file_atomically(folder / "file", "");
  CHECK(contains(input_error([&] { create_folder(folder / "file"); }), "cannot create this folder"));
  CHECK(read_file(folder / "file").empty());
}

TEST_CASE("a pipe is read to its end, and a device is refused") {
  const TemporaryFolder folder;
  const std::string pipe = folder / "pipe.csv", content(200000, 'x');
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  std::thread writer([&] { std::ofstream(pipe) << content; });
  CHECK(read_file(pipe) == content);
  writer.join();
  CHECK(contains(input_error([] { read_file("/dev/zero"); }), "is a device"));
}

}  // namespace
}  // namespace gonogo
