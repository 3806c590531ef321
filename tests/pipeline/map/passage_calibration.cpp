// Chance to get through against simulated long drives, by hand:
//
//   gonogo train --dataset data/quarter_wheel_32mm/dataset.h5 --study configs/studies/quarter_wheel_32mm.json
//       --hold-out 2000 --out out/half.h5
//   passage_calibration out/half.h5 data/quarter_wheel_32mm/dataset.h5 [<drives, 400> [all]]
//
// A drive is made of trials that the model never saw. Its ground is a soil and a mission, those of one such trial. Its
// pieces are the trials most like it, each for 200 m. Their slopes are the slopes of the way, and their outcomes say
// whether the drive got through. The forecast knows neither soil nor outcome: it is told a range for every variable
// that holds the ground somewhere, and slopes with an error. A planner leaves out pieces where the map's P(go) is too
// low. Likeness weighs a variable by what the model says that it matters; no outcome of these trials is used.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <set>

#include "base/error.h"
#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/route/passage.h"
#include "pipeline/outcome/answer/predictor.h"

using namespace gonogo;
using campaign::contract;

namespace {

constexpr double kPieceLength = 200, kHeightError = 0.5, kCell = 10;  // [m]
constexpr double kTold = 80;                                          // mean number of trials in what is told

struct Trial {
  std::vector<double> x;
  bool passed = false;
};

struct Case {
  map::OutcomeModel model;
  std::vector<Trial> trials;   // held out
  std::vector<double> weight;  // [variable] of a difference, in sampled ranges
  std::vector<double> told;    // [variable] width of what is told, in sampled ranges
};

double unit(std::uint64_t stream, std::uint64_t index) { return random_unit(20, stream, index); }

double width(const map::OutcomeModel& model, std::size_t v) {
  return model.sampled[v].maximum - model.sampled[v].minimum;
}

/// Mean over points, row by row.
double p_go(const map::OutcomeModel& model, const std::vector<double>& points) {
  const std::size_t count = points.size() / contract().variables.size(), outcomes = contract().outcomes.size();
  std::vector<double> answer(count * outcomes);
  model.probabilities(points, answer);
  double sum = 0;
  for (std::size_t i = 0; i < answer.size(); ++i)
    if (campaign::passes(contract().outcomes[i % outcomes].verdict)) sum += answer[i];
  return sum / double(count);
}

/// Root mean square change of P(go) when one variable moves over its range.
std::vector<double> sensitivity(const map::OutcomeModel& model) {
  const std::size_t count = model.sampled.size();
  std::vector<double> result(count, 0);
  for (std::uint64_t i = 0; i < 2000; ++i)
    for (std::size_t v = 0; v < count; ++v) {
      std::vector<double> x;
      for (std::size_t k = 0; k < count; ++k)
        x.push_back(model.sampled[k].minimum + unit(1, i * count + k) * width(model, k));
      const double before = p_go(model, x);
      x[v] = model.sampled[v].minimum + unit(2, i * count + v) * width(model, v);
      const double change = p_go(model, x) - before;
      result[v] += change * change / 2000;
    }
  for (double& r : result) r = std::sqrt(r);
  return result;
}

bool is_slope(std::size_t v) { return contract().variables[v].name.rfind("slope", 0) == 0; }

std::vector<double> told_widths(const Case& c);

Case read_case(const std::filesystem::path& model_file, const std::filesystem::path& dataset) {
  const auto predictor = std::make_shared<const outcome::Predictor>(outcome::Predictor::read(model_file));
  Case c;
  const std::size_t count = contract().variables.size();
  for (std::size_t v = 0; v < count; ++v)
    c.model.sampled.push_back({predictor->model().sampled_lower[v], predictor->model().sampled_upper[v]});
  c.model.probabilities = [predictor](std::span<const double> points, std::span<double> result) {
    predictor->outcome_probabilities(points, result);
  };
  std::set<std::vector<double>> seen;
  const auto& known = predictor->model().training_points;
  for (std::size_t i = 0; i < known.size(); i += count) seen.emplace(&known[i], &known[i] + count);
  for (const campaign::TrialRecord& record : campaign::read_dataset(dataset).records)
    if (record.verdict != campaign::Verdict::unknown && !seen.count(record.point.variables))
      c.trials.push_back({record.point.variables, campaign::passes(record.verdict)});
  c.weight = sensitivity(c.model);
  for (std::size_t v = 0; v < count; ++v)  // the mission is known better than the soil
    if (!is_slope(v) && contract().variables[v].source.rfind("soil table", 0) != 0) c.weight[v] *= 2;
  c.told = told_widths(c);
  return c;
}

/// Narrower for what matters more, so that about kTold trials lie inside.
std::vector<double> told_widths(const Case& c) {
  double low = 0, high = 100;
  std::vector<double> width(c.weight.size());
  for (int step = 0; step < 60; ++step) {
    const double scale = 0.5 * (low + high);
    double inside = double(c.trials.size());
    for (std::size_t v = 0; v < width.size(); ++v) {
      width[v] = is_slope(v) || c.weight[v] == 0 ? 1 : std::min(1.0, scale / c.weight[v]);
      inside *= width[v];
    }
    (inside < kTold ? low : high) = scale;
  }
  return width;
}

/// Over the variables that are no slopes.
double distance(const Case& c, const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t v = 0; v < a.size(); ++v)
    if (!is_slope(v) && width(c.model, v) > 0) sum += std::pow(c.weight[v] * (a[v] - b[v]) / width(c.model, v), 2);
  return sum;
}

/// A range of every variable that holds the true value somewhere, as equally likely points.
struct Told {
  std::vector<double> low, high;  // [variable]
  map::WaySoil soil;
};
Told told_soil(const Case& c, const std::vector<double>& truth, std::uint64_t drive) {
  const std::size_t count = truth.size();
  Told told_of{std::vector<double>(count), std::vector<double>(count), {.name = "told", .points = {}}};
  auto& [low, high, soil] = told_of;
  for (std::size_t v = 0; v < count; ++v) {
    const Range sampled = c.model.sampled[v];
    const double told = c.told[v] * width(c.model, v);
    const double first = std::max(sampled.minimum, truth[v] - told), last = std::min(sampled.maximum - told, truth[v]);
    low[v] = first + unit(3, drive * count + v) * (last - first);
    high[v] = low[v] + told;
  }
  for (std::uint64_t k = 0; k < 256; ++k) {
    std::vector<double> x(count);
    for (std::size_t v = 0; v < count; ++v)
      x[v] = is_slope(v) ? NAN : low[v] + unit(4, (drive * 256 + k) * count + v) * (high[v] - low[v]);
    soil.points.push_back(std::move(x));
  }
  return told_of;
}

bool is_inside(const Told& told, const std::vector<double>& x) {
  for (std::size_t v = 0; v < x.size(); ++v)
    if (!is_slope(v) && (x[v] < told.low[v] || x[v] > told.high[v])) return false;
  return true;
}

struct Drive {
  std::vector<map::WayPiece> pieces;
  map::WaySoil soil;
  bool got_through = true;
  double risk = 0;  // -ln P(go) of the pieces, summed
};

/// P(go) that a map gives: the mean over what the soil may be.
double map_p_go(const Case& c, const map::WaySoil& soil, double along, double across) {
  std::vector<double> points;
  for (std::size_t k = 0; k < soil.points.size(); k += 8) {
    std::vector<double> x = soil.points[k];
    x[contract().variable_index("slope_along")] = along;
    x[contract().variable_index("slope_across")] = across;
    points.insert(points.end(), x.begin(), x.end());
  }
  return p_go(c.model, points);
}

Drive make_drive(const Case& c, std::uint64_t number) {
  Drive drive;
  const std::vector<double> truth = c.trials[std::size_t(unit(5, number) * double(c.trials.size()))].x;
  const Told told = told_soil(c, truth, number);
  drive.soil = told.soil;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < c.trials.size(); ++i)
    if (is_inside(told, c.trials[i].x)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return distance(c, c.trials[a].x, truth) < distance(c, c.trials[b].x, truth);
  });
  const double caution = 0.3 + 0.68 * unit(6, number);
  const std::size_t most = 10 + std::size_t(unit(7, number) * 20);
  for (std::size_t k = 0; k < order.size() && drive.pieces.size() < most; ++k) {
    const Trial& trial = c.trials[order[k]];
    const int column = int(10 * k), row = int(number);
    const auto noise = map::gradient_noise(column, row, kHeightError, kCell, kCell, 77, 0);
    const double across = -std::tan(trial.x[contract().variable_index("slope_across")] * kDegree) + noise[0];
    const double along = std::tan(trial.x[contract().variable_index("slope_along")] * kDegree) + noise[1];
    const double p = map_p_go(c, drive.soil, to_degrees(std::atan(along)), to_degrees(std::atan(-across)));
    if (p < caution) continue;
    const double begin = kPieceLength * double(drive.pieces.size());
    drive.pieces.push_back({begin, begin + kPieceLength, 0, across, along, 0, column, row});
    drive.got_through = drive.got_through && trial.passed;
    drive.risk -= std::log(std::min(1.0, p));
  }
  return drive;
}

void print_table(const char* title, const std::vector<double>& forecast, const std::vector<Drive>& drives) {
  std::printf("%s\n  forecast      drives  mean forecast  got through  difference\n", title);
  for (int bin = 0; bin < 5; ++bin) {
    int count = 0, through = 0;
    double mean = 0;
    for (std::size_t i = 0; i < drives.size(); ++i) {
      if (std::min(4, int(forecast[i] * 5)) != bin) continue;
      ++count;
      through += drives[i].got_through;
      mean += forecast[i];
    }
    std::printf("  %.1f to %.1f    %6d", 0.2 * bin, 0.2 * (bin + 1), count);
    if (count > 0)
      std::printf("         %.3f        %.3f      %+.3f", mean / count, double(through) / count,
                  (mean - through) / count);
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) try {
  std::setvbuf(stdout, nullptr, _IOLBF, 1024);
  if (argc < 3) throw InputError("give a model trained with --hold-out, and its dataset");
  const Case c = read_case(argv[1], argv[2]);
  const std::size_t wanted = argc > 3 ? std::size_t(std::atoi(argv[3])) : 400;
  std::vector<Drive> drives;
  for (std::uint64_t number = 0; drives.size() < wanted && number < 20 * wanted; ++number) {
    Drive drive = make_drive(c, number);
    if (drive.pieces.size() >= 10) drives.push_back(std::move(drive));
  }
  std::printf("%zu trials held out, %zu drives\n", c.trials.size(), drives.size());
  for (std::size_t v = 0; v < c.weight.size(); ++v)
    std::printf("  %s: P(go) changes by %.3f, told within %.2f of its range\n", contract().variables[v].name.c_str(),
                c.weight[v], c.told[v]);
  for (const double length : {kPieceLength, 100.0, kCell}) {  // every so many metres P(go) counts anew
    std::vector<double> independent;
    for (const Drive& drive : drives) independent.push_back(std::exp(-drive.risk * kPieceLength / length));
    print_table(("independent every " + std::to_string(int(length)) + " m").c_str(), independent, drives);
  }
  const auto forecast_with = [&](double soil_length, double likeness) {
    map::PassageDoubt doubt;
    doubt.draws = 200;
    doubt.height_error = kHeightError;
    doubt.soil_length = soil_length;
    doubt.likeness = likeness;
    std::vector<double> forecast;
    for (const Drive& drive : drives)
      forecast.push_back(map::forecast_passage(drive.pieces, {drive.soil}, c.model, doubt).chance);
    char title[100];
    std::snprintf(title, sizeof title, "soil_length %g m, likeness %g", soil_length, likeness);
    print_table(title, forecast, drives);
  };
  const map::PassageDoubt defaults;
  forecast_with(kPieceLength, defaults.likeness);  // each piece has a soil of its own
  if (argc > 4) {
    forecast_with(defaults.soil_length, defaults.likeness);
    for (const double likeness : {0.1, 1.0}) forecast_with(kPieceLength, likeness);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
