// A scene as files: one captioned picture, or a film of it while it moves: pictures, a video, VTK files for ParaView.
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/picture/render.h"
#include "sim/io/vtk_series.h"

namespace gonogo::report {

/// Throws InputError when no program ffmpeg is on the PATH.
void require_ffmpeg();

/// Joins `count` pictures `folder`/frame_000000.png, ... to an H.264 video of `rate` pictures per second, whole or not
/// at all. Throws DeviceError with what ffmpeg said.
void make_video(const std::filesystem::path& folder, int count, double rate, const std::filesystem::path& video);

/// Margins that keep a model out of its caption and colour bar.
inline constexpr Margins kCaptionMargins = {.left = 0.03, .right = 0.12, .top = 0.12, .bottom = 0.15};

/// Gives the caption a bar in the colours of model_of() from `low` to `high`, in the label's unit.
void add_bar(Caption& caption, const std::string& label, double low, double high);

/// Where and how large a picture is drawn.
struct ShotFile {
  std::filesystem::path path;
  int width = 1280, height = 720;  // [pixel]
  int threads = 1;                 // the same bytes for any number
};

/// Renders the model and writes it with its caption, whole or not at all. Does nothing in a build without pictures.
/// Throws DeviceError when the file cannot be written.
void write_shot(const ShotFile& file, const Model& model, const Camera& camera, const Caption& caption);

/// Which files a user wants. An empty path: not wanted.
struct FilmRequest {
  std::filesystem::path picture = {};  // .png of the last frame
  std::filesystem::path frames = {};   // folder of frame_000000.png, ...
  std::filesystem::path vtk = {};      // folder of a VTK series, see sim/io/vtk_series.h
  std::filesystem::path video = {};    // .mp4, made by the program ffmpeg
  double every = 0.02;                 // time that a video shows each frame [s]
  int width = 1280, height = 720;
  GrainColour colour = GrainColour::speed;
  int threads = 1;

  bool wants_pictures() const { return !picture.empty() || !frames.empty() || !video.empty(); }
  bool wants_series() const { return !frames.empty() || !vtk.empty() || !video.empty(); }
};

/// Call it before a long simulation. Throws InputError for sizes out of range, for pictures in a build without them and
/// for a video on a machine without ffmpeg.
void check_film(const FilmRequest& request);

/// What is the same in all frames of a film.
struct FilmStyle {
  std::string title = {};
  std::string bar_label = {};  // of the colour bar, with its unit; empty: no bar
  /// Upper end of the bar [m/s] or [m]. Unset: height of the highest sphere in the first frame.
  std::optional<double> bar_high = {};
  double azimuth = 0, elevation = 0;  // of a camera that frames the first frame [rad], see frame_model()
  std::optional<Camera> camera = {};  // used instead of that one
};

/// A scene at one moment; valid during the call.
struct FilmFrame {
  const sim::SceneWorld& world;  // shapes, masses and bounds
  const sim::Capture& state;     // bodies and contacts; its time goes into the VTK files
  sim::BodyIndex focus = -1;     // body that a periodic world is drawn around; -1: the world's middle
  std::vector<Fact> facts = {};  // along the foot of the picture
};

class Film {
 public:
  /// Throws InputError as check_film() does.
  Film(FilmRequest request, FilmStyle style);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// Drops all frames: the scene starts again.
  void start();
  /// Writes the frame. Throws DeviceError when a file cannot be written.
  void add(const FilmFrame& frame);
  /// Draws the last frame again with a badge and writes picture and video. Throws DeviceError when a file cannot be
  /// written or ffmpeg fails.
  void finish(const Badge& badge = {});

  int frame_count() const { return frame_count_; }

 private:
  struct Shot;  // one frame, ready to be drawn
  void look_at(const FilmFrame& frame);
  void draw(const Shot& shot, const std::filesystem::path& path, const Badge& badge) const;
  bool wants_frames() const { return !request_.frames.empty() || !request_.video.empty(); }
  std::filesystem::path frame_path(int k) const;
  std::filesystem::path frame_folder() const;

  FilmRequest request_;
  FilmStyle style_;
  double bar_high_ = 1;  // [m/s] or [m]
  int frame_count_ = 0;
  std::optional<Camera> camera_;  // that of the first frame, so that a film does not shake
  std::unique_ptr<Shot> last_;
  std::optional<sim::VtkSeries> vtk_;
};

}  // namespace gonogo::report
