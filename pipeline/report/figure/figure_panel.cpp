#include "pipeline/report/figure/figure_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace gonogo::report {

using terrain::MapGrid;
using terrain::Tile;
namespace {

constexpr Colour kFrame = {0.13, 0.13, 0.16, 1};
constexpr Colour kGridLine = {1, 1, 1, 0.45};

std::uint32_t packed(Colour c) {
  const auto byte = [](double x) { return std::uint32_t(std::lround(255 * std::clamp(x, 0.0, 1.0))); };
  return (byte(c.red) << 16) | (byte(c.green) << 8) | byte(c.blue);
}

/// Relief as a factor on the colour: 1 on flat ground under a light at 45 degrees (brightness 0.707), stretched because
/// most ground is far gentler than the light is low.
double relief_factor(float shade, double strength) {
  return std::isnan(shade) ? 1 : std::clamp(1 + strength * (shade - 0.7071), 0.72, 1.12);
}

std::string whole_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.0f", x);
  std::string digits = text;
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

}  // namespace

double round_length(double limit) {
  const double power = std::pow(10.0, std::floor(std::log10(limit)));
  for (const double factor : {5.0, 2.0})
    if (factor * power <= limit) return factor * power;
  return power;
}

Box fit_panel(const MapGrid& grid, Box room) {
  const double shape = (grid.rows * grid.cell_height) / (grid.columns * grid.cell_width);
  const double width = std::min(room.width, room.height / shape);
  return {room.left, room.top, std::floor(width), std::floor(width * shape)};
}

void draw_cells(const Canvas& canvas, Box box, const Tile& value, const Tile& shade, const Palette& palette,
                double relief) {
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

void draw_coordinates(const Canvas& canvas, Box box, const MapGrid& grid, bool labelled) {
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

void draw_scale_and_north(const Canvas& canvas, Box box, const MapGrid& grid) {
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
  const auto label = [&](double metres) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", kilometres ? metres / 1000 : metres);
    return std::string(text);
  };
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

}  // namespace gonogo::report
