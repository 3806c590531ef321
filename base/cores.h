// Threads of a program on this machine.
#pragma once
#include <algorithm>
#include <thread>

namespace gonogo {

/// `threads` where it is positive, otherwise all cores of this machine.
inline int threads_or_all(int threads) {
  return threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace gonogo
