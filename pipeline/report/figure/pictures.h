// Whether this build can draw. Without cairo every function of this folder that writes a figure does nothing.
#pragma once
#include <string>

namespace gonogo::report {

/// True when the build has cairo (-DGONOGO_PICTURES=ON).
bool pictures_available();

/// For what a user asked for by name: throws InputError when this build cannot draw. `options`: what was asked for,
/// "--picture, --video".
void require_pictures(const std::string& options);

}  // namespace gonogo::report
