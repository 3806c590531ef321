// A Delassus matrix by its factors: W = B B^T, B [rows x freedoms of bodies].
#pragma once
#include <array>
#include <vector>

#include "base/vec.h"

namespace gonogo::sim {

struct BodyForm {
  static constexpr int kFreedoms = 6;  // of a body: along x, y, z, about three axes; scaled so that their mass is 1

  struct Contact {
    Index body[2];                                        // -1: it cannot move
    std::array<std::array<double, kFreedoms>, 5> row[2];  // B: of the first `dimension` rows, for each body
  };

  Index body_count = 0;
  std::vector<Contact> contact;  // [contact_count]
};

}  // namespace gonogo::sim
