// Tables of text. Blank lines and lines that start with "#" count for nothing.
#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gonogo {

struct TextLine {
  std::size_t number = 0;  // in the file, from 1
  std::string text;        // without its end
};

/// Throws InputError for a file that cannot be read, and for one without lines: "<file>: holds no <rows>".
std::vector<TextLine> read_data_lines(const std::filesystem::path& file, const std::string& rows);

/// A record of a table of cells between separators.
struct CsvLine {
  std::size_t number = 0;           // of its first line in the file, from 1
  std::vector<std::string> cell{};  // without blanks around them unless in quotes
};

/// Records as RFC 4180 has them: cells in double quotes may hold separators, line ends and doubled quotes. The
/// separator is the most frequent of comma, semicolon and tab in the header, or what a first line "sep=;" says. A byte
/// order mark of UTF-8, line ends of any system, and one empty cell more than the header has are taken. Between
/// semicolons numbers may have a decimal comma, as where a comma is the decimal sign, unless any has a point; they come
/// back with a point. Throws InputError as read_data_lines() does, for UTF-16, ZIP archives (.xlsx) and bytes of value
/// 0, and for quotes that do not end or stand inside a cell.
std::vector<CsvLine> read_csv_lines(const std::filesystem::path& file, const std::string& rows);

/// The same for text that is in memory; `name` stands for the file in messages.
std::vector<CsvLine> csv_lines(const std::string& text, const std::filesystem::path& name, const std::string& rows);

/// Whether a cell says that its value is not known: empty, NA, N/A, NaN, NULL.
bool is_missing(const std::string& cell);

/// Cells as a record, in quotes where they need them, without a line end.
std::string csv_row(const std::vector<std::string>& cells);

/// Throws InputError "<file>: line <number>: <what>".
[[noreturn]] void refuse_csv_line(const std::filesystem::path& file, std::size_t number, const std::string& what);

/// The finite decimal number that all of a cell is, "+" before it or not; nothing for any other cell.
std::optional<double> cell_number(const std::string& cell);

/// The same. Throws InputError for any other cell.
double csv_number(const std::filesystem::path& file, std::size_t number, const std::string& cell);

}  // namespace gonogo
