// A vehicle file from the numbers that a data sheet has. What the sheet does not say is assumed, by a rule with a
// source.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "base/units.h"
#include "vehicle/family/tyre_size.h"

namespace gonogo::vehicle {

enum class Build { rigid, sprung };         // wheels fixed to the chassis, or on wishbones
enum class Power { wheel_motors, engine };  // a motor in every driven wheel, or one engine and differentials

/// Numbers of a data sheet. SI; what is optional has a rule in complete().
struct DataSheet {
  std::string name;
  double mass = 0;                   // of the loaded vehicle [kg]
  int axles = 2;                     // 2 to 4
  std::vector<double> wheelbase;     // between one axle and the next, from the front; or between the outer ones [m]
  double track = 0;                  // between the middles of left and right tyres [m]
  TyreSize tyre;                     // all wheels are alike
  std::optional<double> inflation;   // [Pa]
  std::optional<double> deflection;  // static, on hard ground [m]; 0: rigid
  std::optional<int> load_index;
  double power = 0;                     // at the engine or of all motors together [W]
  double top_speed = 0;                 // [m/s]
  double clearance = 0;                 // belly over the ground [m]
  std::optional<double> centre_height;  // of mass, over the ground [m]
  std::optional<double> centre_behind;  // of mass, behind the front axle [m]
  std::optional<double> tread_width;    // [m]
  std::optional<double> lug_height;     // 0: smooth [m]
  std::optional<int> lug_count;
  std::optional<double> lug_thickness;   // along the tread [m]
  std::optional<int> driven_axles;       // counted from the rear
  std::optional<double> tractive_force;  // largest, over weight
  std::optional<double> friction;        // of the tread on hard ground
  std::optional<double> ride_hz;         // natural frequency of the springs [Hz]
  std::optional<Build> build;
  std::optional<Power> drive;
  std::string differential = "open";  // of the axles of an engine: open or locked
  double gravity = kGravity;          // where springs carry it [m/s^2]
  std::vector<std::string> sources;
};

/// A file of the schema of configs/vehicles, and each assumption with its rule and source in a sentence.
struct VehicleFile {
  Json json;
  std::vector<std::string> assumed;
};

/// Throws InputError for numbers out of range, axles beyond four, wheels that overlap, clearances that are negative or
/// above the axles' tyres, and vehicles heavier than their tyres bear.
VehicleFile vehicle_file(const DataSheet& sheet);

}  // namespace gonogo::vehicle
