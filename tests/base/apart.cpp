#include "base/apart.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace std::chrono_literals;

namespace {

/// Keeps the compiler from taking a value for known.
template <class T>
T hidden(T value) {
  static volatile T place;
  place = value;
  return place;
}

std::string endless() {
  while (hidden(1) == 1) {
  }
  return "";
}

std::size_t open_descriptors() {
  const std::filesystem::directory_iterator list("/proc/self/fd");
  return std::size_t(std::distance(begin(list), end(list)));
}

}  // namespace

TEST_CASE("apart: what the work returns comes back byte for byte, whatever its size") {
  for (const std::size_t size : {0u, 1u, 65'536u, 30'000'000u}) {
    std::string expected(size, '\0');
    for (std::size_t k = 0; k < size; ++k) expected[k] = char(k * 2654435761u >> 13);
    const ApartResult result = call_apart([&] { return expected; }, {});
    CHECK(result.end == ApartEnd::done);
    CHECK(result.refusal.empty());
    CHECK((result.bytes == expected));
  }
}

TEST_CASE("apart: the work changes nothing in this process") {
  int value = 1;
  call_apart([&] { return std::to_string(value = 2); }, {});
  CHECK(value == 1);
}

TEST_CASE("apart: crashes of every kind are told, without a word of the C library and without core files") {
  const std::size_t descriptors = open_descriptors();
  CHECK(call_apart([]() -> std::string { return std::string(1, *hidden<const char*>(nullptr)); }, {}).end ==
        ApartEnd::crashed);
  CHECK(call_apart([]() -> std::string { std::abort(); }, {}).end == ApartEnd::crashed);
  CHECK(call_apart([]() -> std::string { throw std::logic_error("a bug"); }, {}).end == ApartEnd::crashed);
  CHECK(call_apart([]() -> std::string { _exit(0); }, {}).end == ApartEnd::crashed);
  CHECK(call_apart(
            []() -> std::string {
              ::kill(::getpid(), SIGKILL);
              return "";
            },
            {})
            .end == ApartEnd::crashed);
  CHECK(open_descriptors() == descriptors);
}

TEST_CASE("apart: an InputError comes back as its message") {
  const ApartResult result = call_apart([]() -> std::string { throw InputError("a.h5: is bad"); }, {});
  CHECK(result.end == ApartEnd::done);
  CHECK(result.refusal == "a.h5: is bad");
}

TEST_CASE("apart: work without an end is ended at its limit") {
  const auto start = std::chrono::steady_clock::now();
  CHECK(call_apart(endless, {.time = 300ms}).end == ApartEnd::out_of_time);
  const auto took = std::chrono::steady_clock::now() - start;
  CHECK(took >= 300ms);
  CHECK(took < 5s);
}

TEST_CASE("apart: work that takes more memory than its limit is told") {
  const auto greedy = [] { return std::string(hidden(std::size_t(2) << 30), 'x').substr(0, 1); };
  CHECK(call_apart(greedy, {.memory = std::size_t(64) << 20}).end == ApartEnd::out_of_memory);
  CHECK(call_apart([] { return std::string(std::size_t(1) << 20, 'x'); }, {.memory = std::size_t(64) << 20}).end ==
        ApartEnd::done);
}

TEST_CASE("apart: it works while other threads take memory and run loops") {
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&] {
      while (!stop) std::vector<double>(1000).resize(100'000);
    });
  std::vector<double> sums(1000);
  for_each_on_host(sums.size(), 4, [&](std::size_t k) { sums[k] = double(k); });
  for (int k = 0; k < 200; ++k) {
    const ApartResult result = call_apart([&] { return std::to_string(k) + std::string(100'000, 'x'); }, {});
    REQUIRE(result.end == ApartEnd::done);
    REQUIRE(result.bytes.substr(0, result.bytes.find('x')) == std::to_string(k));
  }
  stop = true;
  for (std::thread& thread : threads) thread.join();
}

TEST_CASE("apart: Ctrl-C ends the work") {
  const CancelScope scope;
  std::thread([] {
    std::this_thread::sleep_for(200ms);
    ::kill(::getpid(), SIGINT);
  }).detach();
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_AS(call_apart(endless, {}), Cancelled);
  CHECK(std::chrono::steady_clock::now() - start < 5s);
}
