#include "learning/qubo/text.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/format.h"

namespace gonogo::learning {

bool parse_number(std::string_view text, double& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  value = parsed<double>(text).value_or(NAN);
  return std::isfinite(value);
}

bool TextLines::next() {
  words_.clear();
  while (words_.empty()) {
    if (rest_.empty()) {
      line_ = {};
      return false;
    }
    const std::size_t end = rest_.find('\n');
    line_ = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view{} : rest_.substr(end + 1);
    if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
    ++number_;
    constexpr const char* spaces = " \t\f\v";
    for (std::size_t at = line_.find_first_not_of(spaces); at != std::string_view::npos;) {
      const std::size_t stop = std::min(line_.find_first_of(spaces, at), line_.size());
      words_.push_back(line_.substr(at, stop - at));
      at = line_.find_first_not_of(spaces, stop);
    }
  }
  return true;
}

std::int64_t TextLines::integer(std::size_t k, std::int64_t low, std::int64_t high) const {
  const auto value = parsed<std::int64_t>(words_.at(k));
  if (!value || *value < low || *value > high)
    fail("expected a whole number from " + std::to_string(low) + " to " + std::to_string(high) + ", found " +
         std::string(words_[k]));
  return *value;
}

double TextLines::number(std::size_t k) const {
  double value = 0;
  if (!parse_number(words_.at(k), value)) fail("expected a finite number, found " + std::string(words_[k]));
  return value;
}

void TextLines::expect_words(std::size_t count) const {
  if (words_.size() != count)
    fail(std::to_string(count) + " values belong on this line, found " + std::to_string(words_.size()));
}

void TextLines::fail(const std::string& message) const {
  throw InputError(source_ + ": line " + std::to_string(number_) + ": " + message);
}

Problem problem_from_entries(Vartype vartype, std::vector<std::int64_t> ids, const std::vector<Entry>& entries,
                             Repeats repeats, const std::string& source) {
  for (const Entry& e : entries) ids.insert(ids.end(), {e.i, e.j});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  const auto place = [&](std::int64_t id) {
    return std::uint32_t(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  Problem problem;
  problem.vartype = vartype;
  problem.labels.assign(ids.begin(), ids.end());
  problem.linear.assign(ids.size(), 0);
  std::vector<bool> has_linear(ids.size(), false);
  for (const Entry& e : entries) {
    const std::uint32_t a = place(std::min(e.i, e.j)), b = place(std::max(e.i, e.j));
    if (a != b) {
      problem.couplings.push_back({a, b, e.value});
      continue;
    }
    if (has_linear[a] && repeats == Repeats::refuse)
      throw InputError(source + ": the linear term of " + std::to_string(e.i) + " is given twice");
    has_linear[a] = true;
    problem.linear[a] += e.value;
  }
  auto& list = problem.couplings;
  sort_couplings(list);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (kept > 0 && list[kept - 1].a == list[k].a && list[kept - 1].b == list[k].b) {
      if (repeats == Repeats::refuse)
        throw InputError(source + ": the pair " + std::to_string(ids[list[k].a]) + ", " +
                         std::to_string(ids[list[k].b]) + " is given twice");
      list[kept - 1].value += list[k].value;
    } else {
      list[kept++] = list[k];
    }
  }
  list.resize(kept);
  check_problem(problem, source);
  return problem;
}

std::vector<std::int64_t> file_ids(const Problem& problem) {
  std::vector<std::int64_t> ids;
  for (const Label& label : problem.labels) {
    const auto* number = std::get_if<std::int64_t>(&label);
    if (!number || *number < 0 || *number > kMaxId) break;
    ids.push_back(*number);
  }
  if (ids.size() == problem.labels.size()) return ids;
  ids.resize(problem.labels.size());
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

std::vector<Entry> coupling_entries(const Problem& problem, const std::vector<std::int64_t>& ids) {
  std::vector<Entry> entries;
  for (const Coupling& c : problem.couplings)
    entries.push_back({std::min(ids[c.a], ids[c.b]), std::max(ids[c.a], ids[c.b]), c.value});
  std::sort(entries.begin(), entries.end(),
            [](const Entry& x, const Entry& y) { return std::pair(x.i, x.j) < std::pair(y.i, y.j); });
  return entries;
}

std::vector<std::size_t> by_id(const std::vector<std::int64_t>& ids) {
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return ids[x] < ids[y]; });
  return order;
}

namespace {

int digit_value(char c) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const char* found = c == 0 ? nullptr : std::strchr(kDigits, c);
  return found ? int(found - kDigits) : -1;
}

}  // namespace

std::string from_base64(std::string_view text, const std::string& where) {
  if (text.size() % 4 != 0)
    throw InputError(where + ": " + std::to_string(text.size()) +
                     " characters of base64; there must be a multiple of 4");
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (std::size_t at = 0; at < text.size(); at += 4) {
    const bool last = at + 4 == text.size();
    const int padding = !last ? 0 : text[at + 3] != '=' ? 0 : text[at + 2] != '=' ? 1 : 2;
    std::uint32_t group = 0;
    for (int k = 0; k < 4; ++k) {
      const int value = k >= 4 - padding ? 0 : digit_value(text[at + std::size_t(k)]);
      if (value < 0)
        throw InputError(where + ": character " + std::to_string(at + std::size_t(k)) + " is not one of base64");
      group = group << 6 | std::uint32_t(value);
    }
    for (int k = 0; k < 3 - padding; ++k) bytes += char(group >> (16 - 8 * k) & 255);
    if (padding > 0 && (group & ((1u << (8 * padding)) - 1)) != 0)
      throw InputError(where + ": the last character of the base64 text carries bits that belong nowhere");
  }
  return bytes;
}

}  // namespace gonogo::learning
