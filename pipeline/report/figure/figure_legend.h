// Palettes, legends and notes that the figures of maps share.
#pragma once
#include <string>
#include <vector>

#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/figure.h"
#include "pipeline/report/figure/figure_panel.h"

namespace gonogo::report {

inline constexpr int kFigureWidth = 2400;
inline constexpr double kFigureMargin = 60, kFigureHead = 240;  // of the page; the head holds title and subtitle
inline constexpr Colour kFrame = {0.13, 0.13, 0.16, 1};
inline constexpr Colour kNoValue = {0.80, 0.80, 0.84, 1};  // cells that have no value
inline constexpr float kMissing = -99;                     // below every ramp

Palette class_palette(const std::vector<FigureClass>& classes);
/// Colours between the stops; kNoValue below the first.
Palette ramp_palette(const std::vector<FigureStop>& ramp);
/// The bar of a ramp with five numbers beside it, and a swatch for cells without a value.
void draw_ramp(const Canvas& canvas, Box bar, const std::vector<FigureStop>& ramp);
/// Swatch, label and share, and the area where `area_km2` is given; long labels take more lines.
void draw_legend(const Canvas& canvas, Box room, const std::vector<FigureClass>& classes, double size,
                 double area_km2 = 0);

std::vector<std::string> wrapped_notes(const std::vector<std::string>& notes, double width);
void draw_notes(const Canvas& canvas, double left, double top, const std::vector<std::string>& lines);

/// kMissing where `there` is known and `value` is not: such cells are drawn, not left white like those without ground.
terrain::Tile marked_where_missing(terrain::Tile value, const terrain::Tile& there);

}  // namespace gonogo::report
