#include "pipeline/report/figure/captioned.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/format.h"
#include "base/units.h"
#include "pipeline/report/figure/canvas.h"

namespace gonogo::report {
namespace {

/// Sizes are given for a picture 720 pixels high and grow with it.
constexpr double kDesignHeight = 720;
constexpr Colour kQuiet = {0.38, 0.39, 0.43, 1}, kRule = {0.72, 0.73, 0.76, 1}, kBright = {1, 1, 1, 1};

/// Copies the image into the canvas; cairo's RGB24 pixels are 32-bit numbers 0x00RRGGBB.
void put_image(const Canvas& canvas, const Image& image) {
  cairo_surface_t* surface = cairo_get_target(canvas.cairo());
  cairo_surface_flush(surface);
  unsigned char* pixels = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const std::uint8_t* rgb = &image.rgb[(std::size_t(row) * image.width + column) * 3];
      const std::uint32_t packed = std::uint32_t(rgb[0]) << 16 | std::uint32_t(rgb[1]) << 8 | rgb[2];
      std::memcpy(pixels + std::size_t(row) * stride + 4 * column, &packed, 4);
    }
  cairo_surface_mark_dirty(surface);
}

void rounded_box(const Canvas& canvas, Box b, double radius, Colour colour) {
  cairo_t* c = canvas.cairo();
  const double quarter = kPi / 2;
  canvas.set(colour);
  cairo_new_path(c);
  cairo_arc(c, b.right() - radius, b.top + radius, radius, -quarter, 0);
  cairo_arc(c, b.right() - radius, b.bottom() - radius, radius, 0, quarter);
  cairo_arc(c, b.left + radius, b.bottom() - radius, radius, quarter, 2 * quarter);
  cairo_arc(c, b.left + radius, b.top + radius, radius, 2 * quarter, 3 * quarter);
  cairo_close_path(c);
  cairo_fill(c);
}

/// Text in another colour than the canvas's ink.
void coloured_text(const Canvas& canvas, double x, double baseline, const std::string& words, double size,
                   Colour colour, bool bold) {
  canvas.text(-1e6, baseline, words, size, Align::left, bold);  // chooses the font
  canvas.set(colour);
  cairo_move_to(canvas.cairo(), x, baseline);
  cairo_show_text(canvas.cairo(), words.c_str());
}

void draw_badge(const Canvas& canvas, const Badge& badge, double right, double s) {
  if (badge.text.empty()) return;
  const double size = 20 * s, width = canvas.text_width(badge.text, size, true) + 32 * s;
  const Colour fill = colour_from(badge.colour);
  // Relative luminance decides between dark and bright letters.
  const bool bright = 0.2126 * fill.red + 0.7152 * fill.green + 0.0722 * fill.blue > 0.6;
  rounded_box(canvas, {right - width, 20 * s, width, 36 * s}, 8 * s, fill);
  coloured_text(canvas, right - width + 16 * s, 45 * s, badge.text, size, bright ? kFrame : kBright, true);
}

void draw_facts(const Canvas& canvas, const Caption& caption, double width, double height, double s) {
  const double margin = 32 * s, top = height - 66 * s;
  canvas.line(margin, top, width - margin, top, kRule, s);
  const double pitch = (width - 2 * margin) / double(std::max<std::size_t>(1, caption.facts.size()));
  for (std::size_t i = 0; i < caption.facts.size(); ++i) {
    const double x = margin + pitch * double(i);
    coloured_text(canvas, x, top + 22 * s, caption.facts[i].label, 14 * s, kQuiet, false);
    canvas.text(x, top + 48 * s, caption.facts[i].value, 20 * s, Align::left, true);
  }
}

void draw_bar(const Canvas& canvas, const Caption& caption, double width, double height, double s) {
  const int steps = int(caption.bar_rgb.size() / 3);
  if (steps == 0) return;
  const Box bar{width - 92 * s, 0.28 * height, 16 * s, 0.40 * height};
  for (int k = 0; k < steps; ++k) {
    const std::uint8_t* rgb = &caption.bar_rgb[3 * std::size_t(k)];
    canvas.fill({bar.left, bar.bottom() - (k + 1) * bar.height / steps, bar.width, bar.height / steps + 0.5},
                {rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0, 1});
  }
  canvas.outline(bar, kQuiet, s);
  const double range = caption.bar_high - caption.bar_low, step = tick_step(range);
  for (double at = std::ceil(caption.bar_low / step - 1e-9) * step; at <= caption.bar_high + 1e-9 * range; at += step) {
    const double y = bar.bottom() - (at - caption.bar_low) / range * bar.height;
    canvas.line(bar.right(), y, bar.right() + 5 * s, y, kQuiet, s);
    canvas.text(bar.right() + 9 * s, y + 5 * s, line("%.3g", std::fabs(at) < 1e-9 * range ? 0.0 : at), 14 * s);
  }
  canvas.text(bar.left - 10 * s, bar.top + bar.height / 2, caption.bar_label, 14 * s, Align::centre, false, true);
}

}  // namespace

bool pictures_available() { return true; }

void write_captioned(const std::filesystem::path& path, const Image& image, const Caption& caption) {
  const Canvas canvas(image.width, image.height);
  put_image(canvas, image);
  const double s = image.height / kDesignHeight, width = image.width, height = image.height;
  canvas.text(32 * s, 46 * s, caption.title, 22 * s, Align::left, true);
  draw_badge(canvas, caption.badge, width - 32 * s, s);
  draw_facts(canvas, caption, width, height, s);
  draw_bar(canvas, caption, width, height, s);
  canvas.write_png(path);
}

}  // namespace gonogo::report
