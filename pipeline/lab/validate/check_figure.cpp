#include "pipeline/lab/validate/check_figure.h"

#include "base/files/file.h"
#include "base/format.h"

namespace gonogo::lab {

Json as_json(const CheckFigure& figure) {
  Json json = Json::object();
  for (const BoundedNumber& c : figure.check) {
    json[c.key] = Json::Object{
        {"measured", c.measured}, {"low", c.low}, {"high", c.high}, {"holds", c.holds()}, {"claim", c.claim}};
  }
  return json;
}

std::string as_text(const CheckFigure& figure) {
  std::string text = figure.name + "\n";
  for (const BoundedNumber& c : figure.check)
    text += line("  %-72s %10.4g in [%.4g, %.4g]%s\n", c.claim.c_str(), c.measured, c.low, c.high,
                 c.holds() ? "" : "  DOES NOT HOLD");
  return text;
}

void write_figure(const std::filesystem::path& folder, const CheckFigure& figure) {
  create_folder(folder);
  write_file_atomically(folder / (figure.name + ".csv"), figure.csv);
  if (!figure.over_time.empty()) write_file_atomically(folder / (figure.name + "_over_time.csv"), figure.over_time);
  report::draw_line_plot(folder / (figure.name + ".png"), figure.plot);
  write_file_atomically(folder / (figure.name + ".json"), as_json(figure).dump(2) + "\n");
}

}  // namespace gonogo::lab
