// The original study's fixed bin: its input file, its geometry, how its runs end.
#include <cmath>
#include <sstream>

#include "base/files/file.h"
#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/lab/original.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/vehicles.h"

namespace gonogo::lab {

namespace {

using test::agrees;

/// A bin just as long as a HMMWV and grains far too large for it, so that a run is short.
OriginalRequest short_run(double slope_deg, double friction) {
  OriginalRequest r;
  r.input = {.slope = to_radians(slope_deg), .radius = 0.1, .density = 2500, .friction = friction, .cohesion = 0};
  r.bin.half_length = 4;
  r.bin.half_width = 1.4;
  r.time.start_x = -0.8;
  r.time.goal_x = -0.2;
  r.time.lost_x = -1.2;
  r.time.end = 3;
  r.time.step = 2e-3;
  return r;
}

}  // namespace

TEST_CASE("a line of the original study's input file is five numbers in its units") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "runs.txt",
                        "0 4 1500 0.2 100\n12.5\t8.25  2750.5 0.6 1000\n30 10 3000 1.0\n5 x 2000 0.5 9\n"
                        "5 6 2000 -0.5 9\n");
  const OriginalInput second = read_original_input(folder / "runs.txt", 2);
  CHECK(second.slope == Approx(0.2181661565));
  CHECK(second.radius == Approx(8.25e-3));
  CHECK(second.density == 2750.5);
  CHECK(second.friction == 0.6);
  CHECK(second.cohesion == Approx(1e6));
  const auto refuse = [&](int line, const char* words) {
    refused([&] { read_original_input(folder / "runs.txt", line); }, words);
  };
  refuse(3, "4 numbers");
  refuse(4, "\"x\" is not a number");
  refuse(5, "friction -0.5");
  refuse(6, "5 lines");
  refuse(0, "count from 1");
  refused([&] { read_original_input(folder / "none.txt", 1); }, "cannot be read");
}

TEST_CASE("layers of the original bin are as many as its program had for each radius") {
  const OriginalBin bin;
  CHECK(layer_count(bin, 0.004) == 8);
  CHECK(layer_count(bin, 0.006) == 8);
  CHECK(layer_count(bin, 0.008) == 6);
  CHECK(layer_count(bin, 0.010) == 5);
  CHECK(layer_count(bin, 0.030) == 4);
  // A third of a million grains of 10 mm.
  CHECK(agrees("grains of 10 mm, in millions", 0.33, 1e-6 * double(dropped_grains(bin, 0.01, 1).size()), 0.03));
}

TEST_CASE("a vehicle that falls through the floor of the original bin ends as its parabola does") {
  const auto end_of = [](double slope_deg) {
    OriginalRequest r = short_run(slope_deg, 0.5);
    r.bin.spread = 12;  // hardly a grain
    r.time.lost_x = -6;
    r.time.goal_x = 3.5;
    const OriginalRecord record = run_original(test::shipped_vehicle("hmmwv"), r);
    CHECK(record.sample.back().position.z < -2.5);
    return record.stop;
  };
  CHECK(end_of(5) == OriginalStop::max_time);  // 0.85 m/s2 for 3 s: 3.4 m behind its start
  CHECK(end_of(15) == OriginalStop::sliding_backward);
}

TEST_CASE("points of a Poisson disk keep their distance and leave no place for another") {
  const double half_x = 1.5, half_y = 0.7, apart = 0.05;
  const auto points = poisson_disk(half_x, half_y, apart, 5);
  double nearest = 1e9, loneliest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK((std::fabs(points[i].x) <= half_x && std::fabs(points[i].y) <= half_y));
    for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, length(points[i] - points[j]));
  }
  for (std::uint64_t k = 0; k < 3000; ++k) {
    const Vec3d p{half_x * (2 * random_unit(1, 1, k) - 1), half_y * (2 * random_unit(1, 2, k) - 1), 0};
    double distance = 1e9;
    for (const Vec3d& q : points) distance = std::min(distance, length(p - q));
    loneliest = std::max(loneliest, distance);
  }
  CHECK(nearest >= apart);
  CHECK(loneliest < 1.25 * apart);
  // Disks that leave no place at all reach 0.70 points per square of their distance (Gamito & Maddock, ACM Trans.
  // Graph. 29, 2009); 30 trials leave a tenth out.
  CHECK(agrees("points per square of the distance", 0.65, double(points.size()) * apart * apart / (4 * half_x * half_y),
               0.06));
}

TEST_CASE("a run of the original bin ends at its goal, or slides back, and its file says so") {
  const vehicle::Vehicle hmmwv = test::shipped_vehicle("hmmwv");
  const OriginalRecord level = run_original(hmmwv, short_run(0, 0.8));
  CHECK(level.stop == OriginalStop::max_x);
  const OriginalSample& first = level.sample.front();
  CHECK(first.time == Approx(0.25));
  CHECK(agrees("origin over the highest grain [m]", 0.6, first.position.z - level.surface, 1e-5));
  CHECK(agrees("x at the start [m]", -0.8, first.position.x, 1e-5));
  CHECK(level.sample.back().position.x >= -0.21);
  for (const OriginalSample& s : level.sample)
    CHECK(s.throttle == Approx(std::min(1.0, std::max(0.0, (s.time - 0.5) / 0.5))).margin(1e-9));
  const OriginalRecord steep = run_original(hmmwv, short_run(38, 0.1));
  CHECK(steep.stop == OriginalStop::sliding_backward);
  std::istringstream text(original_output(steep));
  std::string line, last;
  std::size_t lines = 0;
  for (; std::getline(text, line); ++lines) last = line;
  CHECK(lines == steep.sample.size() + 1);
  CHECK(last == "# Vehicle sliding backward");
}

}  // namespace gonogo::lab
