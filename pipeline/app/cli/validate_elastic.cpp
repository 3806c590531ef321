#include <memory>

#include "pipeline/app/cli/validate_parts.h"
#include "pipeline/lab/validate/elastic/elastic.h"

namespace gonogo::app {
namespace {

struct ElasticRequest {
  std::vector<std::string> figures = lab::elastic_figures();
  std::string folder;
};

void validate_elastic(const Globals& globals, const ElasticRequest& request) {
  report_figures(globals, request.figures, request.folder, "elastic bodies", lab::elastic_figure);
}

}  // namespace

void add_elastic_check(CLI::App& validate, const Globals& globals) {
  CLI::App* elastic = validate.add_subcommand(
      "elastic",
      "Elastic bodies in compliant contact against closed forms and two benchmarks; fails when one does not hold");
  auto request = std::make_shared<ElasticRequest>();
  elastic->add_option("figures", request->figures, "Figures to make; default: all")
      ->check(CLI::IsMember(lab::elastic_figures()));
  elastic->add_option("--out", request->folder, "Folder for a picture and a table of each")->type_name(kFolder);
  add_examples(*elastic, {"gonogo validate elastic --out out/elastic", "gonogo validate elastic hertz mindlin --json"});
  elastic->callback([&globals, request] { validate_elastic(globals, *request); });
}

}  // namespace gonogo::app
