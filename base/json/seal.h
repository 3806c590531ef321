// A JSON object that shows whether it was changed: one of its members is the hash of all others, whatever the layout of
// the text. It finds damage, not forgery.
#pragma once
#include <string>

#include "base/json/json.h"

namespace gonogo {

/// The object with its hash as the last member, under `key`.
Json sealed(Json object, const std::string& key = "hash");

/// Throws InputError "source: key: ..." when the hash is missing or belongs to other content. `remedy` ends the
/// sentence, such as "make the map again".
void require_seal(const Json& object, const std::string& source, const std::string& remedy,
                  const std::string& key = "hash");

}  // namespace gonogo
