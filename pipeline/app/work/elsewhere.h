// Work that this program does not hold. Three programs know the same commands: `gonogo` loads neither LibTorch nor
// GDAL, `gonogo-map` loads GDAL, `gonogo-learn` loads both. Whichever is asked for work of another one becomes that
// one.
#pragma once
#include <string>

#include "pipeline/app/work/result.h"

namespace gonogo::app {

/// Replaces this process by `program` with the same command line, streams, limits and process number. Throws Cancelled,
/// or DeviceError when the program is neither beside this one nor in the libexec folder of its installation.
[[noreturn]] void continue_in(const std::string& program, const Globals& globals);

/// In the place of a command's work: done by another program.
struct Elsewhere {
  const char* program;
  template <class Options>
  void operator()(const Globals& globals, const Options&) const {
    continue_in(program, globals);
  }
};

/// In the place of a command's work: left out of this build. Throws InputError that says which option brings it in.
struct LeftOut {
  const char* command;
  const char* option;  // of CMake
  template <class Options>
  void operator()(const Globals&, const Options&) const {
    throw InputError(std::string(command) + ": left out of this build (" + option + "=OFF); configure with -D" +
                     option + "=ON and build again");
  }
};

}  // namespace gonogo::app
