// Times Predictor::p_go, which gonogo.Model.predict is compared with: predict_speed <model.h5> <points.f64> <repeats>.
// The points are float64 [row, variable] in the contract's order. Prints the shortest processor time [s] and the sum of
// all P(go).
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/answer/infer.h"

namespace {

std::vector<double> read_points(const char* path) {
  const std::string bytes = gonogo::read_file(path);
  std::vector<double> points(bytes.size() / sizeof(double));
  std::memcpy(points.data(), bytes.data(), points.size() * sizeof(double));
  return points;
}

void time_predictions(const char* model, const char* points_file, int repeats) {
  const auto predictor = gonogo::outcome::Predictor::read(model);
  const std::vector<double> points = read_points(points_file);
  double best = 1e300, sum = 0;
  for (int k = 0; k < repeats; ++k) {
    const std::clock_t start = std::clock();
    std::vector<double> p(points.size() / gonogo::campaign::contract().variables.size());
    predictor.p_go(points, p);
    best = std::min(best, double(std::clock() - start) / CLOCKS_PER_SEC);
    sum = 0;
    for (const double x : p) sum += x;
  }
  std::printf("%.6f %.17g\n", best, sum);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("predict_speed <model.h5> <points.f64> <repeats>\n", stderr);
    return 2;
  }
  try {
    time_predictions(argv[1], argv[2], std::atoi(argv[3]));
  } catch (const gonogo::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
