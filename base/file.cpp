#include "base/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/input_place.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

std::string reason() { return std::strerror(errno); }

void flush_to_disk(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY);
  if (fd < 0) throw DeviceError(path.string() + ": cannot open to flush: " + reason());
  const int status = ::fsync(fd);
  const std::string why = status == 0 ? "" : reason();
  ::close(fd);
  if (status != 0) throw DeviceError(path.string() + ": cannot flush to disk: " + why);
}

[[noreturn]] void refuse(const fs::path& path, const std::string& message) {
  throw PlacedInputError(path.string() + ": " + message, {.file = path.string()});
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

}  // namespace

std::string read_file(const fs::path& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) refuse(path, "no such file; check the path");
  if (fs::is_directory(path, ec)) refuse(path, "is a folder, a file is needed");
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(path, "cannot be read: " + reason() + "; check its permissions");
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) refuse(path, "reading failed: " + reason());
  return std::move(text).str();
}

void create_folder(const fs::path& folder) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec || !fs::is_directory(folder))
    throw InputError(folder.string() + ": cannot create this folder: " + (ec ? ec.message() : "a file stands there") +
                     "; choose another place or fix its permissions");
}

void replace_file_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  create_folder(folder_of(path));
  const fs::path temporary = folder_of(path) / ("." + path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                                                path.extension().string());
  try {
    write(temporary);
    flush_to_disk(temporary);
    fs::rename(temporary, path);
    flush_to_disk(folder_of(path));
  } catch (const fs::filesystem_error& e) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw DeviceError(path.string() + ": cannot put the finished file in place: " + e.code().message());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_file_atomically(const fs::path& path, std::string_view content) {
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::FILE* out = std::fopen(temporary.c_str(), "wb");
    if (!out) throw DeviceError(path.string() + ": cannot write: " + reason());
    const bool written = std::fwrite(content.data(), 1, content.size(), out) == content.size();
    const bool closed = std::fclose(out) == 0;
    if (!written || !closed) throw DeviceError(path.string() + ": cannot write: " + reason());
  });
}

}  // namespace gonogo
