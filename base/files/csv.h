// Tables of text: cells between commas. Blank lines and lines that start with "#" count for nothing.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace gonogo {

struct CsvLine {
  std::size_t number = 0;  // in the file, from 1
  std::string text;        // without its end
  /// Without blanks around them.
  std::vector<std::string> cells() const;
};

/// Throws InputError for a file that cannot be read, and for one without lines: "<file>: holds no <rows>".
std::vector<CsvLine> read_csv_lines(const std::filesystem::path& file, const std::string& rows);

/// Throws InputError "<file>: line <number>: <what>".
[[noreturn]] void refuse_csv_line(const std::filesystem::path& file, std::size_t number, const std::string& what);

/// A finite number. Throws InputError for any other cell.
double csv_number(const std::filesystem::path& file, std::size_t number, const std::string& cell);

}  // namespace gonogo
