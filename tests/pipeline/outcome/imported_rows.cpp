// Rows that an import writes: middles of bins, or values inside them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <sstream>

#include "base/files/file.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;

namespace {

constexpr double kSlope = 12.5;

/// Gray codes of four bins for each variable that varies, and small random weights.
learning::Model gray_model() { return random_machine({.hidden = 4, .code = "gray", .units = 2}); }

using Columns = std::map<std::string, std::vector<std::string>>;

Columns read_columns(const std::string& text) {
  std::istringstream lines(text);
  std::string line, cell;
  std::vector<std::string> names;
  Columns columns;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    for (std::size_t k = 0; std::getline(cells, cell, ','); ++k)
      if (names.size() <= k && columns[cell].empty())
        names.push_back(cell);
      else
        columns[names.at(k)].push_back(cell);
  }
  return columns;
}

/// Largest distance of the values' distribution function to that of the uniform one on [0, 1], times sqrt(count):
/// Kolmogorov's statistic, above 1.95 once in a thousand.
double kolmogorov(std::vector<double> x) {
  std::sort(x.begin(), x.end());
  double largest = 0;
  for (std::size_t n = 0; n < x.size(); ++n)
    largest = std::max({largest, double(n + 1) / double(x.size()) - x[n], x[n] - double(n) / double(x.size())});
  return largest * std::sqrt(double(x.size()));
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    ab += (a[n] - 0.5) * (b[n] - 0.5);
    aa += (a[n] - 0.5) * (a[n] - 0.5);
    bb += (b[n] - 0.5) * (b[n] - 0.5);
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace

TEST_CASE("values inside bins are uniform there, belong to the row's bins, and leave all else as it is") {
  const TemporaryFolder folder;
  const learning::Model model = gray_model();
  learning::write_model(folder.path() / "model.h5", model);
  ImportRequest import;
  import.problem = folder.path() / "problem.json";
  import.answer = folder.path() / "answer.json";
  import.rows = folder.path() / "rows.csv";
  export_problem(folder.path() / "model.h5", import.problem, {{"slope_along", kSlope}}, learning::Vartype::binary, {},
                 0.0);
  sample_problem(import.problem, import.answer, *learning::make_sampler("exact"),
                 {.reads = 3000, .seed = 4, .sweeps = 1});
  for (const Decoding decoding : {Decoding::weigh, Decoding::discard}) {
    INFO(decoding_name(decoding));
    import.decoding = decoding;
    const auto rows = [&](bool inside, std::uint64_t seed) {
      import.inside = inside;
      import.seed = seed;
      import_answer(import);
      return read_file(import.rows);
    };
    const std::string middles = rows(false, 7), inside = rows(true, 7);
    CHECK(rows(true, 7) == inside);
    const Columns at_middles = read_columns(middles), within = read_columns(inside);
    const std::size_t count = within.at("outcome").size();
    REQUIRE(count > 800);
    CHECK(at_middles.at("outcome") == within.at("outcome"));
    CHECK(at_middles.at("energy") == within.at("energy"));
    CHECK(at_middles.count("weight") == (decoding == Decoding::weigh ? 1 : 0));
    std::vector<std::vector<double>> places;  // [variable that varies][row], 0: lower end of the bin, 1: upper end
    for (const learning::Encoder& encoder : model.layout.encoders()) {
      INFO(encoder.name());
      std::vector<double> place;
      std::size_t foreign = 0;
      for (std::size_t n = 0; n < count; ++n) {
        const double middle = std::stod(at_middles.at(encoder.name())[n]), x = std::stod(within.at(encoder.name())[n]);
        if (encoder.name() == "slope_along") CHECK(x == kSlope);
        if (encoder.unit_count() == 0) CHECK(x == middle);
        const int bin = encoder.bin_of(middle);
        foreign += std::abs(x - encoder.value(bin)) > encoder.resolution(bin) * (1 + 1e-12);
        place.push_back(0.5 + 0.5 * (x - encoder.value(bin)) / encoder.resolution(bin));
      }
      CHECK(foreign == 0);
      if (encoder.unit_count() == 0 || encoder.name() == "slope_along") continue;
      CHECK(kolmogorov(place) < 1.95);
      places.push_back(std::move(place));
    }
    REQUIRE(places.size() == 6);
    double largest = 0;
    for (std::size_t a = 0; a < places.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) largest = std::max(largest, std::abs(correlation(places[a], places[b])));
    std::printf("%s: %zu rows, places in two bins correlated by %.3f at most\n", decoding_name(decoding).c_str(), count,
                largest);
    CHECK(largest < 4.5 / std::sqrt(double(count)));
    const Columns other = read_columns(rows(true, 8));
    CHECK(other.at("cohesion") != within.at("cohesion"));
  }
}
