// Content hashes for caches and provenance (XXH3-128: fast, collision-free in practice, not cryptographic).
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace gonogo {

/// 32 hexadecimal digits.
std::string content_hash(std::string_view content);
std::string file_hash(const std::filesystem::path& path);

}  // namespace gonogo
