#include "base/parallel/for_each.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <new>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/parallel/team.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;

namespace {

struct CountVisit {
  View<Index> visits, total;
  void operator()(Index i) const {
    ++visits[i];
    atomic_increment(total[0]);
    atomic_raise(total[1], Index(1) << (i % 20));
  }
};

}  // namespace

TEST_CASE("a loop visits every index once with any number of threads") {
  for (const int threads : {0, 1, 2, 7})
    for (const Index count : {0, 1, kSerialBelow - 1, kSerialBelow, kSerialBelow + 1, 100003}) {
      Buffer<Index, Cpu> visits(count), total(2);
      for_each_index(Cpu{threads}, count, CountVisit{visits.view(), total.view()});
      INFO(threads << " threads, " << count << " indices");
      const std::vector<Index> seen = visits.download();
      CHECK(std::count(seen.begin(), seen.end(), 1) == count);
      CHECK(total.read(0) == count);
      CHECK(total.read(1) == (count >= 20 ? (1 << 20) - 1 : (1 << count) - 1));
    }
}

TEST_CASE("an exclusive scan is the running sum before each element, with the total behind") {
  test::Draw draw(5);
  for (const int count : {0, 1, 2, 1000}) {
    Buffer<Index, Cpu> in(count), out(count + 1);
    std::vector<Index> expected(count + 1, 0);
    for (int i = 0; i < count; ++i) {
      in.write(i, draw.below(9));
      expected[i + 1] = expected[i] + in.read(i);
    }
    ScanScratch<Cpu> scratch;
    exclusive_scan(Cpu{}, in.view(), out.view(), scratch);
    CHECK(out.download() == expected);
  }
}

TEST_CASE("a buffer keeps what it held when it grows, and new elements are zero") {
  Buffer<Index, Cpu> b;
  b.upload({1, 2, 3});
  b.resize(5);
  CHECK(b.download() == std::vector<Index>{1, 2, 3, 0, 0});
  b.fill_zero(2);
  CHECK(b.download() == std::vector<Index>{0, 0});
}

TEST_CASE("a loop of the host calls every index once and carries the first exception out") {
  for (const int threads : {1, 4}) {
    std::vector<int> calls(1000, 0);
    for_each_on_host(
        calls.size(), 7, [&](std::size_t i) { ++calls[i]; }, threads);
    CHECK(std::count(calls.begin(), calls.end(), 1) == 1000);
    const auto failing = [](std::size_t i) {
      if (i == 500) throw InputError("index 500");
    };
    CHECK_THROWS_AS(for_each_on_host(1000, 7, failing, threads), InputError);
    for_each_on_host(0, 7, failing, threads);
  }
}

TEST_CASE("threads of a loop make a value of their own each, and carry out what that throws") {
  for (const int threads : {1, 4}) {
    std::atomic<int> made = 0, sum = 0;
    const auto work = [&](const std::unique_ptr<int>& own, std::size_t i) { sum += *own * int(i); };
    for_each_with_own(
        1000, 7, [&] { return std::make_unique<int>(++made > 0 ? 2 : 0); }, work, threads);
    CHECK(sum == 2 * 499500);
    CHECK(made >= 1);
    CHECK(made <= threads);
    const auto failing = []() -> std::unique_ptr<int> { throw InputError("no value"); };
    CHECK_THROWS_AS(for_each_with_own(1000, 7, failing, work, threads), InputError);
  }
}

TEST_CASE("what a team of the host throws is carried out, and memory that it cannot have") {
  for (const int threads : {1, 4}) {
    const auto failing = [](LoneThread, Index i) {
      if (i == 5) throw InputError("team 5");
    };
    CHECK_THROWS_AS(for_each_team(Cpu{threads}, 10, failing), InputError);
    const auto nothing = [](LoneThread, Index, double*) {};
    const TeamShape too_large{.room = std::size_t(1) << 50};
    CHECK_THROWS_AS(for_each_team(Cpu{threads}, 10, too_large, nothing), std::bad_alloc);
  }
}
