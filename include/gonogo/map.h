// Maps of a region from a model and rasters; ways over them.
// Package component `map`; link gonogo::map_request and gonogo::route.
#pragma once
#include "base/error.h"
#include "pipeline/map/map_request.h"
#include "pipeline/map/route/plan_route.h"
#include "pipeline/map/write/compare_maps.h"
#include "pipeline/map/write/make_map.h"
