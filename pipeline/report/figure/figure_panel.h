// A map panel: an image of cells under relief, with frame, coordinates, scale bar and north arrow.
#pragma once
#include <functional>

#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/figure.h"

namespace gonogo::report {

/// Largest box of the grid's shape inside `room`, at its top left.
Box fit_panel(const terrain::MapGrid& grid, Box room);

/// Colour of a cell's value; called for values that are not nodata.
using Palette = std::function<Colour(float)>;

/// Cells coloured by palette, darkened and lightened by the relief (0: not at all); nodata stays white.
void draw_cells(const Canvas& canvas, Box box, const terrain::Tile& value, const terrain::Tile& shade,
                const Palette& palette, double relief);

/// Frame and grid lines at round coordinates, every panel the same; with numbers and axis titles where `labelled`.
void draw_coordinates(const Canvas& canvas, Box box, const terrain::MapGrid& grid, bool labelled);

/// A bar of a round length in the lower left corner, with an arrow to grid north beside it.
void draw_scale_and_north(const Canvas& canvas, Box box, const terrain::MapGrid& grid);

/// 1, 2 or 5 times a power of ten, at most `limit`.
double round_length(double limit);

}  // namespace gonogo::report
