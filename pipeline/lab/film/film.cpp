#include "pipeline/lab/film/film.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/units.h"
#include "pipeline/report/film/video.h"
#include "pipeline/report/picture/render.h"
#ifdef GONOGO_WITH_PICTURES
#include "pipeline/report/figure/trial_figure.h"
#endif

namespace gonogo::lab {
namespace {

constexpr double kAzimuth = 16 * kDegree, kElevation = 13 * kDegree;

std::string text_of(const char* format, double value) {
  if (std::isnan(value)) return "–";
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

struct Film::Shot {
  campaign::TrialSample sample;
  report::Model model;
};

void check_film(const FilmRequest& request) {
  if (!(request.every > 0)) throw InputError("--every must be above zero seconds");
  if (request.width < 320 || request.height < 180 || request.width > 7680 || request.height > 4320)
    throw InputError("--size must be between 320x180 and 7680x4320 pixels");
#ifndef GONOGO_WITH_PICTURES
  if (request.wants_pictures())
    throw InputError("this build has no pictures (--picture, --frames, --video); configure with -DGONOGO_PICTURES=ON");
#endif
  if (request.video.empty()) return;
  if (request.width % 2 != 0 || request.height % 2 != 0)
    throw InputError("--size must be even in both directions for --video");
  report::require_ffmpeg();
}

Film::Film(FilmRequest request, std::string title, double slope_along_deg, double slope_across_deg, double speed)
    : request_(std::move(request)),
      title_(std::move(title)),
      slope_along_(slope_along_deg),
      slope_across_(slope_across_deg),
      speed_(speed) {
  check_film(request_);
}

Film::~Film() {
  std::error_code ignored;
  if (request_.frames.empty()) std::filesystem::remove_all(frame_folder(), ignored);
}

/// Pictures of a video alone lie in a folder that goes with the film.
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

void Film::add(const campaign::TrialFrame& frame) {
  const sim::Capture state = sim::capture_world(frame.simulation, frame.place);
  if (!request_.vtk.empty()) {
    if (!vtk_) vtk_.emplace(request_.vtk, frame.world);
    sim::Capture timed = state;
    timed.time = frame.sample.time;
    vtk_->write(timed);
  }
  if (request_.wants_pictures()) {
    if (!camera_) {
      bar_high_ = speed_ / 2;  // few grains are faster: those that a lug throws out
      if (request_.colour == report::GrainColour::height) {
        bar_high_ = 0;
        for (const sim::Shape& s : frame.world.shape)
          if (s.type == sim::ShapeType::sphere)
            bar_high_ = std::max(bar_high_, state.body[s.body].position.z + s.offset_B.z + s.size.x);
      }
    }
    last_ = std::make_unique<Shot>(
        Shot{frame.sample, report::model_of(frame.world, state, {request_.colour, 0, bar_high_, frame.wheel})});
    if (!camera_)
      camera_ = report::frame_model(last_->model, kAzimuth, kElevation, double(request_.width) / request_.height,
                                    {0.03, 0.12, 0.12, 0.15});
    if (!request_.frames.empty() || !request_.video.empty()) draw(*last_, frame_path(frame_count_), nullptr);
  }
  ++frame_count_;
}

void Film::finish(const campaign::TrialRecord& record) {
  if (!last_) return;
  if (!request_.picture.empty()) draw(*last_, request_.picture, &record);
  if (request_.frames.empty() && request_.video.empty()) return;
  draw(*last_, frame_path(frame_count_ - 1), &record);
  for (int k = frame_count_; std::filesystem::exists(frame_path(k)); ++k) std::filesystem::remove(frame_path(k));
  if (!request_.video.empty()) report::make_video(frame_folder(), frame_count_, 1 / request_.every, request_.video);
}

#ifdef GONOGO_WITH_PICTURES
void Film::draw(const Shot& shot, const std::filesystem::path& path, const campaign::TrialRecord* record) const {
  const campaign::TrialSample& s = shot.sample;
  report::TrialCaption c;
  c.title = title_;
  if (record) {
    const auto& verdict = campaign::contract().info(record->verdict);
    c.verdict = verdict.label;
    if (record->reason != campaign::Reason::none) c.verdict += ": " + campaign::contract().info(record->reason).label;
    c.verdict_colour = verdict.colour;
  }
  c.facts = {{"time", text_of("%.2f s", s.time)},
             {"speed", text_of("%.2f m/s", s.speed)},
             {"slip", text_of("%.2f", s.slip)},
             {"sinkage", text_of("%.0f mm", 1e3 * s.sinkage)},
             {"torque", text_of("%.0f N m", s.torque)},
             {"slope along", text_of("%.1f°", slope_along_)},
             {"slope across", text_of("%.1f°", slope_across_)}};
  c.bar_label = request_.colour == report::GrainColour::speed ? "grain speed [m/s]" : "height of grain [m]";
  c.bar_high = bar_high_;
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const report::Light light = report::bar_colour((k + 0.5) / steps);
    for (const Real part : {light.x, light.y, light.z}) c.bar_rgb.push_back(report::srgb(part));
  }
  report::write_trial_figure(
      path, report::render(shot.model, *camera_, request_.width, request_.height, request_.threads), c);
}
#else
void Film::draw(const Shot&, const std::filesystem::path&, const TrialRecord*) const {}
#endif

}  // namespace gonogo::lab
