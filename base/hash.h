// Content hashes for caches and provenance (XXH3-128: fast, collision-free in practice, not cryptographic).
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace gonogo {

/// 32 hexadecimal digits.
std::string content_hash(std::string_view content);

/// Hash of a file's content. Throws InputError when the file is missing or unreadable.
std::string file_hash(const std::filesystem::path& path);

}  // namespace gonogo
