// The comparison of solvers, interrupted at the command line: what ended is kept and said.
#include <algorithm>
#include <csignal>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace fs = std::filesystem;

TEST_CASE("a comparison of solvers that is interrupted in a solver keeps the runs that ended") {
  // Sweeps solve the first problem exactly and stall on the second, which would take them an hour.
  const std::string small = GONOGO_SOURCE_DIR "/tests/data/fclib/FC3D_Example1.dat",
                    large = GONOGO_SOURCE_DIR "/tests/data/fclib/RockPile_tob1.dat";
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const fs::path times = folder / "out" / "times.csv";
    RunOptions options;
    options.signal = signal;
    options.when = [&] { return fs::exists(times); };
    const Ending cut = run_gonogo({"bench", "solvers", small, large, "--solver", "nsgs", "--tolerance", "1e-3,1e-14",
                                   "--iterations", "100000000", "--out", folder / "out"},
                                  options);
    CHECK(cut.exit_code == 130);
    CHECK(cut.out.find("FC3D_Example1.dat") != std::string::npos);
    CHECK(cut.out.find("RockPile") == std::string::npos);
    CHECK(cut.err.find("hold the 1 runs that ended") != std::string::npos);
    const std::string kept = read_file(times);
    CHECK(std::count(kept.begin(), kept.end(), '\n') == 1 + 2);  // a row per tolerance
    CHECK(read_file(folder / "out" / "curves.csv").find("FC3D_Example1.dat,3,nsgs,0,") != std::string::npos);
    CHECK_FALSE(fs::exists(folder / "out" / "profile.csv"));
  }
}

}  // namespace gonogo
