#include "tests/fuzz/readers.h"

namespace gonogo::fuzz {

const std::vector<Reader>& readers() {
  static const std::vector<Reader> list = [] {
    std::vector<Reader> all;
    for (const auto* some :
         {&file_readers(), &format_readers(), &unsealed_readers(), &sealed_readers(), &made_readers()})
      all.insert(all.end(), some->begin(), some->end());
    return all;
  }();
  return list;
}

}  // namespace gonogo::fuzz
