// Non-owning array for kernels: a pointer and a count, in host or device memory.
#pragma once
#include <type_traits>

#include "base/vec.h"

namespace gonogo {

template <class T>
struct View {
  T* data = nullptr;
  Index size = 0;

  GONOGO_HD T& operator[](Index i) const { return data[i]; }
  GONOGO_HD T* begin() const { return data; }
  GONOGO_HD T* end() const { return data + size; }
  /// To View<const T>.
  template <class U>
  requires(std::is_same_v<U, const T> && !std::is_const_v<T>) GONOGO_HD operator View<U>() const {
    return {data, size};
  }
};

}  // namespace gonogo
