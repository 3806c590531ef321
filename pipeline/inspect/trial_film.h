// A trial as a film: its numbers along the foot of each frame, its verdict on the last.
#pragma once
#include <string>

#include "pipeline/campaign/trial/trial.h"
#include "pipeline/report/figure/film.h"

namespace gonogo::inspect {

/// What a film says of its trial.
struct FilmedTrial {
  std::string title = {};
  double slope_along = 0, slope_across = 0;  // [deg]
  double commanded_speed = 0;                // half of it is the upper end of the colour bar [m/s]
  double azimuth = 16, elevation = 13;       // of the camera [deg], see report::frame_model()
};

class TrialFilm {
 public:
  /// Throws InputError as report::check_film() does.
  TrialFilm(const report::FilmRequest& request, FilmedTrial trial);

  /// Call it at the start of each attempt: frames of an earlier one are dropped.
  void start() { film_.start(); }
  /// Writes the frame. Throws DeviceError.
  void add(const campaign::TrialFrame& frame);
  /// Draws the verdict on the last frame and writes picture and video. Throws DeviceError.
  void finish(const campaign::TrialRecord& record);

  int frame_count() const { return film_.frame_count(); }

 private:
  FilmedTrial trial_;
  report::Film film_;
};

}  // namespace gonogo::inspect
