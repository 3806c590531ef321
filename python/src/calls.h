// How Python calls the library: without the GIL, and so that Ctrl-C stops it.
#pragma once
#include <nanobind/nanobind.h>
#include <unistd.h>

#include <optional>

#include "base/cancel.h"
#include "base/error.h"

namespace gonogo::python {

/// Runs long work with the GIL released. On the main thread Ctrl-C sets the library's flag meanwhile, and the work
/// throws Cancelled, which Python sees as KeyboardInterrupt. Python runs signal handlers on its main thread alone.
template <class Work>
auto long_call(Work&& work) {
  std::optional<CancelScope> scope;
  if (getpid() == gettid()) scope.emplace();
  nanobind::gil_scoped_release released;
  return work();
}

}  // namespace gonogo::python
