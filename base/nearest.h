// "Did you mean ...?": the word of a list with the smallest edit distance to a misspelt one.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace gonogo {

/// Number of single-character insertions, deletions and substitutions between two words (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The first of `words` that begins with `misspelt`, if that has three letters or more. Otherwise the first with the
/// smallest edit distance; empty when there are no words.
std::string nearest_word(std::string_view misspelt, const std::vector<std::string>& words);

/// "a, b, c"
std::string join_words(const std::vector<std::string>& words);

}  // namespace gonogo
