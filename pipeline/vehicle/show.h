// `gonogo vehicle show`: what follows from a vehicle's file, for people and for programs.
#pragma once
#include <string>

#include "base/json/json.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::pipeline {

struct Report {
  Json json;         // keys carry their units
  std::string text;  // tables
};

Report show_vehicle(const vehicle::Vehicle& v);

/// printf into a string, at most 400 characters.
std::string line(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace gonogo::pipeline
