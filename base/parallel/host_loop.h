// The parallel loop of the host for work that may throw.
#pragma once
#include <omp.h>

#include <cstddef>
#include <optional>
#include <vector>

#include "base/parallel/for_each.h"
#include "base/progress.h"

namespace gonogo {

/// Calls work(i) for 0..count-1, `chunk` indices at a time on the next free thread. Throws what `work` threw first, and
/// Cancelled after Ctrl-C; no more work is begun then. `threads`: 0: all cores.
template <class Work>
void for_each_on_host(std::size_t count, std::size_t chunk, const Work& work, int threads = 0) {
  FirstError error;
  const auto step = std::ptrdiff_t(chunk);
#pragma omp parallel for schedule(dynamic, step) num_threads(threads > 0 ? threads : omp_get_max_threads())
  for (std::size_t i = 0; i < count; ++i)
    error.guard([&] {
      stop_if_cancelled();
      work(i);
    });
  error.rethrow();
}

/// The same for work(own, i), where each thread makes a value of its own by make() before its first index.
template <class Make, class Work>
void for_each_with_own(std::size_t count, std::size_t chunk, const Make& make, const Work& work, int threads = 0) {
  using Own = decltype(make());
  std::vector<std::optional<Own>> own(std::size_t(threads > 0 ? threads : omp_get_max_threads()));
  for_each_on_host(
      count, chunk,
      [&](std::size_t i) {
        std::optional<Own>& mine = own[std::size_t(omp_get_thread_num())];
        if (!mine) mine.emplace(make());
        work(*mine, i);
      },
      int(own.size()));
}

/// Chunk of loops whose indices are cheap, such as the cells of a raster.
inline constexpr std::size_t kCellsAtOnce = 8192;

}  // namespace gonogo
