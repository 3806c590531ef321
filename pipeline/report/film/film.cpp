#include "pipeline/report/film/film.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "base/error.h"
#include "pipeline/report/figure/pictures.h"
#include "pipeline/report/film/video.h"

namespace gonogo::report {
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

std::filesystem::path Film::frame_path(int k) const {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%06d.png", k);
  return frame_folder() / name;
}

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
