// Pictures into a video, by the program ffmpeg.
#pragma once
#include <filesystem>

namespace gonogo::report {

/// Throws InputError when no program ffmpeg is on the PATH.
void require_ffmpeg();

/// Joins `count` pictures `folder`/frame_000000.png, ... to an H.264 video of `rate` pictures per second, whole or not
/// at all. Throws DeviceError with what ffmpeg said.
void make_video(const std::filesystem::path& folder, int count, double rate, const std::filesystem::path& video);

}  // namespace gonogo::report
