// Contact dynamics: batches of worlds of bodies, contacts, joints and motors, on CPU or CUDA.
// Package component `sim`; link gonogo::sim, and gonogo::sim_io for VTK files and checkpoints.
#pragma once
#include "base/error.h"
#include "base/version.h"
#include "sim/io/checkpoint.h"
#include "sim/io/vtk_series.h"
#include "sim/scene/scene.h"
#include "sim/shape/meshes.h"
#include "sim/shape/sphere_cover.h"
#include "sim/simulation/simulation.h"
