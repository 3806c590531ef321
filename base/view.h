// Non-owning array for kernels: a pointer and a count, in host or device memory.
#pragma once
#include "base/vec.h"

namespace gonogo {

template <class T>
struct View {
  T* data = nullptr;
  Index size = 0;

  GONOGO_HD T& operator[](Index i) const { return data[i]; }
  GONOGO_HD T* begin() const { return data; }
  GONOGO_HD T* end() const { return data + size; }
  GONOGO_HD operator View<const T>() const { return {data, size}; }
};

}  // namespace gonogo
