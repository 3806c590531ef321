// Numbers as people read them in messages.
#pragma once
#include <string>

namespace gonogo {

/// Decimal text without trailing zeros: "0.09", "12.5", "1230", "-45". Decimals beyond `digits` significant digits are
/// rounded away; digits before the point are all kept. Below 1e-4 and from 1e7 on in size with an exponent: "2e-08".
/// NaN and infinities are "NaN", "infinity" and "-infinity".
std::string number_text(double x, int digits = 3);

}  // namespace gonogo
