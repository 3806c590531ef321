// The figures of a build without cairo: nothing is drawn and no file is written.
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/chart.h"

namespace gonogo::report {

bool pictures_available() { return false; }

void write_captioned(const std::filesystem::path&, const Image&, const Caption&) {}
void write_charts(const std::filesystem::path&, const std::string&, const std::vector<Chart>&) {}
void draw_line_plot(const std::filesystem::path&, const LinePlot&) {}
void draw_scatter(const std::filesystem::path&, const ScatterTable&, std::size_t, std::size_t) {}
void draw_pairs(const std::filesystem::path&, const ScatterTable&) {}
void draw_bars(const std::filesystem::path&, const Bars&) {}

}  // namespace gonogo::report
