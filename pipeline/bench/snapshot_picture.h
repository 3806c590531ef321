// A scene of many bodies as a picture.
#pragma once
#include <filesystem>

#include "pipeline/bench/many.h"
#include "sim/io/capture.h"

namespace gonogo::pipeline {

/// Throws InputError in a build without pictures.
void require_pictures();

/// Writes a PNG, spheres in the colours of their speed up to that of nineteen in twenty. Walls and floors, all that is
/// fixed, are left out: they would hide what they hold.
void draw_snapshot(const std::filesystem::path& path, const ManyScene& scene, const sim::Capture& state, int threads);

}  // namespace gonogo::pipeline
