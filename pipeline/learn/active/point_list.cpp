#include "pipeline/learn/active/point_list.h"

#include "base/file.h"
#include "base/line.h"
#include "pipeline/campaign/design/point_file.h"

namespace gonogo::learn {
namespace fs = std::filesystem;

std::uint64_t listed_points(const fs::path& file, const campaign::DesignSpec& spec) {
  std::error_code ec;
  return fs::exists(file, ec) ? campaign::read_point_csv(file, spec.fixed).size() : 0;
}

void append_points(const fs::path& file, const campaign::DesignSpec& spec,
                   const std::vector<campaign::DesignPoint>& points) {
  std::error_code ec;
  std::string text;
  if (fs::exists(file, ec)) {
    text = read_file(file);
    if (!text.empty() && text.back() != '\n') text += '\n';
  } else {
    for (const campaign::SampledVariable& range : spec.ranges)
      text += campaign::contract().variables[range.variable].name + ",";
    text += "proposal_density\n";
  }
  for (const campaign::DesignPoint& point : points) {
    for (const campaign::SampledVariable& range : spec.ranges) text += line("%.17g,", point.variables[range.variable]);
    text += line("%.17g\n", point.proposal_density);
  }
  write_file_atomically(file, text);
}

}  // namespace gonogo::learn
