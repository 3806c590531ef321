// `gonogo vehicle show`: quantities derived from a vehicle's file, as text and JSON.
#pragma once
#include <string>

#include "base/json/json.h"
#include "base/line.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::lab {

struct Report {
  Json json;         // keys carry their units
  std::string text;  // tables
};

Report show_vehicle(const vehicle::Vehicle& v);

}  // namespace gonogo::lab
