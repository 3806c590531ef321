#include "pipeline/report/figure/canvas.h"

#include <png.h>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/units.h"

namespace gonogo::report {
namespace {

void choose_font(cairo_t* cairo, double size, bool bold) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, size);
}

}  // namespace

Colour colour_from(const std::string& hex, double alpha) {
  unsigned red = 0, green = 0, blue = 0;
  std::sscanf(hex.c_str(), "#%2x%2x%2x", &red, &green, &blue);
  return {red / 255.0, green / 255.0, blue / 255.0, alpha};
}

Canvas::Canvas(int width, int height)
    : width_(width),
      surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      cairo_(cairo_create(surface_)) {
  if (cairo_status(cairo_) != CAIRO_STATUS_SUCCESS)
    throw DeviceError(std::string("cairo cannot make a picture: ") + cairo_status_to_string(cairo_status(cairo_)));
  fill({0, 0, double(width), double(height)}, {1, 1, 1, 1});
}

Canvas::~Canvas() {
  cairo_destroy(cairo_);
  cairo_surface_destroy(surface_);
}

void Canvas::set(Colour c) const { cairo_set_source_rgba(cairo_, c.red, c.green, c.blue, c.alpha); }

void Canvas::fill(Box box, Colour colour) const {
  set(colour);
  cairo_rectangle(cairo_, box.left, box.top, box.width, box.height);
  cairo_fill(cairo_);
}

void Canvas::outline(Box box, Colour colour, double line_width) const {
  set(colour);
  cairo_set_line_width(cairo_, line_width);
  cairo_rectangle(cairo_, box.left, box.top, box.width, box.height);
  cairo_stroke(cairo_);
}

void Canvas::line(double x0, double y0, double x1, double y1, Colour colour, double line_width,
                  std::vector<double> dashes) const {
  set(colour);
  cairo_set_line_width(cairo_, line_width);
  cairo_set_dash(cairo_, dashes.data(), int(dashes.size()), 0);
  cairo_move_to(cairo_, x0, y0);
  cairo_line_to(cairo_, x1, y1);
  cairo_stroke(cairo_);
  cairo_set_dash(cairo_, nullptr, 0, 0);
}

void Canvas::hatch(Box box, Colour colour, double spacing) const {
  cairo_save(cairo_);
  cairo_rectangle(cairo_, box.left, box.top, box.width, box.height);
  cairo_clip(cairo_);
  for (double x = box.left - box.height; x < box.right(); x += spacing)
    line(x, box.bottom(), x + box.height, box.top, colour, 1.5);
  cairo_restore(cairo_);
}

double Canvas::text_width(const std::string& words, double size, bool bold) const {
  choose_font(cairo_, size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(cairo_, words.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(double x, double baseline, const std::string& words, double size, Align align, bool bold,
                  bool turned) const {
  const double width = text_width(words, size, bold);
  const double shift = align == Align::left ? 0 : align == Align::centre ? -width / 2 : -width;
  set(kFrame);
  cairo_save(cairo_);
  cairo_translate(cairo_, x, baseline);
  if (turned) cairo_rotate(cairo_, -kPi / 2);
  cairo_move_to(cairo_, shift, 0);
  cairo_show_text(cairo_, words.c_str());
  cairo_restore(cairo_);
}

std::vector<std::string> Canvas::wrapped(const std::string& words, double size, double width) const {
  std::vector<std::string> lines;
  std::istringstream in(words);
  std::string word, line;
  while (in >> word) {
    std::string longer = line;
    longer += (line.empty() ? "" : " ") + word;
    if (!line.empty() && text_width(longer, size) > width) {
      lines.push_back(line);
      line = word;
    } else {
      line = std::move(longer);
    }
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

namespace {

/// Red, green and blue of cairo's pixels, 32-bit numbers 0x00RRGGBB, row by row.
std::vector<png_byte> packed_pixels(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  const int width = cairo_image_surface_get_width(surface), height = cairo_image_surface_get_height(surface);
  const unsigned char* row = cairo_image_surface_get_data(surface);
  std::vector<png_byte> bytes(3 * std::size_t(width) * std::size_t(height));
  png_byte* out = bytes.data();
  for (int y = 0; y < height; ++y, row += cairo_image_surface_get_stride(surface)) {
    const auto* pixel = reinterpret_cast<const std::uint32_t*>(row);
    for (int x = 0; x < width; ++x)
      for (const int shift : {16, 8, 0}) *out++ = png_byte(pixel[x] >> shift);
  }
  return bytes;
}

}  // namespace

/// By libpng itself, fast: a quarter of the time of cairo's settings. Figures of maps are a fifth larger.
void Canvas::write_png(const std::filesystem::path& path) const {
  const std::vector<png_byte> pixels = packed_pixels(surface_);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(width_);
  image.height = png_uint_32(cairo_image_surface_get_height(surface_));
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;
  replace_file_atomically(path, [&](const std::filesystem::path& temporary) {
    if (!png_image_write_to_file(&image, temporary.c_str(), 0, pixels.data(), 0, nullptr))
      throw DeviceError(path.string() + ": cannot be written: " + image.message);
  });
}

std::vector<double> axis_ticks(double low, double high, int count) {
  if (!(high > low)) high = low + (low == 0 ? 1 : std::fabs(low));
  const double rough = (high - low) / count, power = std::pow(10, std::floor(std::log10(rough)));
  const double share = rough / power;
  const double step = power * (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10);
  std::vector<double> ticks;
  const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
  for (double k = first; k <= last; ++k) ticks.push_back(k * step);
  return ticks;
}

double tick_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 4)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (range / (factor * power) <= 8) return factor * power;
  return 10 * power;
}

}  // namespace gonogo::report
