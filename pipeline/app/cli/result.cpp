#include <cstdio>

#include "base/error.h"
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void print_result(const Globals& globals, const Json& result, const std::string& text) {
  std::string out = globals.json ? result.dump() : text;
  if (!out.empty() && out.back() != '\n') out += '\n';
  const bool written = std::fwrite(out.data(), 1, out.size(), stdout) == out.size();
  if (!written || std::fflush(stdout) != 0)
    throw DeviceError("standard output: cannot write the result (is the disk full?)");
}

}  // namespace gonogo::app
