#include "learning/sampler/chains/gpu_chains.h"

#include <array>
#include <map>
#include <vector>

#include "tests/support/catch.h"

using namespace gonogo::learning;

TEST_CASE("blocks take every sweep of every group once, each as many as the others, and begin shared groups first") {
  for (const auto& [groups, count, blocks] : {std::array<std::uint64_t, 3>{1024, 1000, 264},
                                              {1, 7, 1},
                                              {5, 1, 5},
                                              {5, 3, 4},
                                              {9, 13, 4},
                                              {265, 11, 264},
                                              {528, 10, 264},
                                              {100, 17, 99}}) {
    INFO(groups << " groups, " << count << " sweeps, " << blocks << " blocks");
    struct Part {
      std::uint64_t block, begin, end;
      std::uint64_t started;  // sweeps that its block has behind it by then
    };
    std::map<std::uint64_t, std::vector<Part>> parts;
    std::uint64_t fewest = UINT64_MAX, largest = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      ChainShare share(groups, count, int(b), int(blocks));
      std::uint64_t taken = 0;
      while (!share.done()) {
        const ChainStretch s = share.next();
        REQUIRE(s.begin < s.end);
        parts[s.group].push_back({b, s.begin, s.end, taken});
        taken += s.end - s.begin;
      }
      fewest = std::min(fewest, taken);
      largest = std::max(largest, taken);
    }
    CHECK(largest - fewest <= 1);
    CHECK(parts.size() == groups);
    for (const auto& [group, list] : parts) {
      REQUIRE(list.size() <= 2);
      if (list.size() == 1) {
        CHECK(list[0].begin == 0);
        CHECK(list[0].end == count);
        continue;
      }
      const Part &last = list[0], &first = list[1];  // in the order of blocks
      CHECK(first.block == last.block + 1);          // whose flag the other waits for
      CHECK(first.begin == 0);
      CHECK(first.started == 0);
      CHECK(first.end == last.begin);
      CHECK(last.end == count);
      CHECK(last.started + 1 >= first.end);  // no wait, but for rounding
    }
  }
}

TEST_CASE("65,536 chains on an H200 take 3.88 rounds where whole groups took 4") {
  ChainShare share(1024, 1000, 3, 264);
  std::uint64_t taken = 0;
  while (!share.done()) {
    const ChainStretch s = share.next();
    taken += s.end - s.begin;
  }
  CHECK(taken <= 3879);
}
