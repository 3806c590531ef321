#include "base/json/seal.h"

#include "base/error.h"
#include "base/files/file.h"

namespace gonogo {

namespace {

constexpr const char* kHash = "hash";

std::string hash_of(const Json& object) {
  Json::Object rest;
  for (const auto& member : object.members())
    if (member.first != kHash) rest.push_back(member);
  return content_hash(Json(std::move(rest)).dump());
}

}  // namespace

Json sealed(Json object) {
  object[kHash] = hash_of(object);
  return object;
}

void require_seal(const Json& object, const std::string& source, const std::string& remedy) {
  const Json* hash = object.is_object() ? object.find(kHash) : nullptr;
  if (hash == nullptr || !hash->is_string() || hash->string() != hash_of(object))
    throw InputError(source + ": hash: " + (hash == nullptr ? "is missing" : "does not match the rest of the file") +
                     ", which was changed or damaged, or comes from an older version; " + remedy);
}

}  // namespace gonogo
