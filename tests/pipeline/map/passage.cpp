// Drives whose chance follows in closed form.
#include <omp.h>

#include <cmath>

#include "pipeline/map/region/rules.h"
#include "pipeline/map/route/passage.h"
#include "tests/pipeline/map/made_ground.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;
using test::index;

namespace {

/// P(go) is (friction angle - 10) / 40 below a slope of 20 degrees uphill, and 0 above; no-go is traction.
OutcomeModel made_model() {
  OutcomeModel model = test::AnalyticModel{}.outcome_model();
  model.sampled[index("slope_along")] = {-30, 30};
  model.sampled[index("slope_across")] = {-20, 20};
  model.probabilities = [](std::span<const double> points, std::span<double> result) {
    const std::size_t width = contract().variables.size(), outcomes = contract().outcomes.size();
    std::fill(result.begin(), result.end(), 0.0);
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const double* x = &points[i * width];
      const double p = x[index("slope_along")] > 20 ? 0 : (x[index("friction_angle")] - 10) / 40;
      result[i * outcomes + contract().outcome_index(Verdict::go, Reason::none)] = p;
      result[i * outcomes + contract().outcome_index(Verdict::no_go, Reason::traction)] = 1 - p;
    }
  };
  return model;
}

/// Everything but the friction angle is fixed.
WaySoil soil_of(const std::vector<double>& p_go) {
  WaySoil soil{.name = "made", .points = {}};
  for (const double p : p_go) {
    std::vector<double> x;
    for (const Variable& variable : contract().variables) x.push_back(variable.minimum);
    x[index("friction_angle")] = 10 + 40 * p;
    soil.points.push_back(x);
  }
  return soil;
}

std::vector<WayPiece> level_way(std::size_t count, double length) {
  std::vector<WayPiece> pieces;
  for (std::size_t i = 0; i < count; ++i)
    pieces.push_back({.begin = length * double(i), .end = length * double(i + 1), .column = int(10 * i)});
  return pieces;
}

PassageDoubt many_draws() {
  PassageDoubt doubt;
  doubt.draws = 4000;
  doubt.bed_share = 0;
  return doubt;
}

constexpr double kNear = 0.03;  // four standard errors of a share of 4,000 draws

}  // namespace

TEST_CASE("of pieces that are all alike the chance is that of one, and of beds that are all anew it is the product") {
  const OutcomeModel model = made_model();
  PassageDoubt doubt = many_draws();
  const PassageForecast alike = forecast_passage(level_way(50, 10), {soil_of({0.8})}, model, doubt);
  CHECK(alike.chance == Approx(0.8).margin(kNear));
  CHECK(alike.places == Approx(0.2).margin(kNear));  // one place, however many pieces
  for (const double stuck : alike.stuck) CHECK(stuck == Approx(0.2).margin(kNear));
  doubt.bed_share = 1;
  doubt.bed_length = 10;
  const PassageForecast anew = forecast_passage(level_way(6, 10), {soil_of({0.8})}, model, doubt);
  CHECK(anew.chance == Approx(std::pow(0.8, 6)).margin(kNear));
  for (const double stuck : anew.stuck) CHECK(stuck == Approx(0.2).margin(kNear));
}

TEST_CASE("a soil keeps its point along the way with the correlation that its length gives") {
  PassageDoubt doubt = many_draws();
  for (const double length : {50.0, 500.0, 1e9}) {
    doubt.soil_length = length;
    const double keeps = std::exp(-50 / length), good = 0.75;
    const PassageForecast drive = forecast_passage(level_way(12, 50), {soil_of({1, 1, 1, 0})}, made_model(), doubt);
    CHECK(drive.chance == Approx(good * std::pow(keeps + (1 - keeps) * good, 11)).margin(kNear));
    CHECK(drive.stuck.back() == Approx(0.25).margin(kNear));
  }
}

TEST_CASE("a drive takes the model or one of its members for the whole way") {
  OutcomeModel model = made_model();
  model.members.push_back([good = model.probabilities](std::span<const double> points, std::span<double> result) {
    good(points, result);
    for (double& p : result) p = 0;
    for (std::size_t i = 0; i < result.size(); i += contract().outcomes.size())
      result[i + contract().outcome_index(Verdict::no_go, Reason::sinkage)] = 1;
  });
  const PassageForecast drive = forecast_passage(level_way(20, 100), {soil_of({1})}, model, many_draws());
  CHECK(drive.chance == Approx(0.5).margin(kNear));
  REQUIRE(drive.weakest);
  CHECK(contract().outcomes[drive.weakest->outcome].reason == Reason::sinkage);
}

TEST_CASE("the weakest stretch is the steep one, with its reason, and errors of the heights make it doubtful") {
  std::vector<WayPiece> pieces = level_way(40, 10);
  for (std::size_t i = 20; i < 25; ++i) {
    pieces[i].rise_north = std::tan(22 * kDegree);  // the heading is north
    pieces[i].column = int(10 * i);
  }
  PassageDoubt doubt = many_draws();
  const PassageForecast sure = forecast_passage(pieces, {soil_of({1})}, made_model(), doubt);
  CHECK(sure.chance == 0);
  REQUIRE(sure.weakest);
  CHECK(sure.weakest->begin == 200);
  CHECK(sure.weakest->end == 250);
  CHECK(sure.weakest->stuck == 1);
  CHECK(contract().outcomes[sure.weakest->outcome].reason == Reason::traction);
  doubt.height_error = 1;
  for (std::size_t i = 20; i < 25; ++i) pieces[i].rise_north = i == 22 ? std::tan(18.25 * kDegree) : 0;
  const PassageForecast doubtful = forecast_passage(pieces, {soil_of({1})}, made_model(), doubt);
  // Stuck where the slope, rounded to half degrees, is above 20 degrees.
  const double deviation = std::sqrt(12.0) / 80;
  const double over = (std::tan(20.25 * kDegree) - std::tan(18.25 * kDegree)) / deviation;
  CHECK(doubtful.stuck[22] == Approx(0.5 * std::erfc(over / std::sqrt(2.0))).margin(kNear));
}

TEST_CASE("slopes on the way are those of the heading's formula") {
  for (std::uint64_t i = 0; i < 200; ++i) {
    const double slope = 40 * random_unit(1, 0, i), aspect = 360 * random_unit(1, 1, i);
    WayPiece piece;
    piece.heading = std::floor(360 * random_unit(1, 2, i));
    piece.rise_east = -std::tan(slope * kDegree) * std::sin(aspect * kDegree);
    piece.rise_north = -std::tan(slope * kDegree) * std::cos(aspect * kDegree);
    const BedSlopes expected = bed_slopes(slope, fall_line_angle(piece.heading, aspect));
    const SlopesOnWay found = slopes_on_way(piece);
    CHECK(to_degrees(std::atan(found.along)) == Approx(expected.along).margin(1e-9));
    CHECK(to_degrees(std::atan(found.across)) == Approx(expected.across).margin(1e-9));
  }
}

TEST_CASE("errors of neighbouring slopes are correlated as Horn's weights say, and alike points have alike rests") {
  constexpr int count = 20000;
  double square = 0, two_apart = 0, far = 0;
  for (std::uint64_t d = 0; d < count; ++d) {
    const auto at = [&](int column) { return gradient_noise(column, 7, 1, 10, 10, 3, d)[0]; };
    square += at(5) * at(5) / count;
    two_apart += at(5) * at(7) / count;
    far += at(5) * at(30) / count;
  }
  const double expected = 12.0 / (80 * 80);
  CHECK(square == Approx(expected).epsilon(0.04));
  CHECK(two_apart == Approx(-expected / 2).epsilon(0.06));
  CHECK(std::abs(far) < 0.03 * expected);
  const std::vector<Range> sampled = {{0, 10}, {5, 5}, {0, 2}};
  const std::uint64_t fields = count / 2;
  double same = 0, product = 0;
  for (std::uint64_t d = 0; d < fields; ++d) {
    const LikenessField field(sampled, 0.3, 4, d);
    const double a = field.at(std::vector<double>{2, 5, 1}), b = field.at(std::vector<double>{5, 5, 1.4});
    same += a * a / fields;
    product += a * b / fields;
  }
  const LikenessField field(sampled, 0.3, 4, 0);
  const auto joined =
      LikenessField::joined(field.waves(std::vector<double>{2, 5, NAN}), field.waves(std::vector<double>{NAN, NAN, 1}));
  CHECK(field.at(joined) == Approx(field.at(std::vector<double>{2, 5, 1})).epsilon(1e-12));
  const double distance2 = (0.3 * 0.3 + 0.2 * 0.2) / (0.3 * 0.3);
  CHECK(same == Approx(1).margin(0.06));
  CHECK(product == Approx(std::exp(-distance2 / 2)).margin(0.05));
}

TEST_CASE("a forecast has the same bits for any number of threads") {
  PassageDoubt doubt;
  doubt.height_error = 0.5;
  const auto forecast = [&](int threads) {
    omp_set_num_threads(threads);
    return forecast_passage(level_way(30, 40), {soil_of({0.9, 0.7, 1})}, made_model(), doubt);
  };
  const int usual = omp_get_max_threads();
  const PassageForecast one = forecast(1), four = forecast(4);
  omp_set_num_threads(usual);
  CHECK(one.chance == four.chance);
  CHECK(one.places == four.places);
  CHECK(one.stuck == four.stuck);
  CHECK(one.chance > 0.1);
  CHECK(one.chance < 0.95);
}
