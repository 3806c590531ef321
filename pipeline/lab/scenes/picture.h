// A scene of many bodies as pictures and as a video.
#pragma once
#include <filesystem>

#include "pipeline/lab/scenes/scene.h"
#include "pipeline/report/picture/camera.h"
#include "sim/io/capture.h"

namespace gonogo::lab {

/// Throws InputError in a build without pictures and, for a video, on a machine without ffmpeg.
void require_pictures(bool video);

/// Where it is seen from and what the colours stand for.
struct SnapshotView {
  report::Camera camera;
  double high_speed = 1;  // upper end of the colour bar [m/s]
};

/// Such that all of these states are in the picture and one body in twenty is faster than the bar in three of four.
SnapshotView view_of(const ManyScene& scene, const std::vector<const sim::Capture*>& states);

/// Writes a PNG, spheres in the colours of their speed or material. Walls and floors, all that is fixed, are left out:
/// they would hide what they hold.
void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state,
                   const SnapshotView& view, int threads);

/// Writes a PNG of curves: everything but the first number of a look over the first.
void draw_watched(const std::filesystem::path& path, const ManyScene& scene,
                  const std::vector<std::vector<Measured>>& watched);

/// Pictures per second at which `count` of them, `every` seconds apart, are shown: as fast as things went, or slower
/// where that would be over in less than six seconds, but at least five.
double frame_rate(int count, double every);

/// Writes an MP4 of states that are `every` seconds apart, at that rate.
void draw_video(const std::filesystem::path& path, const ManyScene& scene, const std::vector<sim::Capture>& states,
                double every, int threads);

}  // namespace gonogo::lab
