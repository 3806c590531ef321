// Thin layer over cairo for the .cpp files of this folder: an image surface with text and boxes. Pixels, y downward.
#pragma once
#include <cairo.h>
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo::report {

struct Colour {
  double red = 0, green = 0, blue = 0, alpha = 1;  // [0, 1]
};

inline constexpr Colour kFrame = {0.13, 0.13, 0.16, 1};  // of frames, axes and letters

/// "#rrggbb"
Colour colour_from(const std::string& hex, double alpha = 1);

struct Box {
  double left = 0, top = 0, width = 0, height = 0;
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

enum class Align { left, centre, right };

class Canvas {
 public:
  Canvas(int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  cairo_t* cairo() const { return cairo_; }
  int width() const { return width_; }

  void set(Colour colour) const;
  void fill(Box box, Colour colour) const;
  void outline(Box box, Colour colour, double line_width) const;
  void line(double x0, double y0, double x1, double y1, Colour colour, double line_width,
            std::vector<double> dashes = {}) const;
  /// Diagonal hatching inside a box.
  void hatch(Box box, Colour colour, double spacing) const;

  /// `baseline` is where letters stand. `turned`: reading upward.
  void text(double x, double baseline, const std::string& words, double size, Align align = Align::left,
            bool bold = false, bool turned = false) const;
  double text_width(const std::string& words, double size, bool bold = false) const;
  /// Words broken into lines that fit.
  std::vector<std::string> wrapped(const std::string& words, double size, double width) const;

  /// Throws DeviceError.
  void write_png(const std::filesystem::path& path) const;

 private:
  int width_;
  cairo_surface_t* surface_;
  cairo_t* cairo_;
};

/// Round numbers that cover [low, high] in about `count` steps.
std::vector<double> axis_ticks(double low, double high, int count);

/// 1, 2 or 5 times a power of ten that divides `range` into four to eight steps.
double tick_step(double range);

}  // namespace gonogo::report
