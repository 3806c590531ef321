// Release and git revision, which are written into every output file.
#pragma once

namespace gonogo {

/// Release, "0.1.0".
const char* program_version();

/// Git revision of the sources at build time, "1a2b3c4d5e6f"; "-dirty" marks uncommitted changes. "unknown" outside
/// git.
const char* program_revision();

}  // namespace gonogo
