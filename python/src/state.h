// States of bodies and contacts as Python gets them: memory that arrays of numpy look into.
#pragma once
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::python {

/// All bodies of a world at one time.
struct Bodies {
  std::vector<sim::BodyState> state;
};

/// All contacts of a world's latest step.
struct Contacts {
  std::vector<sim::Contact> contact;
  std::vector<sim::Impulse> impulse;
};

}  // namespace gonogo::python
