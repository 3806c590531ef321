// Settled beds of grains, and soils whose friction angle and cohesion are calibrated.
// Package component `sim`; link gonogo::bed and gonogo::soil.
#pragma once
#include "base/error.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil/soil.h"
