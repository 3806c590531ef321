// Shows a trial: a picture of its end, a picture per interval, a video, VTK files for ParaView.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pipeline/campaign/trial/trial.h"
#include "pipeline/report/picture/camera.h"
#include "sim/io/vtk_series.h"

namespace gonogo::lab {

struct FilmRequest {
  std::filesystem::path picture;  // .png of the end; empty: not wanted, as for the others
  std::filesystem::path frames;   // folder of frame_000000.png, ...
  std::filesystem::path vtk;      // folder of a VTK series, see sim/io/vtk_series.h
  std::filesystem::path video;    // .mp4, made by the program ffmpeg
  double every = 0.02;            // between two frames [s]
  int width = 1280, height = 720;
  report::GrainColour colour = report::GrainColour::speed;
  int threads = 1;

  bool wants_pictures() const { return !picture.empty() || !frames.empty() || !video.empty(); }
  bool wants_series() const { return !frames.empty() || !vtk.empty() || !video.empty(); }
};

/// Throws InputError for what this build, this machine or the sizes do not allow, before time is spent on the trial.
void check_film(const FilmRequest& request);

class Film {
 public:
  /// `speed`: the commanded one, which scales the colour bar [m/s].
  Film(FilmRequest request, std::string title, double slope_along_deg, double slope_across_deg, double speed);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Start of an attempt; what an earlier one showed is dropped.
  void start();
  void add(const campaign::TrialFrame& frame);
  /// The last frame gets the verdict; picture and video are written. Throws DeviceError.
  void finish(const campaign::TrialRecord& record);

  int frame_count() const { return frame_count_; }

 private:
  struct Shot;  // one frame, ready to be drawn
  void draw(const Shot& shot, const std::filesystem::path& path, const campaign::TrialRecord* record) const;
  std::filesystem::path frame_path(int k) const;
  std::filesystem::path frame_folder() const;

  FilmRequest request_;
  std::string title_;
  double slope_along_, slope_across_, speed_;
  double bar_high_ = 1;  // [m/s] or [m]
  int frame_count_ = 0;
  std::optional<report::Camera> camera_;  // that of the first frame, so that a film does not shake
  std::unique_ptr<Shot> last_;
  std::optional<sim::VtkSeries> vtk_;
};

}  // namespace gonogo::lab
