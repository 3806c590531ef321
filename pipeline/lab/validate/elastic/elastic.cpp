#include "pipeline/lab/validate/elastic/elastic.h"

#include <utility>

#include "base/error.h"

namespace gonogo::lab {
namespace {

using Maker = CheckFigure (*)();

const std::vector<std::pair<std::string, Maker>>& makers() {
  static const std::vector<std::pair<std::string, Maker>> all{{"patch", elastic_patch},
                                                              {"hertz", elastic_hertz},
                                                              {"mindlin", elastic_mindlin},
                                                              {"wave", elastic_wave},
                                                              {"energy", elastic_energy},
                                                              {"critical", elastic_critical},
                                                              {"newton", elastic_newton},
                                                              {"epsilon", elastic_epsilon},
                                                              {"block", elastic_block},
                                                              {"plate", elastic_plate},
                                                              {"roller", elastic_roller},
                                                              {"tyre_load", elastic_tyre_load},
                                                              {"tyre_patch", elastic_tyre_patch},
                                                              {"tyre_rolling", elastic_tyre_rolling},
                                                              {"tyre_grains", elastic_tyre_grains}};
  return all;
}

}  // namespace

std::vector<std::string> elastic_figures() {
  std::vector<std::string> names;
  for (const auto& [name, make] : makers()) names.push_back(name);
  return names;
}

CheckFigure elastic_figure(const std::string& name) {
  for (const auto& [known, make] : makers())
    if (known == name) return make();
  throw InputError("no elastic figure '" + name + "'; see gonogo validate elastic --help");
}

}  // namespace gonogo::lab
