// Work in a child process, for libraries that crash or never end on damaged files.
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace gonogo {

/// How work in a child process ended.
enum class ApartEnd { done, crashed, out_of_time, out_of_memory };

struct ApartLimits {
  std::chrono::milliseconds time{10'000};     // by the clock
  std::size_t memory = std::size_t(4) << 30;  // [byte] beyond what this process has
};

struct ApartResult {
  ApartEnd end = ApartEnd::done;
  std::string bytes{};    // what the work returned
  std::string refusal{};  // the message of an InputError that it threw
};

/// Calls `work` in a fork of this process and returns what it returned. The child has the calling thread alone, writes
/// no core file, and ends with this process. Ctrl-C ends it and throws Cancelled. Other exceptions than InputError
/// count as a crash, std::bad_alloc as too little memory. Throws DeviceError when the system grants no child.
ApartResult call_apart(const std::function<std::string()>& work, const ApartLimits& limits);

}  // namespace gonogo
