// A JSON object that shows whether it was changed: its member "hash" is the hash of all others, whatever the layout of
// the text. It finds damage, not forgery.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo {

/// The object with its hash as the last member.
Json sealed(Json object);

/// Throws InputError "source: hash: ..." when the hash is missing or belongs to other content. `remedy` ends the
/// sentence, such as "make the map again".
void require_seal(const Json& object, const std::string& source, const std::string& remedy);

}  // namespace gonogo
