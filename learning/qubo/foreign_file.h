// Files of neighbouring kinds, which people take for problems or answers.
#pragma once
#include <string>
#include <string_view>

namespace gonogo::learning {

/// Throws InputError that names the kind of file and the remedy, for files of dimod that hold other models (CQM, DQM,
/// QM), LP files, pickles, ZIP archives and HDF5 files. Returns for everything else.
void refuse_foreign_file(std::string_view bytes, const std::string& source);

}  // namespace gonogo::learning
