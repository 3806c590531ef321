// Vehicles from JSON files: whole ones and quarters, their bodies in a world, closed forms and cone index.
// Package component `sim`; link gonogo::vehicle.
#pragma once
#include "base/error.h"
#include "vehicle/model/statics.h"
#include "vehicle/model/vehicle.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/world/driving.h"
