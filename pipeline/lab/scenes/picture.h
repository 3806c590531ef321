// A scene of many bodies as pictures and as a video.
#pragma once
#include <filesystem>

#include "pipeline/lab/scenes/scene.h"
#include "pipeline/report/picture/camera.h"
#include "sim/io/capture.h"

namespace gonogo::lab {

/// Throws InputError in a build without pictures and, for a video, on a machine without ffmpeg.
void require_pictures(bool video);

/// Camera and colour bar.
struct SnapshotView {
  report::Camera camera;
  double high_speed = 1;  // upper end of the colour bar [m/s]
};

/// A view that holds all of these states. In three of four of them, one body in twenty is faster than the bar's upper
/// end.
SnapshotView view_of(const ManyScene& scene, const std::vector<const sim::Capture*>& states);

/// Writes a PNG with spheres in the colours of their speed or material. Fixed bodies, walls and floors, are left out:
/// they would hide the rest.
void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state,
                   const SnapshotView& view, int threads);

/// Writes a PNG of curves: everything but the first number of a look over the first.
void draw_watched(const std::filesystem::path& path, const ManyScene& scene,
                  const std::vector<std::vector<Measured>>& watched);

/// Pictures per second of a video of `count` states, `every` seconds apart: real time, or slower so that the video
/// takes six seconds, but at least five pictures per second.
double frame_rate(int count, double every);

/// Writes an MP4 of states that are `every` seconds apart, at that rate.
void draw_video(const std::filesystem::path& path, const ManyScene& scene, const std::vector<sim::Capture>& states,
                double every, int threads);

}  // namespace gonogo::lab
