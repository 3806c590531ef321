// `--turning` of a route over a region: what is told, and what is refused.
#include "pipeline/map/route/plan_route.h"

#include <cmath>

#include "pipeline/map/evaluate/cell.h"
#include "tests/pipeline/map/wavy_region.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::map;

namespace {

RouteRequest request_over(const TemporaryFolder& folder) {
  test::make_wavy_region(folder, "waves", {48, 16, 5, 6});
  RouteRequest request;
  request.map = test::request_of_region(folder, "map");
  request.map.model.sampled[campaign::contract().variable_index("slope_along")] = {-35, 35};
  request.map.model.sampled[campaign::contract().variable_index("slope_across")] = {-35, 35};
  const terrain::MapGrid grid = open_sources(request.map.region).elevation.grid();
  request.from = Place{grid.west + 3.5 * grid.cell_width, grid.north - 4.5 * grid.cell_height};
  request.to = Place{grid.west + 43.5 * grid.cell_width, grid.north - 41.5 * grid.cell_height};
  request.costs = {RouteCost::risk};
  return request;
}

}  // namespace

TEST_CASE("a route tells what it turned, and the dearer turns are, the less it does") {
  const TemporaryFolder folder;
  RouteRequest request = request_over(folder);
  const auto plain = plan_route(request).ways[0].second;
  REQUIRE(plain);
  CHECK(!plain->turned);
  request.turning = 1;
  const auto cheap = plan_route(request).ways[0].second;
  request.turning = 500;
  const RouteResult result = plan_route(request);
  const auto& dear = result.ways[0].second;
  REQUIRE(cheap);
  REQUIRE(dear);
  CHECK(*cheap->turned > 20);
  CHECK(*dear->turned < *cheap->turned);
  CHECK(dear->risk >= cheap->risk * (1 - 1e-6));
  CHECK(plain->risk <= dear->risk * (1 + 1e-6));
  CHECK(dear->turning == Approx(500 * *dear->turned / 90));
  CHECK(route_json(result).at("routes").items()[0].at("turning_m").number() == dear->turning);
  CHECK(contains(route_text(result), "degrees in all, which count as"));
}

TEST_CASE("turns that make no sense are refused in a sentence") {
  const TemporaryFolder folder;
  const RouteRequest good = request_over(folder);
  const auto refusal = [&](auto change) {
    RouteRequest request = good;
    request.turning = 20;
    change(request);
    return input_error([&] { plan_route(request); });
  };
  for (const double turning : {-1.0, 1e6, double(NAN)})
    CHECK(contains(refusal([&](RouteRequest& r) { r.turning = turning; }), "is outside 0 to 10000 m"));
  CHECK(contains(refusal([](RouteRequest& r) { r.eight_directions = true; }), "leave out --eight-directions"));
  CHECK(contains(refusal([&](RouteRequest& r) {
                   r.to.reset();
                   r.reach = folder / "reach.tif";
                 }),
                 "only a way has turns"));
}
