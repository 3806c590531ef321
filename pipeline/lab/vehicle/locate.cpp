#include "pipeline/lab/vehicle/locate.h"

#include "base/shipped.h"

namespace gonogo::lab {

std::filesystem::path vehicle_file(const std::string& name) { return shipped_file("vehicles", "vehicle", name); }

}  // namespace gonogo::lab
