// Content hashes for caches and provenance (XXH3-128: fast, collision-free in practice, not cryptographic).
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace gonogo {

/// 32 hexadecimal digits.
std::string content_hash(std::string_view content);

/// Hash of a file's content, read block by block. Throws InputError when it is missing or cannot be read.
std::string file_hash(const std::filesystem::path& path);

}  // namespace gonogo
