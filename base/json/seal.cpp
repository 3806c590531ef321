#include "base/json/seal.h"

#include "base/error.h"
#include "base/files/file.h"

namespace gonogo {

namespace {

std::string hash_without(const Json& object, const std::string& key) {
  Json::Object rest;
  for (const auto& member : object.members())
    if (member.first != key) rest.push_back(member);
  return content_hash(Json(std::move(rest)).dump());
}

}  // namespace

Json sealed(Json object, const std::string& key) {
  object[key] = hash_without(object, key);
  return object;
}

void require_seal(const Json& object, const std::string& source, const std::string& remedy, const std::string& key) {
  const Json* hash = object.is_object() ? object.find(key) : nullptr;
  if (hash == nullptr || !hash->is_string() || hash->string() != hash_without(object, key))
    throw InputError(source + ": " + key + ": " +
                     (hash == nullptr ? "is missing" : "does not match the rest of the file") +
                     ", which was changed or damaged, or comes from an older version; " + remedy);
}

}  // namespace gonogo
