// Elastic bodies against closed forms and published benchmarks, as `gonogo validate elastic` prints them.
#include "pipeline/lab/validate/elastic/elastic.h"
#include "tests/support/catch.h"

using namespace gonogo;

TEST_CASE("Elastic bodies keep every bound") {
  for (const std::string& name : lab::elastic_figures()) {
    const lab::CheckFigure figure = lab::elastic_figure(name);
    CHECK_FALSE(figure.check.empty());
    for (const lab::BoundedNumber& c : figure.check) {
      INFO(c.claim << ": " << c.measured << " in [" << c.low << ", " << c.high << "]");
      CHECK(c.holds());
    }
  }
}
