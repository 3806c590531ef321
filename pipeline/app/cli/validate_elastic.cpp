#include <memory>

#include "base/cancel.h"
#include "pipeline/app/cli/validate_parts.h"
#include "pipeline/lab/validate/elastic/elastic.h"

namespace gonogo::app {
namespace {

struct ElasticRequest {
  std::vector<std::string> figures = lab::elastic_figures();
  std::string folder;
};

void validate_elastic(const Globals& globals, const ElasticRequest& request) {
  Json json = Json::object(), checks = Json::object();
  std::string text;
  int failed = 0;
  for (const std::string& name : request.figures) {
    stop_if_cancelled();
    const lab::ElasticFigure figure = lab::elastic_figure(name);
    if (!request.folder.empty()) lab::write_figure(request.folder, figure);
    text += lab::as_text(figure);
    for (const lab::SoilCheck& c : figure.check) {
      json[c.key] = c.measured;
      failed += !c.holds();
    }
    checks[name] = lab::as_json(figure);
  }
  json["failed"] = failed;
  json["checks"] = checks;
  if (failed > 0)
    fail_with_result(globals, json, text,
                     DeviceError(std::to_string(failed) + " checks of elastic bodies do not hold"));
  print_result(globals, json, text);
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
