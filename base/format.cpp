#include "base/format.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gonogo {

std::string number_text(double x, int digits) {
  if (std::isnan(x)) return "NaN";
  if (std::isinf(x)) return x > 0 ? "infinity" : "-infinity";
  char text[64];
  const double size = std::fabs(x);
  if (size == 0) return "0";
  if (size < 1e-4 || size >= 1e7) {
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    return text;
  }
  const int decimals = std::max(0, digits - 1 - int(std::floor(std::log10(size))));
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  std::string plain = text;
  if (decimals > 0) plain.erase(plain.find_last_not_of('0') + 1);
  if (plain.back() == '.') plain.pop_back();
  return plain;
}

}  // namespace gonogo
