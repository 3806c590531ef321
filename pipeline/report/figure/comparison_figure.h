// The figure of two maps compared: where each of them passes, the difference of P(go), and whether it exceeds the
// uncertainty of both. Independent of models and contracts.
#pragma once
#include "pipeline/report/figure/figure.h"

namespace gonogo::report {

struct ComparisonFigure {
  std::string title, subtitle;
  std::vector<std::string> notes;                        // below the panels, one line each
  terrain::MapGrid grid;                                 // of the maps, not of the picture
  terrain::Tile change, difference, difference_class;    // the picture's cells, all of one size
  std::vector<FigureClass> changes, difference_classes;  // in the order of the legends
  std::vector<FigureStop> difference_ramp;               // increasing
  double area_km2 = 0;                                   // that the shares of `changes` are of
};

/// Writes a PNG 2400 pixels wide. Throws DeviceError when it cannot be written.
void draw_comparison_figure(const std::filesystem::path& path, const ComparisonFigure& figure);

}  // namespace gonogo::report
