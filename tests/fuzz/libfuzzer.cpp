// Entry of libFuzzer: the reader that GONOGO_READER names, or raster_geotiff, reads the bytes as its file. A finding is
// a crash, a hang, or an exception that is no InputError. "-seed_file" in place of bytes: see scripts/fuzz.sh.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/files/file.h"
#include "tests/fuzz/readers.h"
#include "tests/support/temporary_folder.h"

namespace {

struct Target {
  const gonogo::fuzz::Reader& reader;
  gonogo::TemporaryFolder folder;

  Target()
      : reader(gonogo::fuzz::reader_named(std::getenv("GONOGO_READER") ? std::getenv("GONOGO_READER")
                                                                       : "raster_geotiff")) {
    reader.make(folder.path());
    if (const char* seed = std::getenv("GONOGO_SEED_FILE"))
      gonogo::write_file_atomically(seed, gonogo::read_file(folder / reader.damaged));
    reader.read(folder / reader.opened);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Target target;
  std::FILE* file = std::fopen((target.folder / target.reader.damaged).c_str(), "wb");
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  try {
    target.reader.read(target.folder / target.reader.opened);
  } catch (const gonogo::InputError&) {
  }
  return 0;
}
