// `gonogo vehicle show|vci`: quantities derived from a vehicle's file, as text and JSON, and vehicle files by name.
#pragma once
#include <filesystem>
#include <string>

#include "base/format.h"
#include "base/json/json.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::inspect {

struct Report {
  Json json;         // keys carry their units
  std::string text;  // tables
};

Report show_vehicle(const vehicle::Vehicle& v);

/// Mobility index, vehicle cone index, and semi-empirical traction over soil strength. Throws InputError for vehicles
/// without an index, see vehicle::vehicle_index.
Report vehicle_cone_index(const vehicle::Vehicle& v);

/// `name`: a file, or the name of one in configs/vehicles below the current folder or beside the program. Throws
/// InputError with the known names.
std::filesystem::path vehicle_file(const std::string& name);

}  // namespace gonogo::inspect
