#include "pipeline/inspect/trial_film.h"

#include <cmath>
#include <utility>

#include "base/format.h"
#include "base/units.h"

namespace gonogo::inspect {
namespace {

std::string text_of(const char* format, double value) { return std::isnan(value) ? "–" : line(format, value); }

report::FilmStyle style_of(const report::FilmRequest& request, const FilmedTrial& trial) {
  report::FilmStyle style{
      .title = trial.title, .azimuth = to_radians(trial.azimuth), .elevation = to_radians(trial.elevation)};
  if (request.colour == report::GrainColour::speed) {
    style.bar_label = "grain speed [m/s]";
    style.bar_high = trial.commanded_speed / 2;  // few grains are faster: those that a lug throws out
  } else {
    style.bar_label = "height of grain [m]";
  }
  return style;
}

}  // namespace

TrialFilm::TrialFilm(const report::FilmRequest& request, FilmedTrial trial)
    : trial_(std::move(trial)), film_(request, style_of(request, trial_)) {}

void TrialFilm::add(const campaign::TrialFrame& frame) {
  const campaign::TrialSample& s = frame.sample;
  sim::Capture state = sim::capture_world(frame.simulation, frame.place);
  state.time = s.time;
  film_.add({.world = frame.world,
             .state = state,
             .focus = frame.wheel,
             .facts = {{"time", text_of("%.2f s", s.time)},
                       {"speed", text_of("%.2f m/s", s.speed)},
                       {"slip", text_of("%.2f", s.slip)},
                       {"sinkage", text_of("%.0f mm", 1e3 * s.sinkage)},
                       {"torque", text_of("%.0f N m", s.torque)},
                       {"slope along", text_of("%.1f deg", trial_.slope_along)},
                       {"slope across", text_of("%.1f deg", trial_.slope_across)}}});
}

void TrialFilm::finish(const campaign::TrialRecord& record) {
  const auto& verdict = campaign::contract().info(record.verdict);
  report::Badge badge{verdict.label, verdict.colour};
  if (record.reason != campaign::Reason::none) badge.text += ": " + campaign::contract().info(record.reason).label;
  film_.finish(badge);
}

}  // namespace gonogo::inspect
