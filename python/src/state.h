// States of bodies and contacts as Python gets them: memory that arrays look into. Vehicles that Python drives.
#pragma once
#include <memory>
#include <vector>

#include "sim/simulation/simulation.h"
#include "vehicle/model/driven_vehicle.h"

namespace gonogo::python {

/// All bodies of a world at one time.
struct Bodies {
  std::vector<sim::BodyState> state;
};

/// The same in memory of the device that simulates.
struct DeviceBodies {
  sim::BodiesOnDevice on;
};

/// All contacts of a world's latest step.
struct Contacts {
  std::vector<sim::Contact> contact;
  std::vector<sim::Impulse> impulse;
};

/// Numbers of a world's parts.
struct WorldParts {
  Index bodies = 0, motors = 0, controllers = 0, drivelines = 0;

  /// Whether everything of the smaller world exists here.
  bool holds(const WorldParts& o) const {
    return o.bodies <= bodies && o.motors <= motors && o.controllers <= controllers && o.drivelines <= drivelines;
  }
};

/// A vehicle in a world.
struct Driven {
  std::shared_ptr<vehicle::Vehicle> vehicle;  // `parts` points into it
  vehicle::DrivenVehicle parts;
  WorldParts world;  // when the vehicle had been added
};

}  // namespace gonogo::python
