// Commands whose work needs LibTorch or GDAL. Three programs know the same commands: `gonogo` loads neither,
// `gonogo-map` loads GDAL, `gonogo-learn` both. Whichever is asked for work of another one becomes that one. The file
// of such a command is compiled twice: with its work for the program that does it, and with its table of options alone
// (GONOGO_TABLES_ONLY) for the others. There, nothing calls the work, and the compiler leaves it out.
#pragma once
#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

#ifdef GONOGO_TABLES_ONLY
constexpr bool kHoldsWork = false;
#else
constexpr bool kHoldsWork = true;
#endif

/// The option of CMake without which this build cannot do the work of the command; empty when it can.
std::string left_out_by(const CLI::App& command);

/// Replaces this process by the program that does the command's work, with the same command line, streams, limits and
/// process number. Throws Cancelled; InputError when the work was left out of this build; DeviceError when that program
/// is neither beside this one nor in the libexec folder of its installation.
[[noreturn]] void do_elsewhere(const CLI::App& command, const Globals& globals);

/// Calls Work(globals, options), or hands it to the program that does it.
template <auto Work, bool held = kHoldsWork, class Options>
void do_work(const CLI::App& command, const Globals& globals, const Options& options) {
  if constexpr (held)
    Work(globals, options);
  else
    do_elsewhere(command, globals);
}

/// The same when the command line has been parsed.
template <auto Work, bool held = kHoldsWork, class Options>
void calls(CLI::App& command, const Globals& globals, const std::shared_ptr<Options>& options) {
  command.callback([&command, &globals, options] { do_work<Work, held>(command, globals, *options); });
}

}  // namespace gonogo::app
