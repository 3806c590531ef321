// Figures of maps at print quality: of one map, and of two compared. Independent of models and contracts.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/grid.h"

namespace gonogo::report {

/// A class of a panel, with its share of the area [0, 1].
struct FigureClass {
  int code = 0;
  std::string label, colour;  // "#rrggbb"
  double share = 0;
};

struct FigureStop {
  double value = 0;
  std::string colour;
};

/// P(go) of one soil over slope. NaN breaks the line.
struct FigureCurve {
  std::string label;
  std::vector<double> slope_deg, p_go;
};

struct MapFigure {
  std::string title, subtitle;
  std::vector<std::string> notes;              // below the panels, one line each
  terrain::MapGrid grid;                       // of the map, not of the picture
  terrain::Tile shade, verdict, reason, p_go;  // the picture's cells, all of one size; shade in [0, 1]
  std::vector<FigureClass> classes, reasons;   // in the order of the legend
  std::vector<FigureStop> p_go_ramp;           // increasing from 0 to 1
  std::vector<FigureCurve> curves;
  double area_km2 = 0;  // that the shares are of
  double go_threshold = 0.8, no_go_threshold = 0.5;
  double steepest_sampled_deg = 0;
};

/// Writes a PNG 2400 pixels wide. Throws DeviceError when it cannot be written.
void draw_map_figure(const std::filesystem::path& path, const MapFigure& figure);

// The figure of two maps compared: where each of them passes, the difference of P(go), and whether it exceeds the
// uncertainty of both. Independent of models and contracts.

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
