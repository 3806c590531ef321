#include "pipeline/report/figure/film.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"

namespace gonogo::report {
namespace {

/// Runs a program with what it prints going to `log`; returns its exit code, or -1 when a signal ended it.
int run_program(std::vector<std::string> words, const std::filesystem::path& log) {
  std::vector<char*> pointers;
  for (std::string& w : words) pointers.push_back(w.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw DeviceError("cannot start " + words[0] + ": " + std::strerror(error));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0)
    if (errno != EINTR) throw DeviceError("cannot wait for " + words[0] + ": " + std::strerror(errno));
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string last_line(const std::filesystem::path& log) {
  std::istringstream in(std::filesystem::exists(log) ? read_file(log) : "");
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

std::string number(double x) { return line("%.6g", x); }

}  // namespace

void require_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return;
  throw InputError(
      "--video needs the program ffmpeg, which is not on the PATH; install it (apt-get install ffmpeg) or take "
      "--frames");
}

void make_video(const std::filesystem::path& folder, int count, double rate, const std::filesystem::path& video) {
  const auto log = folder / "ffmpeg.log";
  replace_file_atomically(video, [&](const std::filesystem::path& temporary) {
    const int code = run_program({"ffmpeg",
                                  "-nostdin",
                                  "-y",
                                  "-loglevel",
                                  "error",
                                  "-framerate",
                                  number(rate),
                                  "-i",
                                  (folder / "frame_%06d.png").string(),
                                  "-frames:v",
                                  std::to_string(count),
                                  "-c:v",
                                  "libx264",
                                  "-crf",
                                  "18",
                                  "-pix_fmt",
                                  "yuv420p",
                                  "-movflags",
                                  "+faststart",
                                  std::filesystem::absolute(temporary).string()},
                                 log);
    if (code != 0) throw DeviceError(video.string() + ": ffmpeg failed: " + last_line(log));
  });
  std::filesystem::remove(log);
}

void add_bar(Caption& caption, const std::string& label, double low, double high) {
  caption.bar_label = label;
  caption.bar_low = low;
  caption.bar_high = high;
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const Light light = bar_colour((k + 0.5) / steps);
    for (const Real channel : {light.x, light.y, light.z}) caption.bar_rgb.push_back(srgb(channel));
  }
}

void write_shot(const ShotFile& file, const Model& model, const Camera& camera, const Caption& caption) {
  if (!pictures_available()) return;
  write_captioned(file.path, render(model, camera, file.width, file.height, file.threads), caption);
}

namespace {

/// Height of the highest point of a sphere, at least zero [m].
double highest_point(const FilmFrame& frame) {
  double highest = 0;
  for (const sim::Shape& s : frame.world.shape)
    if (s.type == sim::ShapeType::sphere)
      highest = std::max(highest, frame.state.body[s.body].position.z + s.offset_B.z + s.size.x);
  return highest;
}

}  // namespace

struct Film::Shot {
  std::vector<Fact> facts;
  Model model;
};

void check_film(const FilmRequest& request) {
  if (!(request.every > 0)) throw InputError("--every must be above zero seconds");
  if (request.width < 320 || request.height < 180 || request.width > 7680 || request.height > 4320)
    throw InputError("--size must be between 320x180 and 7680x4320 pixels");
  if (request.wants_pictures()) require_pictures("--picture, --frames, --video");
  if (request.video.empty()) return;
  if (request.width % 2 != 0 || request.height % 2 != 0)
    throw InputError("--size must be even in both directions for --video");
  require_ffmpeg();
}

Film::Film(FilmRequest request, FilmStyle style) : request_(std::move(request)), style_(std::move(style)) {
  check_film(request_);
}

Film::~Film() {
  std::error_code ignored;
  if (request_.frames.empty()) std::filesystem::remove_all(frame_folder(), ignored);
}

/// The pictures of a video alone lie in a temporary folder.
std::filesystem::path Film::frame_folder() const {
  if (!request_.frames.empty()) return request_.frames;
  return std::filesystem::temp_directory_path() / ("gonogo-film-" + std::to_string(::getpid()));
}

std::filesystem::path Film::frame_path(int k) const { return frame_folder() / line("frame_%06d.png", k); }

void Film::start() {
  frame_count_ = 0;
  camera_.reset();
  last_.reset();
  vtk_.reset();
}

void Film::add(const FilmFrame& frame) {
  if (!request_.vtk.empty()) {
    if (!vtk_) vtk_.emplace(request_.vtk, frame.world);
    vtk_->write(frame.state);
  }
  if (request_.wants_pictures()) {
    look_at(frame);
    if (wants_frames()) draw(*last_, frame_path(frame_count_), {});
  }
  ++frame_count_;
}

/// The first frame fixes the colour bar and the camera of all.
void Film::look_at(const FilmFrame& frame) {
  const bool first = !camera_;
  if (first) bar_high_ = style_.bar_high ? *style_.bar_high : highest_point(frame);
  const ModelStyle style{.colour = request_.colour, .low = 0, .high = bar_high_, .focus = frame.focus};
  last_ = std::make_unique<Shot>(Shot{frame.facts, model_of(frame.world, frame.state, style)});
  if (!first) return;
  const double aspect = double(request_.width) / request_.height;
  camera_ = style_.camera ? *style_.camera
                          : frame_model(last_->model, style_.azimuth, style_.elevation, aspect, kCaptionMargins);
}

void Film::finish(const Badge& badge) {
  if (!last_) return;
  if (!request_.picture.empty()) draw(*last_, request_.picture, badge);
  if (!wants_frames()) return;
  draw(*last_, frame_path(frame_count_ - 1), badge);
  for (int k = frame_count_; std::filesystem::exists(frame_path(k)); ++k) std::filesystem::remove(frame_path(k));
  if (!request_.video.empty()) make_video(frame_folder(), frame_count_, 1 / request_.every, request_.video);
}

void Film::draw(const Shot& shot, const std::filesystem::path& path, const Badge& badge) const {
  Caption caption{.title = style_.title, .badge = badge, .facts = shot.facts};
  if (!style_.bar_label.empty()) add_bar(caption, style_.bar_label, 0, bar_high_);
  const ShotFile file{.path = path, .width = request_.width, .height = request_.height, .threads = request_.threads};
  write_shot(file, shot.model, *camera_, caption);
}

}  // namespace gonogo::report
