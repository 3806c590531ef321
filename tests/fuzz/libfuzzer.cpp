// Entry of libFuzzer: the reader that GONOGO_READER names reads the bytes as its file. A finding is a crash, a hang, or
// an exception that is no InputError. GONOGO_SEED_FILE takes the whole file. Without GONOGO_READER the program prints
// the readers' names. See scripts/fuzz.sh.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/files/file.h"
#include "tests/fuzz/readers.h"
#include "tests/support/temporary_folder.h"

namespace {

std::vector<gonogo::fuzz::Reader> all_readers() {
  using namespace gonogo::fuzz;
  std::vector<Reader> all;
  for (const auto* some : {&file_readers(), &format_readers(), &unsealed_readers(), &sealed_readers()})
    all.insert(all.end(), some->begin(), some->end());
  return all;
}

gonogo::fuzz::Reader chosen_reader() {
  const char* name = std::getenv("GONOGO_READER");
  for (const gonogo::fuzz::Reader& reader : all_readers()) {
    if (!name) std::puts(reader.name.c_str());
    if (name && reader.name == name) return reader;
  }
  if (!name) std::exit(0);
  throw gonogo::InputError(std::string(name) + ": no reader has this name");
}

struct Target {
  const gonogo::fuzz::Reader reader = chosen_reader();
  gonogo::TemporaryFolder folder;

  Target() {
    reader.make(folder.path());
    if (const char* seed = std::getenv("GONOGO_SEED_FILE"))
      gonogo::write_file_atomically(seed, gonogo::read_file(folder / reader.damaged));
    reader.read(folder / reader.opened);
  }
};

const Target& target() {
  static const Target only;
  return only;
}

}  // namespace

/// Before libFuzzer reads its corpus, so that the whole file can be in it.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  target();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path folder = target().folder.path();
  const gonogo::fuzz::Reader& reader = target().reader;
  std::FILE* file = std::fopen((folder / reader.damaged).c_str(), "wb");
  std::fwrite(data, 1, size, file);
  std::fclose(file);
  try {
    reader.read(folder / reader.opened);
  } catch (const gonogo::InputError&) {
  }
  return 0;
}
