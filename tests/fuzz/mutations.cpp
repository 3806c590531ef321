// Damages the file of every reader many times and reads it: each time it is refused in a sentence or read. Nothing may
// crash, take longer than 10 s or more than 4 GiB. A file whose end is missing, and any file that holds a hash of
// itself, reads as the whole one or not at all.
//   mutations [--count N] [--reader NAME] [--from N] [--say WORDS]     mutations --list yes: the readers' names
// --say prints the refusals that hold these words.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "tests/fuzz/mutate.h"
#include "tests/fuzz/readers.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::fuzz {
namespace {

std::string g_say;

/// What the child has found so far; shared with it, so that it outlives a crash.
struct Tally {
  std::uint64_t next = 0;  // the mutation that is read now
  std::uint64_t refused = 0, same = 0, other = 0, wrong = 0, foreign = 0;
  char what[200] = {};  // of the last exception that is no InputError
};

constexpr unsigned kLongest = 10;                   // [s]
constexpr rlim_t kMemory = 4ull << 30;              // [B]
constexpr std::chrono::milliseconds kForeign(500);  // for HDF5 files without a seal, of which one in six never ends

/// One number after another, until `end`, in this process.
void read_mutations(const Reader& reader, const TemporaryFolder& folder, const std::string& whole,
                    const std::string& right, std::uint64_t end, Tally& tally) {
  for (; tally.next < end; ++tally.next) {
    const Mutation m = mutated(whole, tally.next);
    std::FILE* file = std::fopen((folder / reader.damaged).c_str(), "wb");
    std::fwrite(m.bytes.data(), 1, m.bytes.size(), file);
    std::fclose(file);
    alarm(kLongest);
    try {
      const bool same = reader.read(folder / reader.opened) == right;
      ++(same ? tally.same : tally.other);
      if (!same && (m.is_cut ? !reader.ends_anywhere : reader.is_sealed)) {
        ++tally.wrong;
        std::printf("  %s %llu: %s %zu of %zu bytes, and read otherwise\n", reader.name.c_str(),
                    static_cast<unsigned long long>(tally.next), m.is_cut ? "cut to" : "damaged,", m.bytes.size(),
                    whole.size());
      }
    } catch (const InputError& error) {
      ++tally.refused;
      if (!g_say.empty() && std::strstr(error.what(), g_say.c_str()))
        std::printf("  %s %llu: %s\n", reader.name.c_str(), static_cast<unsigned long long>(tally.next), error.what());
      if (std::strchr(error.what(), '\n')) {
        ++tally.foreign;
        std::printf("  %s %llu: more than a line: %s\n", reader.name.c_str(),
                    static_cast<unsigned long long>(tally.next), error.what());
      }
    } catch (const std::exception& error) {
      ++tally.foreign;
      std::printf("  %s %llu: no InputError: %s\n", reader.name.c_str(), static_cast<unsigned long long>(tally.next),
                  error.what());
    }
    alarm(0);
  }
  std::fflush(stdout);
}

/// Prints a row of the table. Whether nothing was found.
bool check(const Reader& reader, std::uint64_t from, std::uint64_t count) {
  const TemporaryFolder folder;
  reader.make(folder.path());
  const std::string whole = read_file(folder / reader.damaged), right = reader.read(folder / reader.opened);
  auto& tally =
      *static_cast<Tally*>(mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  new (&tally) Tally{.next = from};
  int crashes = 0, hangs = 0;
  while (tally.next < from + count) {
    std::fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      const rlimit memory{kMemory, kMemory};
      setrlimit(RLIMIT_AS, &memory);
      signal(SIGALRM, SIG_DFL);
      set_foreign_time(kForeign);
      read_mutations(reader, folder, whole, right, from + count, tally);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    const bool hang = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
    ++(hang ? hangs : crashes);
    std::printf("  %s %llu: %s\n", reader.name.c_str(), static_cast<unsigned long long>(tally.next),
                hang ? "took longer than 10 s" : "crashed");
    ++tally.next;
  }
  std::printf("%-22s %8llu %8llu %8llu %8llu %8llu %8d %8d\n", reader.name.c_str(),
              static_cast<unsigned long long>(count), static_cast<unsigned long long>(tally.refused),
              static_cast<unsigned long long>(tally.same), static_cast<unsigned long long>(tally.other),
              static_cast<unsigned long long>(tally.wrong), crashes + int(tally.foreign), hangs);
  const bool clean = crashes + hangs == 0 && tally.foreign + tally.wrong == 0;
  munmap(&tally, sizeof(Tally));
  return clean;
}

int run(int argc, char** argv) {
  std::uint64_t count = 100, from = 0;
  std::string only;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--count") count = std::strtoull(argv[i + 1], nullptr, 10);
    if (option == "--from") from = std::strtoull(argv[i + 1], nullptr, 10);
    if (option == "--reader") only = argv[i + 1];
    if (option == "--say") g_say = argv[i + 1];
    if (option == "--list") {
      for (const Reader& reader : readers()) std::puts(reader.name.c_str());
      return 0;
    }
  }
  std::printf("%-22s %8s %8s %8s %8s %8s %8s %8s\n", "reader", "files", "refused", "same", "other", "wrong", "crash",
              "hang");
  bool clean = true, found = false;
  for (const Reader& reader : readers())
    if (only.empty() || only == reader.name) {
      found = true;
      clean = check(reader, from, count) && clean;
    }
  return found && clean ? 0 : 1;
}

}  // namespace
}  // namespace gonogo::fuzz

int main(int argc, char** argv) { return gonogo::fuzz::run(argc, argv); }
