// Input of the original study: a text file with one run per line, five numbers separated by white space,
//   slope [deg]   grain radius [mm]   grain density [kg/m^3]   friction [-]   cohesion [kPa]
#pragma once
#include <filesystem>

namespace gonogo::lab {

struct OriginalInput {
  double slope = 0;     // uphill [rad]
  double radius = 0;    // of the grains [m]
  double density = 0;   // of their solid [kg/m^3]
  double friction = 0;  // of grain on grain [-]
  double cohesion = 0;  // contact pressure p in the force pi r^2 p that holds a contact [Pa]
};

/// Line `line`, counted from 1. Throws InputError with file and line for a missing line, one without exactly five
/// numbers, and numbers out of range.
OriginalInput read_original_input(const std::filesystem::path& file, int line);

}  // namespace gonogo::lab
