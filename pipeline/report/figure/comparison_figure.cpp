#include "pipeline/report/figure/comparison_figure.h"

#include <algorithm>

#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/figure_legend.h"
#include "pipeline/report/figure/figure_panel.h"

namespace gonogo::report {
namespace {

constexpr double kNoRelief = 0;

/// A small panel with its title above; returns the box of its map.
Box draw_side(const Canvas& canvas, const ComparisonFigure& figure, Box room, const std::string& title,
              const terrain::Tile& value, const Palette& palette) {
  constexpr double heading = 46, legend_width = 400;
  canvas.text(room.left, room.top + 28, title, 30, Align::left, true);
  const Box box =
      fit_panel(figure.grid, {room.left, room.top + heading, room.width - legend_width, room.height - heading});
  draw_cells(canvas, box, marked_where_missing(value, figure.change), figure.change, palette, kNoRelief);
  draw_coordinates(canvas, box, figure.grid, false);
  return box;
}

}  // namespace

void draw_comparison_figure(const std::filesystem::path& path, const ComparisonFigure& figure) {
  constexpr double map_left = kFigureMargin + 80, side_left = 1390, legend_height = 300;
  const Box map_box = fit_panel(figure.grid, {map_left, kFigureHead, side_left - map_left - 70, 1500});
  const double side_height = std::max(map_box.height, 760.0), lower_top = kFigureHead + side_height + 110;
  const std::vector<std::string> notes = wrapped_notes(figure.notes, kFigureWidth - 2 * kFigureMargin);
  const Canvas canvas(kFigureWidth, int(lower_top + legend_height + 90 + 30 * double(notes.size())));
  canvas.text(kFigureMargin, 88, figure.title, 56, Align::left, true);
  double y = 106;
  for (const std::string& line : canvas.wrapped(figure.subtitle, 34, kFigureWidth - 2 * kFigureMargin))
    canvas.text(kFigureMargin, y += 38, line, 34);
  draw_cells(canvas, map_box, figure.change, figure.change, class_palette(figure.changes), kNoRelief);
  draw_coordinates(canvas, map_box, figure.grid, true);
  draw_scale_and_north(canvas, map_box, figure.grid);
  const Box side = {side_left, kFigureHead - 46, kFigureWidth - kFigureMargin - side_left, (side_height + 6) / 2};
  const Box upper = draw_side(canvas, figure, side, "Difference of P(go), second minus first", figure.difference,
                              ramp_palette(figure.difference_ramp));
  draw_ramp(canvas, {upper.right() + 36, upper.top + 6, 42, std::clamp(upper.height - 80, 160.0, 300.0)},
            figure.difference_ramp);
  const Palette classes = class_palette(figure.difference_classes);
  const Box lower = draw_side(canvas, figure, {side.left, side.bottom() + 40, side.width, side.height},
                              "Is it more than both maps leave open?", figure.difference_class,
                              [=](float value) { return value == kMissing ? kNoValue : classes(value); });
  draw_legend(canvas, {lower.right() + 24, lower.top + 4, side.right() - lower.right() - 24, 0},
              figure.difference_classes, 22);
  canvas.text(kFigureMargin, lower_top + 34, "Which map passes, share of the area", 30, Align::left, true);
  draw_legend(canvas, {kFigureMargin, lower_top + 66, 1500, 0}, figure.changes, 30, figure.area_km2);
  draw_notes(canvas, kFigureMargin, lower_top + legend_height + 50, notes);
  canvas.write_png(path);
}

}  // namespace gonogo::report
