// printf into a string: lines of reports and tables.
#pragma once
#include <cstdarg>
#include <cstdio>
#include <string>

namespace gonogo {

/// Cuts the text off after 400 characters.
__attribute__((format(printf, 1, 2))) inline std::string line(const char* format, ...) {
  char text[400];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

}  // namespace gonogo
