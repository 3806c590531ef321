#include "pipeline/report/figure/figure.h"

#include <algorithm>

#include "pipeline/report/figure/canvas.h"
#include "pipeline/report/figure/figure_chart.h"
#include "pipeline/report/figure/figure_legend.h"
#include "pipeline/report/figure/figure_panel.h"

namespace gonogo::report {
namespace {

// Relief must not change what a colour means: weaker where colours are read against a ramp or a long legend.
constexpr double kMapRelief = 0.8, kSideRelief = 0.7;

void draw_side_panels(const Canvas& canvas, const MapFigure& figure, Box room) {
  constexpr double legend_width = 345, heading = 46;
  const double panel_height = (room.height - 2 * heading - 40) / 2;
  const Box p_box = fit_panel(figure.grid, {room.left, room.top + heading, room.width - legend_width, panel_height});
  canvas.text(room.left, room.top + 28, "P(go), probability of go or slow-go", 30, Align::left, true);
  draw_cells(canvas, p_box, marked_where_missing(figure.p_go, figure.verdict), figure.shade,
             ramp_palette(figure.p_go_ramp), kSideRelief);
  draw_coordinates(canvas, p_box, figure.grid, false);
  draw_ramp(canvas, {p_box.right() + 36, p_box.top + 6, 42, std::clamp(p_box.height - 80, 200.0, 300.0)},
            figure.p_go_ramp);
  const double second = room.bottom() - p_box.height;
  const Box reason_box = {room.left, second, p_box.width, p_box.height};
  canvas.text(room.left, second - 18, "Likeliest reason", 30, Align::left, true);
  draw_cells(canvas, reason_box, figure.reason, figure.shade, class_palette(figure.reasons), kSideRelief);
  draw_coordinates(canvas, reason_box, figure.grid, false);
  draw_legend(canvas, {reason_box.right() + 24, reason_box.top + 4, room.right() - reason_box.right() - 24, 0},
              figure.reasons, 20);
}

}  // namespace

void draw_map_figure(const std::filesystem::path& path, const MapFigure& figure) {
  constexpr double map_left = kFigureMargin + 80, side_left = 1430, lower_height = 480;
  const Box map_box = fit_panel(figure.grid, {map_left, kFigureHead, side_left - map_left - 70, 1500});
  const double side_height = std::max(map_box.height, 760.0);
  const double lower_top = kFigureHead + side_height + 110;
  const std::vector<std::string> notes = wrapped_notes(figure.notes, kFigureWidth - 2 * kFigureMargin);
  const Canvas canvas(kFigureWidth, int(lower_top + lower_height + 30 + 30 * double(notes.size()) + 40));
  canvas.text(kFigureMargin, 88, figure.title, 56, Align::left, true);
  canvas.text(kFigureMargin, 144, figure.subtitle, 34);
  draw_cells(canvas, map_box, figure.verdict, figure.shade, class_palette(figure.classes), kMapRelief);
  draw_coordinates(canvas, map_box, figure.grid, true);
  draw_scale_and_north(canvas, map_box, figure.grid);
  draw_side_panels(canvas, figure,
                   {side_left, kFigureHead - 46, kFigureWidth - kFigureMargin - side_left, side_height + 46});
  canvas.text(kFigureMargin, lower_top + 34, "Class and share of the area", 30, Align::left, true);
  draw_legend(canvas, {kFigureMargin, lower_top + 66, 600, 0}, figure.classes, 30, figure.area_km2);
  canvas.text(800, lower_top + 34, "P(go) over slope, by soil and its share of the area", 30, Align::left, true);
  draw_curves(canvas, {760, lower_top + 50, kFigureWidth - kFigureMargin - 760, lower_height - 50}, figure);
  draw_notes(canvas, kFigureMargin, lower_top + lower_height + 20, notes);
  canvas.write_png(path);
}

}  // namespace gonogo::report
