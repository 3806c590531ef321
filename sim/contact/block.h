// Eight contacts field by field, as the host's solver updates them.
#pragma once
#include "sim/contact/contact.h"

namespace gonogo::sim {

#ifdef __CUDACC__
struct ContactBlock {};  // the GPU updates contacts one per thread
#else
/// Eight consecutive contacts with their numbers and old impulses field by field; the last block repeats its last
/// contact.
struct alignas(32) ContactBlock {
  ContactNumbers<Pack> numbers;
  ImpulseT<Pack> impulse;
  BodyIndex body_a[kPackWidth], body_b[kPackWidth];
  WorldIndex first_world, last_world;
};
#endif

}  // namespace gonogo::sim
