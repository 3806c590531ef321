#include "base/files/csv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"

namespace gonogo {

std::vector<TextLine> read_data_lines(const std::filesystem::path& file, const std::string& rows) {
  std::istringstream in(read_file(file));
  std::vector<TextLine> lines;
  std::string text;
  for (std::size_t number = 1; std::getline(in, text); ++number) {
    if (!text.empty() && text.back() == '\r') text.pop_back();
    const std::size_t first = text.find_first_not_of(" \t");
    if (first != std::string::npos && text[first] != '#') lines.push_back({number, text});
  }
  if (lines.empty()) throw InputError(file.string() + ": holds no " + rows);
  return lines;
}

namespace {

/// Text without byte order mark, with an end of its last line.
std::string whole_lines(const std::filesystem::path& file, std::string text) {
  if (text.rfind("\xff\xfe", 0) == 0 || text.rfind("\xfe\xff", 0) == 0)
    throw InputError(file.string() + ": is in UTF-16; save it as UTF-8");
  if (text.rfind("PK\x03\x04", 0) == 0)
    throw InputError(file.string() + ": is a ZIP archive, as .xlsx and .ods files are; save the table as CSV");
  if (text.find('\0') != std::string::npos)
    throw InputError(file.string() + ": holds bytes of value 0, which no text has; save it as UTF-8");
  if (text.rfind("\xef\xbb\xbf", 0) == 0) text.erase(0, 3);
  if (!text.empty() && text.back() != '\n') text += '\n';
  return text;
}

std::string without_blanks(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

class CsvReader {
 public:
  CsvReader(const std::filesystem::path& file, const std::string& text) : file_(file), text_(text) {}

  std::vector<CsvLine> records() {
    std::vector<CsvLine> list;
    skip_to_record();
    choose_separator();
    for (skip_to_record(); at_ < text_.size(); skip_to_record()) list.push_back(record());
    return list;
  }
  bool between_semicolons() const { return separator_ == ';'; }

 private:
  static bool is_end(char c) { return c == '\n' || c == '\r'; }
  /// Past the end of a line of any system.
  void pass_end() {
    at_ += text_[at_] == '\r' && text_[at_ + 1] == '\n' ? 2 : 1;
    ++line_;
  }
  /// Past blank lines and remarks.
  void skip_to_record() {
    while (at_ < text_.size()) {
      const std::size_t end = text_.find_first_of("\r\n", at_), first = text_.find_first_not_of(" \t", at_);
      if (first < end && text_[first] != '#') return;
      at_ = end;
      pass_end();
    }
  }
  void choose_separator() {
    const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::string header = text_.substr(at_, end - at_);
    if (header.size() == 5 && header.rfind("sep=", 0) == 0) {
      separator_ = header[4];
      at_ = end;
      pass_end();
      return;
    }
    std::array<std::size_t, 3> count{};
    bool quoted = false;
    for (const char c : header) {
      if (c == '"') quoted = !quoted;
      for (std::size_t k = 0; k < count.size(); ++k) count[k] += !quoted && c == kSeparators[k];
    }
    separator_ = kSeparators[std::size_t(std::max_element(count.begin(), count.end()) - count.begin())];
  }
  CsvLine record() {
    CsvLine record{.number = line_};
    for (;;) {
      record.cell.push_back(cell());
      if (!is_end(text_[at_])) {
        ++at_;
        continue;
      }
      pass_end();
      return record;
    }
  }
  /// The next cell; then at_ is at the separator or the end of the line.
  std::string cell() {
    const auto blank = [&](char c) { return (c == ' ' || c == '\t') && c != separator_; };
    std::size_t first = at_;
    while (blank(text_[first])) ++first;
    if (text_[first] != '"') {
      const std::size_t from = at_;
      while (text_[at_] != separator_ && !is_end(text_[at_])) ++at_;
      return without_blanks(text_.substr(from, at_ - from));
    }
    const std::size_t begun = line_;
    std::string value;
    for (at_ = first + 1;; ++at_) {
      if (at_ >= text_.size()) refuse_csv_line(file_, begun, "a quote begins and does not end");
      if (text_[at_] == '"' && text_[at_ + 1] != '"') break;
      if (text_[at_] == '"') ++at_;
      line_ += text_[at_] == '\n';
      value += text_[at_];
    }
    for (++at_; blank(text_[at_]);) ++at_;
    if (text_[at_] != separator_ && !is_end(text_[at_]))
      refuse_csv_line(file_, line_, "text follows a quote; double the quotes inside of a cell");
    return value;
  }

  static constexpr std::array<char, 3> kSeparators = {',', ';', '\t'};
  const std::filesystem::path& file_;
  const std::string& text_;
  std::size_t at_ = 0, line_ = 1;
  char separator_ = ',';
};

/// Where the decimal sign of a number such as -1,5 stands; npos in cells that are none.
std::size_t decimal_sign(const std::string& cell, char sign) {
  const std::size_t at = cell.find(sign);
  if (at == std::string::npos) return at;
  std::string number = cell;
  number[at] = '.';
  char* end = nullptr;
  std::strtod(number.c_str(), &end);
  return *end == '\0' && number.find(',') == std::string::npos ? at : std::string::npos;
}

/// Decimal commas become points, unless a number of the table has a point: then a comma parts thousands, or the file is
/// mixed, and the cell stays as it is.
void take_decimal_commas(std::vector<CsvLine>& lines) {
  for (const CsvLine& line : lines)
    for (const std::string& cell : line.cell)
      if (decimal_sign(cell, '.') != std::string::npos) return;
  for (CsvLine& line : lines)
    for (std::string& cell : line.cell)
      if (const std::size_t at = decimal_sign(cell, ','); at != std::string::npos) cell[at] = '.';
}

}  // namespace

std::vector<CsvLine> read_csv_lines(const std::filesystem::path& file, const std::string& rows) {
  return csv_lines(read_file(file), file, rows);
}

std::vector<CsvLine> csv_lines(const std::string& given, const std::filesystem::path& file, const std::string& rows) {
  const std::string text = whole_lines(file, given);
  CsvReader reader(file, text);
  std::vector<CsvLine> lines = reader.records();
  if (lines.empty()) throw InputError(file.string() + ": holds no " + rows);
  if (reader.between_semicolons()) take_decimal_commas(lines);
  std::vector<std::string>& header = lines.front().cell;
  if (header.size() > 1 && header.back().empty()) header.pop_back();
  for (CsvLine& line : lines)
    if (line.cell.size() == header.size() + 1 && line.cell.back().empty()) line.cell.pop_back();
  return lines;
}

bool is_missing(const std::string& cell) {
  for (const char* word : {"", "NA", "N/A", "NaN", "nan", "NULL", "null"})
    if (cell == word) return true;
  return false;
}

namespace {

bool needs_quotes(const std::string& cell) {
  return cell.find_first_of(",;\t\"\r\n") != std::string::npos || cell.rfind('#', 0) == 0 ||
         without_blanks(cell) != cell;
}

}  // namespace

std::string csv_row(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) row += ',';
    if (!needs_quotes(cell)) {
      row += cell;
      continue;
    }
    row += '"';
    for (const char c : cell) row += c == '"' ? std::string("\"\"") : std::string(1, c);
    row += '"';
  }
  return row;
}

void refuse_csv_line(const std::filesystem::path& file, std::size_t number, const std::string& what) {
  throw InputError(file.string() + ": line " + std::to_string(number) + ": " + what);
}

std::optional<double> cell_number(const std::string& cell) {
  const std::string text = without_blanks(cell);
  const bool has_plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  const auto value = parsed<double>(std::string_view(text).substr(has_plus));
  return value && std::isfinite(*value) ? value : std::nullopt;
}

double csv_number(const std::filesystem::path& file, std::size_t number, const std::string& cell) {
  const auto value = cell_number(cell);
  if (!value) refuse_csv_line(file, number, "\"" + cell + "\" is no number");
  return *value;
}

}  // namespace gonogo
