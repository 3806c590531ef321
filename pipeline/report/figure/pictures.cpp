#include "pipeline/report/figure/pictures.h"

#include "base/error.h"

namespace gonogo::report {

void require_pictures(const std::string& options) {
  if (!pictures_available())
    throw InputError("this build has no pictures (" + options + "); configure with -DGONOGO_PICTURES=ON");
}

}  // namespace gonogo::report
