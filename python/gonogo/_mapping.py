"""Maps and routes of a region."""
import json
import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._files import PathLike
from ._model import Model

Soil = str | Mapping[str, float | tuple[float, float]]
Place = tuple[float, float]


class Raster(NamedTuple):
    """values: [row, column], row 0 in the north, NaN: nodata. transform: as of rasterio. crs: WKT2 or EPSG:<n>."""

    values: NDArray[np.float32]
    transform: tuple[float, float, float, float, float, float]
    crs: str


class Map:
    """A map's folder: summary, and layers as arrays."""

    def __init__(self, folder: PathLike, summary: dict[str, Any] | None = None) -> None:
        self.folder = Path(folder)
        self.summary = summary or {}
        if not (self.folder / "map.json").is_file():
            raise _core.InputError(f"{self.folder}: holds no finished map")

    @property
    def layers(self) -> list[str]:
        """Names that raster() reads: "go", "p_go", "reason", "p_go_low", ..."""
        return sorted(path.stem for path in self.folder.glob("*.tif"))

    def raster(self, layer: str) -> Raster:
        """A layer with its place on the ground."""
        if layer not in self.layers:
            raise _core.InputError(f"{layer}: the map has no such layer; it has: {', '.join(self.layers)}")
        return read_raster(self.folder / f"{layer}.tif")

    def __getitem__(self, layer: str) -> NDArray[np.float32]:
        return self.raster(layer).values


def _with_gdal() -> Any:
    try:
        from . import _map
    except ImportError as error:
        raise _core.InputError("maps need GDAL, which this build of gonogo was made without; build it with: pip install "
                               ". -C cmake.define.GONOGO_GDAL=ON -C cmake.define.GONOGO_PICTURES=ON") from error
    return _map


def read_raster(path: PathLike) -> Raster:
    """Band 1 of any raster that GDAL opens, on its own grid and in its own unit."""
    values, transform, crs = _with_gdal().read_raster(os.fspath(path))
    return Raster(values, tuple(transform), crs)


def _elevation_file(dem: Any, crs: Any, transform: Any, folder: Path) -> str:
    """A path as it is; a rasterio dataset's path; an array, written to the folder."""
    if isinstance(dem, (str, os.PathLike)):
        return os.path.abspath(dem)
    if hasattr(dem, "read") and hasattr(dem, "name"):  # rasterio
        return os.path.abspath(str(dem.name))
    if hasattr(dem, "rio"):  # xarray with rioxarray
        crs, transform, dem = dem.rio.crs, dem.rio.transform(), dem.squeeze().values
    if crs is None or transform is None:
        raise _core.InputError("dem: an array needs crs= and transform=, as rasterio gives them")
    values = np.ascontiguousarray(dem, dtype="<f4")
    if values.ndim != 2:
        raise _core.InputError(f"dem: an array of {values.ndim} dimensions; [row, column] is needed")
    values.tofile(folder / "elevation.f32")
    a, b, c, d, e, f = (float(x) for x in tuple(transform)[:6])
    path = folder / "elevation.vrt"
    path.write_text(_VRT.format(rows=values.shape[0], columns=values.shape[1], row_bytes=4 * values.shape[1],
                                crs=escape(crs.to_wkt() if hasattr(crs, "to_wkt") else str(crs)),
                                transform=", ".join(repr(x) for x in (c, a, b, f, d, e))))
    return str(path.absolute())


# A raster of GDAL over plain numbers.
_VRT = """<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}">
  <SRS>{crs}</SRS>
  <GeoTransform>{transform}</GeoTransform>
  <VRTRasterBand dataType="Float32" band="1" subClass="VRTRawRasterBand">
    <SourceFilename relativeToVRT="1">elevation.f32</SourceFilename>
    <ImageOffset>0</ImageOffset>
    <PixelOffset>4</PixelOffset>
    <LineOffset>{row_bytes}</LineOffset>
    <ByteOrder>LSB</ByteOrder>
    <NoDataValue>nan</NoDataValue>
  </VRTRasterBand>
</VRTDataset>
"""


def _region_file(elevation: str, soil: Mapping[str, float | tuple[float, float]], name: str, folder: Path) -> str:
    """A region of one soil: numbers are fixed, pairs are ranges."""
    values: dict[str, Any] = {}
    for variable, value in soil.items():
        entry = {"range": list(value)} if isinstance(value, tuple) else {"fixed": value}
        values[variable] = {**entry, "source": "given in Python"}
    region = {"schema": "gonogo/region/1", "region": name, "values": values, "rasters": [
        {"role": "elevation", "file": elevation, "source": "given in Python", "licence": "as its file says"}]}
    path = folder / "region.json"
    path.write_text(json.dumps(region, indent=2))
    return str(path.absolute())


def _model_file(model: Model | PathLike) -> str:
    return os.fspath(model.path if isinstance(model, Model) else model)


def _place(dem: Any, soil: Soil | None, region: PathLike | None, folder: Path, crs: Any, transform: Any) -> dict[str, str]:
    """Arguments of MapFiles that say what is mapped."""
    if (region is None) == (dem is None):
        raise _core.InputError("map: give dem, or a region file; one of the two")
    if region is not None:
        if soil is not None:
            raise _core.InputError("map: the region file names its soil; leave soil out")
        return {"region": os.fspath(region)}
    elevation = _elevation_file(dem, crs, transform, folder)
    if isinstance(soil, Mapping):
        return {"region": _region_file(elevation, soil, Path(elevation).stem, folder)}
    return {"dem": elevation, "soil": soil or ""}


def _request(dem: Any, model: Model | PathLike, soil: Soil | None, region: PathLike | None, folder: Path, crs: Any,
             transform: Any, vehicle: str, dataset: PathLike | None, moisture: str, heading: str,
             settings: Mapping[str, float] | None, max_speed: float) -> Any:
    place = _place(dem, soil, region, folder, crs, transform)
    return _with_gdal().MapFiles(_model_file(model), **place, vehicle=vehicle,
                                 dataset=os.fspath(dataset) if dataset is not None else "", moisture=moisture,
                                 heading=heading, settings=[f"{name}={value!r}" for name, value in (settings or {}).items()],
                                 max_speed_km_h=max_speed)


def map(dem: Any = None, model: Model | PathLike = "", soil: Soil | None = None, *, out: PathLike,
        region: PathLike | None = None, crs: Any = None, transform: Any = None, vehicle: str = "",
        dataset: PathLike | None = None, moisture: str = "", heading: str = "", settings: Mapping[str, float] | None = None,
        max_speed: float = 0) -> Map:
    """The Go/NoGo map of a region, as `gonogo map` makes it.

    dem: elevation [m]: a path, a rasterio dataset, an xarray array with rio, or a numpy array [row, column] with crs and
    transform. soil: USDA texture or name of a shipped soil, at a moisture ("dry", "moist", "wet") or any; or variable ->
    number or (low, high), in the units of the contract; without it the soil may be anything. region: in place of dem, a
    region file, which names its rasters. out: folder of the map. vehicle: name or file; refused unless the model is of it.
    dataset: trials, for layers of speed, slip and sinkage; by default those beside the model. settings: values of the
    mission, such as payload=500. max_speed: never exceeded [km/h]; 0: the driveline's.
    """
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    files = _request(dem, model, soil, region, folder, crs, transform, vehicle, dataset, moisture, heading, settings, max_speed)
    return Map(folder, json.loads(_with_gdal().make_map(files, str(folder))))


def route(dem: Any = None, model: Model | PathLike = "", soil: Soil | None = None, *, start: Place | None = None,
          end: Place | None = None, costs: Iterable[str] = ("safest",), lines: PathLike = "", reach: PathLike = "",
          region: PathLike | None = None, crs: Any = None, transform: Any = None, vehicle: str = "",
          dataset: PathLike | None = None, moisture: str = "", heading: str = "", settings: Mapping[str, float] | None = None,
          max_speed: float = 0) -> dict[str, Any]:
    """Routes over a region, as `gonogo route` plans them.

    start, end: (x, y) in the region's coordinate system. costs: "shortest", "fastest", "safest", "least-energy". lines:
    .gpkg, .geojson or .gpx to write; reach: .tif of the min cost from `start`. Region as in map().
    """
    with tempfile.TemporaryDirectory() as name:
        files = _request(dem, model, soil, region, Path(name), crs, transform, vehicle, dataset, moisture, heading, settings,
                         max_speed)
        result: dict[str, Any] = json.loads(_with_gdal().plan_route(files, start, end, list(costs), os.fspath(lines), os.fspath(reach)))
    return result


def compare(first: Map | PathLike, second: Map | PathLike, out: PathLike) -> dict[str, Any]:
    """Compares two maps of one region, as `gonogo compare` does. Writes rasters and figures to the folder `out`."""
    one, two = (os.fspath(m.folder if isinstance(m, Map) else m) for m in (first, second))
    result: dict[str, Any] = json.loads(_with_gdal().compare_maps(one, two, os.fspath(out)))
    return result
