#include "pipeline/report/figure/map_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include "base/format.h"
#include "base/units.h"
#include "pipeline/report/figure/canvas.h"

namespace gonogo::report {
namespace {

constexpr int kFigureWidth = 2400;
constexpr double kFigureMargin = 60, kFigureHead = 240;  // of the page; the head holds title and subtitle
constexpr Colour kNoValue = {0.80, 0.80, 0.84, 1};       // cells that have no value
constexpr float kMissing = -99;                          // below every ramp

/// Colour of a cell's value; called for values that are not nodata.
using Palette = std::function<Colour(float)>;

constexpr Colour kGridLine = {1, 1, 1, 0.45};

std::uint32_t packed(Colour c) {
  const auto byte = [](double x) { return std::uint32_t(255 * std::clamp(x, 0.0, 1.0) + 0.5); };
  return (byte(c.red) << 16) | (byte(c.green) << 8) | byte(c.blue);
}

/// Relief as a factor on the colour: 1 on flat ground under a light at 45 degrees (brightness 0.707), stretched because
/// most ground is far gentler than the light is low.
double relief_factor(float shade, double strength) {
  return std::isnan(shade) ? 1 : std::clamp(1 + strength * (shade - 0.7071), 0.72, 1.12);
}

std::string whole_number(double x) {
  std::string digits = line("%.0f", x);
  // Thin groups of three: coordinates have six and seven digits.
  for (int at = int(digits.size()) - 3; at > (digits[0] == '-' ? 1 : 0); at -= 3)
    digits.insert(std::size_t(at), "\u2009");
  return digits;
}

/// Round coordinates strictly inside (from, to).
std::vector<double> ticks(double from, double to, double step) {
  std::vector<double> at;
  for (double x = std::ceil(from / step) * step; x < to; x += step)
    if (x > from) at.push_back(x);
  return at;
}

/// 1, 2 or 5 times a power of ten, at most `limit`.
double round_length(double limit) {
  const double power = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= limit) return factor * power;
  return power;
}

/// Largest box of the grid's shape inside `room`, at its top left.
Box fit_panel(const terrain::MapGrid& grid, Box room) {
  const double shape = (grid.rows * grid.cell_height) / (grid.columns * grid.cell_width);
  const double width = std::min(room.width, room.height / shape);
  return {room.left, room.top, std::floor(width), std::floor(width * shape)};
}

/// Cells coloured by palette, darkened and lightened by the relief (0: not at all); nodata stays white.
void draw_cells(const Canvas& canvas, Box box, const terrain::Tile& value, const terrain::Tile& shade,
                const Palette& palette, double relief) {
  cairo_surface_t* image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, value.columns, value.rows);
  auto* pixels = cairo_image_surface_get_data(image);
  const int stride = cairo_image_surface_get_stride(image);
  for (int row = 0; row < value.rows; ++row) {
    auto* line = reinterpret_cast<std::uint32_t*>(pixels + std::ptrdiff_t(row) * stride);
    for (int column = 0; column < value.columns; ++column) {
      line[column] = 0xffffff;
      if (std::isnan(value.at(column, row))) continue;
      const Colour colour = palette(value.at(column, row));
      const double factor = relief_factor(shade.at(column, row), relief);
      line[column] = packed({colour.red * factor, colour.green * factor, colour.blue * factor, 1});
    }
  }
  cairo_surface_mark_dirty(image);
  cairo_t* cairo = canvas.cairo();
  cairo_save(cairo);
  cairo_translate(cairo, box.left, box.top);
  cairo_scale(cairo, box.width / value.columns, box.height / value.rows);
  cairo_set_source_surface(cairo, image, 0, 0);
  // Enlarged cells keep their edges and classes their colours; reduced ones are averaged.
  cairo_pattern_set_filter(cairo_get_source(cairo),
                           box.width >= value.columns ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_paint(cairo);
  cairo_restore(cairo);
  cairo_surface_destroy(image);
}

/// Frame and grid lines at round coordinates, every panel the same; with numbers and axis titles where `labelled`.
void draw_coordinates(const Canvas& canvas, Box box, const terrain::MapGrid& grid, bool labelled) {
  const double east_span = grid.columns * grid.cell_width, north_span = grid.rows * grid.cell_height;
  const double step = round_length(std::max(east_span, north_span) / 3.5);
  constexpr double size = 24;
  for (const double x : ticks(grid.west, grid.west + east_span, step)) {
    const double at = box.left + (x - grid.west) / east_span * box.width;
    canvas.line(at, box.top, at, box.bottom(), kGridLine, 2);
    canvas.line(at, box.bottom(), at, box.bottom() + 10, kFrame, 2);
    if (labelled) canvas.text(at, box.bottom() + 38, whole_number(x), size, Align::centre);
  }
  for (const double y : ticks(grid.north - north_span, grid.north, step)) {
    const double at = box.top + (grid.north - y) / north_span * box.height;
    canvas.line(box.left, at, box.right(), at, kGridLine, 2);
    canvas.line(box.left - 10, at, box.left, at, kFrame, 2);
    if (labelled) canvas.text(box.left - 18, at, whole_number(y), size, Align::centre, false, true);
  }
  canvas.outline(box, kFrame, 2.5);
  if (!labelled) return;
  const std::string system = grid.crs_code.empty() ? grid.crs_name : grid.crs_name + ", " + grid.crs_code;
  const std::string unit = grid.unit_name == "metre" ? "m" : grid.unit_name;
  const std::string easting = "easting [" + unit + "],  " + system;
  canvas.text(box.left + std::max(box.width, canvas.text_width(easting, size)) / 2, box.bottom() + 76, easting, size,
              Align::centre);
  canvas.text(box.left - 56, box.top + box.height / 2, "northing [" + unit + "]", size, Align::centre, false, true);
}

/// A bar of a round length in the lower left corner, with an arrow to grid north beside it.
void draw_scale_and_north(const Canvas& canvas, Box box, const terrain::MapGrid& grid) {
  const double metres_per_pixel = grid.columns * grid.cell_width_m() / box.width;
  const double length_m = round_length(std::max(box.width * 0.28, 260.0) * metres_per_pixel);
  const double length = length_m / metres_per_pixel;
  // Beside the map where it would hide half of it.
  const bool inside = length + 170 < 0.6 * box.width;
  const Box plate = {inside ? box.left + 20 : box.right() + 20, box.bottom() - 110, length + 150, 90};
  canvas.fill(plate, {1, 1, 1, 0.86});
  canvas.outline(plate, {0.5, 0.5, 0.55, 1}, 1.5);
  const double left = plate.left + 28, top = plate.bottom() - 34;
  for (int part = 0; part < 4; ++part)
    canvas.fill({left + part * length / 4, top, length / 4, 12}, part % 2 ? Colour{1, 1, 1, 1} : kFrame);
  canvas.outline({left, top, length, 12}, kFrame, 2);
  const bool kilometres = length_m >= 1000;
  const auto label = [&](double metres) { return line("%g", kilometres ? metres / 1000 : metres); };
  canvas.text(left, top - 12, "0", 24, Align::centre);
  if (length > 220) canvas.text(left + length / 2, top - 12, label(length_m / 2), 24, Align::centre);
  canvas.text(left + length, top - 12, label(length_m) + (kilometres ? " km" : " m"), 24, Align::centre);
  cairo_t* cairo = canvas.cairo();
  const double x = plate.right() - 38, y = plate.top + 12;
  canvas.set(kFrame);
  cairo_move_to(cairo, x, y);
  cairo_line_to(cairo, x - 14, y + 38);
  cairo_line_to(cairo, x, y + 30);
  cairo_line_to(cairo, x + 14, y + 38);
  cairo_close_path(cairo);
  cairo_fill(cairo);
  canvas.text(x, y + 66, "N", 26, Align::centre, true);
}

std::string percent(double share) { return line(share > 0 && share < 0.0005 ? "< 0.1 %%" : "%.1f %%", 100 * share); }

Colour between_stops(const std::vector<FigureStop>& ramp, double value) {
  for (std::size_t i = 1; i < ramp.size(); ++i) {
    if (value > ramp[i].value && i + 1 < ramp.size()) continue;
    const double t = std::clamp((value - ramp[i - 1].value) / (ramp[i].value - ramp[i - 1].value), 0.0, 1.0);
    const Colour a = colour_from(ramp[i - 1].colour), b = colour_from(ramp[i].colour);
    return {a.red + t * (b.red - a.red), a.green + t * (b.green - a.green), a.blue + t * (b.blue - a.blue), 1};
  }
  return kNoValue;
}

Palette class_palette(const std::vector<FigureClass>& classes) {
  std::array<Colour, 256> colours;
  colours.fill(kNoValue);
  for (const FigureClass& entry : classes) colours[std::size_t(entry.code)] = colour_from(entry.colour);
  return [colours](float value) { return colours[std::size_t(value)]; };
}

/// Colours between the stops; kNoValue below the first.
Palette ramp_palette(const std::vector<FigureStop>& ramp) {
  constexpr int steps = 1024;
  const double low = ramp.front().value, high = ramp.back().value;
  std::vector<Colour> colours;
  for (int i = 0; i <= steps; ++i) colours.push_back(between_stops(ramp, low + (high - low) * i / steps));
  return [=](float value) {
    return value < low ? kNoValue : colours[std::size_t(std::min(1.0, (value - low) / (high - low)) * steps)];
  };
}

/// The bar of a ramp with five numbers beside it, and a swatch for cells without a value.
void draw_ramp(const Canvas& canvas, Box bar, const std::vector<FigureStop>& ramp) {
  const Palette palette = ramp_palette(ramp);
  const int steps = int(bar.height);
  const double low = ramp.front().value, high = ramp.back().value;
  for (int i = 0; i < steps; ++i)
    canvas.fill({bar.left, bar.bottom() - (i + 1) * bar.height / steps, bar.width, bar.height / steps + 0.5},
                palette(float(low + (high - low) * (i + 0.5) / steps)));
  canvas.outline(bar, kFrame, 2);
  for (int k = 0; k <= 4; ++k) {
    const double y = bar.bottom() - k / 4.0 * bar.height;
    canvas.line(bar.right(), y, bar.right() + 8, y, kFrame, 2);
    canvas.text(bar.right() + 18, y + 9, line("%g", low + (high - low) * k / 4), 24);
  }
  canvas.fill({bar.left, bar.bottom() + 34, bar.width, 30}, kNoValue);
  canvas.outline({bar.left, bar.bottom() + 34, bar.width, 30}, kFrame, 1.5);
  canvas.text(bar.right() + 18, bar.bottom() + 58, "no value", 24);
}

/// With one decimal; a small area never reads as none.
std::string square_kilometres(double area) {
  if (area > 0 && area < 0.05) return "< 0.1 km\u00b2";
  return line("%.1f km\u00b2", area);
}

/// Swatch, label and share, and the area where `area_km2` is given; long labels take more lines.
void draw_legend(const Canvas& canvas, Box room, const std::vector<FigureClass>& classes, double size,
                 double area_km2 = 0) {
  const double numbers = canvas.text_width(area_km2 > 0 ? "100.0 %   10000.0 km\u00b2" : "100.0 %", size);
  double y = room.top;
  for (const FigureClass& entry : classes) {
    const Box swatch = {room.left, y, size * 1.6, size * 1.15};
    canvas.fill(swatch, colour_from(entry.colour));
    canvas.outline(swatch, kFrame, 1.5);
    const double label_left = swatch.right() + size * 0.6, baseline = y + size * 0.95;
    const double share_right =
        area_km2 > 0 ? room.right() - canvas.text_width("   10000.0 km\u00b2", size) : room.right();
    canvas.text(share_right, baseline, percent(entry.share), size, Align::right);
    if (area_km2 > 0)
      canvas.text(room.right(), baseline, square_kilometres(entry.share * area_km2), size, Align::right);
    const auto lines = canvas.wrapped(entry.label, size, room.right() - numbers - label_left);
    for (std::size_t i = 0; i < lines.size(); ++i)
      canvas.text(label_left, baseline + 1.2 * size * double(i), lines[i], size);
    y += size * (1.75 + 1.2 * double(lines.size() - 1));
  }
}

void draw_notes(const Canvas& canvas, double left, double top, const std::vector<std::string>& lines) {
  double y = top;
  for (const std::string& line : lines) canvas.text(left, y += 30, line, 21);
}

std::vector<std::string> wrapped_notes(const std::vector<std::string>& notes, double width) {
  const Canvas ruler(8, 8);
  std::vector<std::string> lines;
  for (const std::string& note : notes)
    for (const std::string& line : ruler.wrapped(note, 21, width)) lines.push_back(line);
  return lines;
}

/// kMissing where `there` is known and `value` is not: such cells are drawn, not left white like those without ground.
terrain::Tile marked_where_missing(terrain::Tile value, const terrain::Tile& there) {
  for (std::size_t i = 0; i < value.value.size(); ++i)
    if (std::isnan(value.value[i]) && !std::isnan(there.value[i])) value.value[i] = kMissing;
  return value;
}

constexpr double kSize = 24;  // of letters

struct LineStyle {
  const char* colour;
  std::vector<double> dashes;
};

/// Okabe and Ito's colours (jfly.uni-koeln.de/color) without the reddish ones; dashes tell lines apart that coincide.
const LineStyle& style_of(std::size_t curve) {
  static const std::array<LineStyle, 6> styles = {{{"#0072b2", {}},
                                                   {"#e69f00", {22, 12}},
                                                   {"#009e73", {8, 8}},
                                                   {"#56b4e9", {30, 8, 8, 8}},
                                                   {"#000000", {4, 8}},
                                                   {"#b8a800", {40, 14}}}};
  return styles[curve % styles.size()];
}

std::string label_of(double x) { return line("%g", x); }

struct Axes {
  Box box;
  double slope_end;  // [deg]
  double x(double slope_deg) const { return box.left + slope_deg / slope_end * box.width; }
  double y(double p) const { return box.bottom() - p * box.height; }
};

void draw_axes(const Canvas& canvas, const Axes& axes) {
  constexpr Colour faint = {0.85, 0.85, 0.88, 1};
  for (const double p : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0}) {
    canvas.line(axes.box.left, axes.y(p), axes.box.right(), axes.y(p), faint, 1.5);
    canvas.text(axes.box.left - 14, axes.y(p) + 9, label_of(p), kSize, Align::right);
  }
  for (double slope = 0; slope <= axes.slope_end; slope += 5) {
    canvas.line(axes.x(slope), axes.box.bottom(), axes.x(slope), axes.box.bottom() + 9, kFrame, 2);
    canvas.text(axes.x(slope), axes.box.bottom() + 36, label_of(slope) + "\u00b0", kSize, Align::centre);
  }
  for (const double grade : {0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0}) {
    const double slope = to_degrees(std::atan(grade / 100));
    if (slope > axes.slope_end) break;
    canvas.line(axes.x(slope), axes.box.top - 9, axes.x(slope), axes.box.top, kFrame, 2);
    canvas.text(axes.x(slope), axes.box.top - 18, label_of(grade) + " %", kSize, Align::centre);
  }
  canvas.text(axes.box.left - 78, axes.box.top + axes.box.height / 2, "P(go)", kSize, Align::centre, false, true);
  canvas.text(axes.box.left + axes.box.width / 2, axes.box.bottom() + 74,
              "uphill slope: degrees below, per cent grade above", kSize, Align::centre);
}

/// The name stands where no curve can be: beyond the steepest sampled slope.
void draw_threshold(const Canvas& canvas, const Axes& axes, double p, const std::string& name, double below) {
  canvas.line(axes.box.left, axes.y(p), axes.box.right(), axes.y(p), {0.3, 0.3, 0.34, 1}, 2, {4, 7});
  const double width = canvas.text_width(name, 20) + 12, top = axes.y(p) + below;
  canvas.fill({axes.box.right() - width - 4, top, width, 26}, {1, 1, 1, 1});
  canvas.text(axes.box.right() - 10, top + 20, name, 20, Align::right);
}

void draw_unsampled(const Canvas& canvas, const Axes& axes, double steepest) {
  if (steepest >= axes.slope_end) return;
  const Box box = {axes.x(steepest), axes.box.top, axes.box.right() - axes.x(steepest), axes.box.height};
  canvas.fill(box, {0.93, 0.93, 0.95, 1});
  canvas.hatch(box, {0.72, 0.72, 0.77, 1}, 18);
}

void draw_line(const Canvas& canvas, const Axes& axes, const FigureCurve& curve, const LineStyle& style) {
  cairo_t* cairo = canvas.cairo();
  canvas.set(colour_from(style.colour));
  cairo_set_line_width(cairo, 5);
  cairo_set_dash(cairo, style.dashes.data(), int(style.dashes.size()), 0);
  cairo_new_path(cairo);
  bool broken = true;
  for (std::size_t i = 0; i < curve.slope_deg.size(); ++i) {
    if (std::isnan(curve.p_go[i])) {
      broken = true;
      continue;
    }
    const double x = axes.x(curve.slope_deg[i]), y = axes.y(curve.p_go[i]);
    if (broken)
      cairo_move_to(cairo, x, y);
    else
      cairo_line_to(cairo, x, y);
    broken = false;
  }
  cairo_stroke(cairo);
  cairo_set_dash(cairo, nullptr, 0, 0);
}

/// P(go) against slope, one line per soil, with degrees below and per cent grade above. Draws axes, thresholds, curves
/// and their legend inside `room`, labels included.
void draw_curves(const Canvas& canvas, Box room, const MapFigure& figure) {
  double legend_width = 0;
  for (const FigureCurve& curve : figure.curves)
    legend_width = std::max(legend_width, canvas.text_width(curve.label, kSize));
  legend_width = std::max(legend_width, canvas.text_width("steeper than sampled", kSize)) + 120;
  const double end = std::max(10.0, 5 * std::ceil((figure.steepest_sampled_deg + 4) / 5));
  const Axes axes = {{room.left + 100, room.top + 50, room.width - 100 - legend_width, room.height - 50 - 90}, end};
  draw_axes(canvas, axes);
  draw_unsampled(canvas, axes, figure.steepest_sampled_deg);
  draw_threshold(canvas, axes, figure.go_threshold, "go", -30);
  draw_threshold(canvas, axes, figure.no_go_threshold, "no-go", 4);
  for (std::size_t c = figure.curves.size(); c-- > 0;) draw_line(canvas, axes, figure.curves[c], style_of(c));
  canvas.outline(axes.box, kFrame, 2.5);
  double y = axes.box.top + 20;
  for (std::size_t c = 0; c < figure.curves.size(); ++c, y += 42) {
    const LineStyle& style = style_of(c);
    canvas.line(axes.box.right() + 30, y, axes.box.right() + 98, y, colour_from(style.colour), 5, style.dashes);
    canvas.text(axes.box.right() + 114, y + 9, figure.curves[c].label, kSize);
  }
  const Box swatch = {axes.box.right() + 42, y - 13, 44, 28};
  canvas.fill(swatch, {0.93, 0.93, 0.95, 1});
  canvas.hatch(swatch, {0.72, 0.72, 0.77, 1}, 12);
  canvas.text(axes.box.right() + 114, y + 9, "steeper than sampled", kSize);
}

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
