// Films of trials: the frames that are due, their captions, VTK files, videos; and that watching changes nothing.
#include "pipeline/inspect/trial_film.h"

#include <cairo.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "base/error.h"
#include "base/files/file.h"
#include "pipeline/report/figure/film.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/same_bits.h"
#include "tests/support/short_trial.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/vtp_file.h"

namespace gonogo::lab {
using namespace campaign;
using namespace inspect;
using namespace report;
using namespace campaign;

namespace {

namespace fs = std::filesystem;

FilmRequest small_film() {
  FilmRequest r;
  r.width = 480;
  r.height = 270;
  r.every = 0.05;
  r.threads = 2;
  return r;
}

FilmedTrial small_trial(double slope) { return {.title = "test", .slope_along = slope, .commanded_speed = 1.5}; }

TrialRecord filmed(const TrialSetup& setup, const DesignPoint& p, TrialFilm& film, std::vector<TrialSample>* samples) {
  TrialWatch watch;
  watch.start = [&] {
    film.start();
    if (samples) samples->clear();
  };
  if (samples) watch.sample = [samples](const TrialSample& s) { samples->push_back(s); };
  watch.frame = [&film](const TrialFrame& frame) { film.add(frame); };
  watch.frame_interval = 0.05;
  TrialRecord record = run_trial(setup, p, watch);
  film.finish(record);
  return record;
}

/// A PNG as cairo reads it; pixels 0xRRGGBB.
struct Png {
  explicit Png(const fs::path& path) : surface(cairo_image_surface_create_from_png(path.c_str())) {
    REQUIRE(cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS);
  }
  ~Png() { cairo_surface_destroy(surface); }
  Png(const Png&) = delete;
  Png& operator=(const Png&) = delete;
  int width() const { return cairo_image_surface_get_width(surface); }
  int height() const { return cairo_image_surface_get_height(surface); }
  std::uint32_t pixel(int x, int y) const {
    const unsigned char* row = cairo_image_surface_get_data(surface) + y * cairo_image_surface_get_stride(surface);
    return reinterpret_cast<const std::uint32_t*>(row)[x] & 0xffffff;
  }
  int count(std::uint32_t colour, int x0, int y0, int x1, int y1) const {
    int found = 0;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) found += pixel(x, y) == colour;
    return found;
  }
  cairo_surface_t* surface;
};

std::uint32_t verdict_colour(Verdict v) {
  return std::uint32_t(std::stoul(contract().info(v).colour.substr(1), nullptr, 16));
}

/// Share of the verdict's colour in the upper right corner.
int badge(const fs::path& path, Verdict v) { return Png(path).count(verdict_colour(v), 240, 0, 480, 30); }

int frames_in(const fs::path& folder) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) count += entry.path().extension() == ".png";
  return count;
}

/// Pixels left of the colour bar in the warm colour of grains: far more red than blue.
int grain_pixels(const fs::path& path) {
  const Png png(path);
  int found = 0;
  for (int y = 0; y < png.height(); ++y)
    for (int x = 0; x < 420; ++x) {
      const std::uint32_t p = png.pixel(x, y);
      found += int(p >> 16) - int(p & 0xff) > 35;
    }
  return found;
}

void write_script(const fs::path& path, const std::string& body) {
  std::ofstream(path) << "#!/bin/sh\n" << body;
  fs::permissions(path, fs::perms::owner_all);
}

/// Only this folder is searched for programs while it lives.
class SearchPath {
 public:
  explicit SearchPath(const fs::path& folder) : old_(std::getenv("PATH")) { ::setenv("PATH", folder.c_str(), 1); }
  ~SearchPath() { ::setenv("PATH", old_.c_str(), 1); }

 private:
  std::string old_;
};

}  // namespace

TEST_CASE("a filmed trial ends with the bits of one that nobody watches, and has a frame whenever one is due") {
  const TemporaryFolder folder;
  const TrialSetup setup = short_setup(0.25);
  const DesignPoint p = design_point(5, 34, 0.25);
  prepare_trials(setup, {&p, 1}, 1);
  FilmRequest request = small_film();
  request.picture = folder / "end.png";
  request.frames = folder / "frames";
  request.vtk = folder / "vtk";
  create_folder(request.frames);
  std::vector<TrialSample> samples;
  {
    TrialFilm film(request, small_trial(5));
    // Left over from a longer film: they must not be taken for frames of this one.
    write_file_atomically(request.frames / "frame_000008.png", "old");
    write_file_atomically(request.frames / "frame_000009.png", "old");
    const TrialRecord watched = filmed(setup, p, film, &samples), alone = run_trial(setup, p);
    CHECK(watched.verdict == alone.verdict);
    CHECK(test::same_bits(watched.measures, alone.measures));
    // 0.35 s of trial: frames at 0, 0.05, ... and one at the end, unless that is a multiple itself.
    const double end = samples.back().time;
    CHECK(end == Approx(0.35).margin(0.004));
    CHECK(film.frame_count() == 8);
    CHECK(badge(request.picture, watched.verdict) > 200);
    CHECK(badge(request.frames / "frame_000006.png", watched.verdict) == 0);
  }
  CHECK(frames_in(request.frames) == 8);
  CHECK(read_file(request.picture) == read_file(request.frames / "frame_000007.png"));
  CHECK(read_file(request.frames / "frame_000000.png") != read_file(request.frames / "frame_000003.png"));
  const Png png(request.picture);
  CHECK(png.width() == 480);
  CHECK(png.height() == 270);
  for (const char* kind : {"spheres", "surfaces", "contacts"}) {
    const auto frames = test::read_pvd(folder / ("vtk/" + std::string(kind) + ".pvd"));
    REQUIRE(frames.size() == 8);
    for (std::size_t k = 0; k < 7; ++k) CHECK(frames[k].first == Approx(0.05 * double(k)).margin(0.0011));
    CHECK(frames.back().first == Approx(samples.back().time).margin(1e-6));
  }
  // The wheel in the files is where the trial says it is.
  const auto last = test::read_vtp(folder / "vtk/surfaces_000007.vtp");
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < last.values("Points").size(); i += 3) {
    low = std::min(low, last.values("Points")[i]);
    high = std::max(high, last.values("Points")[i]);
  }
  CHECK((low + high) / 2 - 0.15 * setup.bed_length == Approx(samples.back().x).margin(1e-5));
}

TEST_CASE("two films of one trial have the same bytes, whatever the threads") {
  const TemporaryFolder folder;
  const TrialSetup setup = short_setup(0.25);
  const DesignPoint p = design_point(5, 34, 0.25);
  prepare_trials(setup, {&p, 1}, 1);
  for (const int threads : {1, 3}) {
    FilmRequest request = small_film();
    request.picture = folder / (std::to_string(threads) + ".png");
    request.threads = threads;
    TrialFilm film(request, small_trial(5));
    filmed(setup, p, film, nullptr);
  }
  CHECK(read_file(folder / "1.png") == read_file(folder / "3.png"));
}

TEST_CASE("a raised camera shows more of the ground") {
  const TemporaryFolder folder;
  const TrialSetup setup = short_setup(0.1);
  const DesignPoint p = design_point(5, 34, 0.25);
  prepare_trials(setup, {&p, 1}, 1);
  const auto shown = [&](double elevation) {
    FilmRequest request = small_film();
    request.picture = folder / "end.png";
    FilmedTrial trial = small_trial(5);
    trial.elevation = elevation;
    TrialFilm film(request, trial);
    filmed(setup, p, film, nullptr);
    return grain_pixels(request.picture);
  };
  const int flat = shown(5), raised = shown(60);
  std::printf("pixels of grains: %d from 5 degrees, %d from 60\n", flat, raised);
  CHECK(flat > 100);
  CHECK(raised > 1.5 * flat);
}

TEST_CASE("a trial that was repeated is shown as it was the second time") {
  const TemporaryFolder folder;
  TrialSetup setup = short_setup(0.25);
  setup.thresholds.residual = 1e-9;  // no run can meet it
  const DesignPoint p = design_point(5, 34, 0.25);
  prepare_trials(setup, {&p, 1}, 1);
  FilmRequest request = small_film();
  request.frames = folder / "frames";
  std::vector<TrialSample> samples;
  TrialFilm film(request, small_trial(5));
  const TrialRecord record = filmed(setup, p, film, &samples);
  CHECK(record.attempts == 2);
  CHECK(samples[1].time - samples[0].time == Approx(setup.numerics.step / 2));
  CHECK(film.frame_count() == 8);
  CHECK(frames_in(request.frames) == 8);
  CHECK(badge(request.frames / "frame_000007.png", Verdict::unknown) > 200);
}

TEST_CASE("a slope that fails by itself is shown without a wheel") {
  const TemporaryFolder folder;
  const TrialSetup setup = short_setup(0.25);
  const DesignPoint p = design_point(44, 18, 0.25);
  prepare_trials(setup, {&p, 1}, 1);
  FilmRequest request = small_film();
  request.picture = folder / "end.png";
  request.vtk = folder / "vtk";
  TrialFilm film(request, small_trial(44));
  const TrialRecord record = filmed(setup, p, film, nullptr);
  CHECK(record.reason == Reason::slope_unstable);
  CHECK(badge(request.picture, Verdict::no_go) > 200);
  CHECK(test::read_vtp(folder / "vtk/surfaces_000000.vtp").points == 0);
  CHECK(test::read_vtp(folder / "vtk/spheres_000000.vtp").points > 100);
}

TEST_CASE("a video is made of all frames by ffmpeg, whole or not at all") {
  const TemporaryFolder folder, programs;
  const SearchPath path(programs.path());
  create_folder(folder / "frames");
  refused([] { require_ffmpeg(); }, "apt-get install ffmpeg");
  FilmRequest request = small_film();
  request.video = folder / "out.mp4";
  refused([&] { check_film(request); }, "ffmpeg");

  // A stand-in that writes down what it was asked.
  write_script(programs / "ffmpeg", "for last; do :; done\necho \"$@\" > \"$last\"\n");
  check_film(request);
  make_video(folder / "frames", 12, 50, request.video);
  const std::string asked = read_file(request.video);
  CHECK(contains(asked, "-framerate 50 "));
  CHECK(contains(asked, (folder / "frames/frame_%06d.png").string()));
  CHECK(contains(asked, "-frames:v 12 "));

  write_script(programs / "ffmpeg", "for last; do :; done\necho half > \"$last\"\necho 'no room' >&2\nexit 1\n");
  try {
    make_video(folder / "frames", 12, 50, request.video);
    FAIL("a failed program went unnoticed");
  } catch (const DeviceError& e) {
    CHECK(contains(e.what(), "no room"));
  }
  CHECK(read_file(request.video) == asked);  // the old one still stands
  CHECK(std::distance(fs::directory_iterator(folder.path()), {}) == 2);

  request.width = 481;
  refused([&] { check_film(request); }, "even");
  request.width = 10;
  refused([&] { check_film(request); }, "--size");
}

}  // namespace gonogo::lab
