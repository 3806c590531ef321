"""Routes over a region."""
import datetime
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from . import _core
from ._files import PathLike
from ._mapping import Soil, map_files, with_gdal
from ._model import Model

Place = tuple[float, float]


def _utc(departure: str | datetime.datetime | None) -> str:
    if not isinstance(departure, datetime.datetime):
        return departure or ""
    if departure.tzinfo is None:
        raise _core.InputError(f"departure: {departure} has no time zone; give it one, such as tzinfo=datetime.timezone.utc")
    return departure.astimezone(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")


def route(dem: Any = None, model: Model | PathLike = "", soil: Soil | None = None, *, start: Place | None = None,
          end: Place | None = None, via: Iterable[Place] = (), avoid: PathLike = "", costs: Iterable[str] = ("safest",),
          any_angle: bool = True, turning: float = 0, departure: str | datetime.datetime | None = None, lines: PathLike = "",
          reach: PathLike = "", isochrones: PathLike = "", interval: float = 0, regions: PathLike = "",
          costmap: PathLike = "", grid_map: PathLike = "", region: PathLike | None = None, crs: Any = None,
          transform: Any = None, vehicle: PathLike = "", whole_vehicle: PathLike = "", dataset: PathLike | None = None,
          study: PathLike | None = None, moisture: str = "", cone_index: str | float | PathLike = "", settings: Mapping[str, float] | None = None,
          max_speed: float = 0, height_unit: str = "", flat_is_ground: bool = False, crossing_model: PathLike = "",
          threads: int = 0) -> dict[str, Any]:
    """Routes over a region, as `gonogo route` plans them.

    start, end, via: (x, y) in the region's coordinate system; a way passes the places of `via` in their order. avoid:
    polygons that no way may touch, GeoJSON, GeoPackage or another format of GDAL. costs: "shortest", "fastest", "safest",
    "least-energy". any_angle: False: steps to the eight neighbours only, quicker and up to 8 % longer. turning: a
    turn by 90 degrees costs as much as so many metres of driving there. departure: when the
    track of a .gpx starts: "2026-05-01T06:00:00Z", or a datetime with a time zone.

    Files to write: lines: .gpkg, .geojson or .gpx. reach: .tif of the min cost from `start`. isochrones: .gpkg of bands of
    that cost, `interval` wide [s, m, J, or -ln of the chance]. regions: .gpkg of connected regions. costmap: .yaml for Nav2,
    with a .pgm beside it. grid_map: .nc or .tif of layers by heading. The last five take the first cost.

    Region and mission as in map().
    """
    request = with_gdal().RouteRequest(start, end, list(via), list(costs), not any_angle, turning, _utc(departure), interval)
    files = {"avoid": avoid, "lines": lines, "reach": reach, "isochrones": isochrones, "regions": regions,
             "costmap": costmap, "grid_map": grid_map}
    for name, path in files.items():
        setattr(request, name, os.fspath(path))
    with tempfile.TemporaryDirectory() as folder:
        place = map_files(Path(folder), dem, model, soil, region, crs, transform, study=study, settings=settings,
                          vehicle=vehicle, whole_vehicle=whole_vehicle, dataset=dataset, moisture=moisture, cone_index=cone_index,
                          max_speed_km_h=max_speed, height_unit=height_unit, flat_is_ground=flat_is_ground,
                          crossing_model=os.fspath(crossing_model), threads=threads)
        result: dict[str, Any] = with_gdal().plan_route(request, place)
    return result
