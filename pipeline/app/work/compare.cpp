#include "pipeline/app/work/work.h"

namespace gonogo::app {

void compare_work(const Globals& globals, const map::CompareRequest& request) {
  map::CompareRequest asked = request;
  asked.threads = globals.threads;
  const Json result = map::compare_maps(asked);
  print_result(globals, result, map::compare_text(result));
}

}  // namespace gonogo::app
