// P(go) against slope, one line per soil, with degrees below and per cent grade above.
#pragma once
#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/figure.h"

namespace gonogo::report {

/// Draws axes, thresholds, curves and their legend inside `room`, labels included.
void draw_curves(const Canvas& canvas, Box room, const MapFigure& figure);

}  // namespace gonogo::report
