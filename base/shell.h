// Commands that messages advise and scripts hold.
#pragma once
#include <string>

namespace gonogo {

/// A word of a command as a POSIX shell reads it back: as it is if it holds letters, digits and "%+,-./:=@_" alone,
/// otherwise in single quotes.
std::string shell_word(const std::string& word);

}  // namespace gonogo
