// Stores records in words of 16 bytes.
#pragma once
#include <cstddef>
#include <cstring>

#include "base/host_device.h"

namespace gonogo {

/// to = from. On the GPU nvcc 13.0 would store a record from registers byte by byte; this stores words of 16 bytes.
template <class Record>
GONOGO_HD_INLINED void store_words(Record& to, const Record& from) {
#ifdef __CUDA_ARCH__
  static_assert(sizeof(Record) % sizeof(int4) == 0 && alignof(Record) % sizeof(int4) == 0);
  int4 word[sizeof(Record) / sizeof(int4)];
  std::memcpy(word, &from, sizeof from);
  for (std::size_t i = 0; i < sizeof(Record) / sizeof(int4); ++i) reinterpret_cast<int4*>(&to)[i] = word[i];
#else
  to = from;
#endif
}

}  // namespace gonogo
