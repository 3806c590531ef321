"""Maps of a region."""
import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._files import PathLike, study_file
from ._model import Model

Soil = str | Mapping[str, float | tuple[float, float] | Mapping[str, Any]]


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


def carry_font() -> None:
    """Takes the font that a wheel carries, on a machine without any."""
    carried = Path(os.environ["GONOGO_SHARE"]) / "wheel" / "fonts.conf"
    if carried.is_file() and not Path("/etc/fonts/fonts.conf").is_file():
        os.environ.setdefault("FONTCONFIG_FILE", str(carried))


def with_gdal() -> Any:
    carry_font()
    try:
        from . import _map
    except ImportError as error:
        raise _core.InputError("maps need GDAL, which this build of gonogo was made without; build it with: pip install "
                               ". -C cmake.define.GONOGO_GDAL=ON -C cmake.define.GONOGO_PICTURES=ON") from error
    return _map


def read_raster(path: PathLike) -> Raster:
    """Band 1 of any raster that GDAL opens, on its own grid and in its own unit."""
    values, transform, crs = with_gdal().read_raster(os.fspath(path))
    return Raster(values, tuple(transform), crs)


class _Ground(NamedTuple):
    """Heights as somebody holds them: values may be masked; value = scale stored + offset."""

    values: Any
    crs: Any
    transform: Any
    nodata: float | None = None
    scale: float = 1
    offset: float = 0
    unit: str = ""


def _of_rasterio(dem: Any) -> _Ground:
    if dem.count >= 3:
        raise _core.InputError(f"dem: {dem.name}: has {dem.count} bands, which is a picture; give a raster of heights")
    return _Ground(dem.read(1, masked=True), dem.crs, dem.transform, None, dem.scales[0], dem.offsets[0],
                   dem.units[0] or "")


def _require_even(places: NDArray[Any], axis: Any) -> None:
    """Of an axis of cells: its steps are alike within 1 % of a cell."""
    steps = np.diff(np.asarray(places, dtype=np.float64))
    if not np.isfinite(steps).all():
        raise _core.InputError(f"dem: its coordinates {axis} are not all numbers; drop or fill those that are not")
    if steps.size and np.abs(steps - steps.mean()).max() > 0.01 * abs(steps.mean()):
        raise _core.InputError(f"dem: its coordinates {axis} have steps from {np.abs(steps).min():g} to {np.abs(steps).max():g}; "
                               "a map needs equal ones: bring it to a regular grid with interp or rio.reproject")


# Names of axes that rioxarray takes only with attributes of CF.
_AXES = (("lon", "lat"), ("longitude", "latitude"), ("easting", "northing"), ("X", "Y"))


def _with_axes(dem: Any) -> Any:
    for x, y in _AXES:
        if x in dem.dims and y in dem.dims:
            return dem.rename({x: "x", y: "y"})
    return dem


def _is_placed(dem: Any) -> bool:
    """Coordinates along both axes, or a transform beside them; without either, rioxarray counts cells of 1."""
    along = dem.rio.x_dim in dem.coords and dem.rio.y_dim in dem.coords
    return along or "GeoTransform" in getattr(dem.coords.get(dem.rio.grid_mapping), "attrs", {})


def _of_xarray(dem: Any) -> _Ground:
    """What rioxarray knows of an array: its axes by name, and nodata, scale and offset unless they are applied."""
    if hasattr(dem, "data_vars"):
        raise _core.InputError(f"dem: a Dataset of xarray; give one of its variables: {', '.join(str(name) for name in dem.data_vars)}")
    flat = _with_axes(dem.squeeze())
    if flat.ndim != 2:
        raise _core.InputError(f"dem: an array of {flat.ndim} dimensions {flat.dims}; choose one of each but x and y with isel")
    flat = flat.transpose(flat.rio.y_dim, flat.rio.x_dim)
    for axis in flat.dims:
        if axis in flat.coords:
            _require_even(flat[axis].values, axis)
    about = dem.attrs
    unit = str(about.get("units", ""))
    try:
        nodata, scale, offset = flat.rio.nodata, float(about.get("scale_factor", 1)), float(about.get("add_offset", 0))
    except ValueError as error:
        raise _core.InputError(f"dem: its attributes: {error}; _FillValue, scale_factor and add_offset are numbers") from None
    return _Ground(flat.values, flat.rio.crs, flat.rio.transform(recalc=True) if _is_placed(flat) else None, nodata, scale, offset,
                   "m" if unit.lower().startswith(("metre", "meter", "m ")) else unit)


def _heights(ground: _Ground) -> tuple[NDArray[np.float32], tuple[float, ...]]:
    """Row 0 in the north, columns eastward, NaN where there is no height; and the transform of that."""
    masked = np.ma.asarray(ground.values)
    if masked.ndim != 2:
        raise _core.InputError(f"dem: an array of {masked.ndim} dimensions; [row, column] is needed")
    if masked.size == 0:
        raise _core.InputError(f"dem: an array of {masked.shape[0]} x {masked.shape[1]} cells; a map needs at least 3 x 3")
    if masked.dtype.kind not in "iuf":
        raise _core.InputError(f"dem: an array of {masked.dtype}; heights are whole or real numbers")
    missing = np.ma.getmaskarray(masked).copy()
    if ground.nodata is not None and not np.isnan(ground.nodata):
        missing |= masked.data == ground.nodata
    values = masked.data.astype(np.float64) * ground.scale + ground.offset
    values[missing] = np.nan
    numbers = tuple(ground.transform)
    if len(numbers) < 6:
        raise _core.InputError(f"dem: transform {numbers}: has {len(numbers)} numbers; six are needed, as rasterio gives them")
    try:
        a, b, c, d, e, f = (float(x) for x in numbers[:6])
    except ValueError:
        raise _core.InputError(f"dem: transform {ground.transform!r}: six numbers are needed, as rasterio gives them") from None
    if (a, b, c, d, e, f) == (1, 0, 0, 0, 1, 0):
        raise _core.InputError("dem: its transform is the identity, which rasterio gives for a raster without a place on the ground; "
                               "give the transform of its cells")
    if b != 0 or d != 0 or a == 0 or e == 0:
        raise _core.InputError(f"dem: transform {(a, b, c, d, e, f)}: its rows do not run west to east; straighten it "
                               "with rasterio.warp.reproject")
    if e > 0:
        values, f, e = values[::-1], f + e * values.shape[0], -e
    if a < 0:
        values, c, a = values[:, ::-1], c + a * values.shape[1], -a
    return np.ascontiguousarray(values, dtype=np.float32), (a, b, c, d, e, f)


def _elevation_file(dem: Any, crs: Any, transform: Any, folder: Path) -> str:
    """A path as it is, and that of a rasterio dataset of a file; other datasets and arrays are written to the folder."""
    if isinstance(dem, (str, os.PathLike)):
        return os.path.abspath(dem)
    if hasattr(dem, "read") and hasattr(dem, "name"):  # rasterio
        if dem.mode == "r" and os.path.isfile(dem.name):  # what others hold may not be written yet
            return os.path.abspath(str(dem.name))
        ground = _of_rasterio(dem)
    elif hasattr(dem, "rio"):  # xarray with rioxarray
        ground = _of_xarray(dem)
    else:
        ground = _Ground(dem, crs, transform)
    ground = ground._replace(crs=crs if ground.crs is None else ground.crs,
                             transform=transform if ground.transform is None else ground.transform)
    if ground.crs is None or ground.transform is None:
        raise _core.InputError("dem: an array needs crs= and transform=, as rasterio gives them")
    values, north_up = _heights(ground)
    path = folder / "elevation.tif"
    code = isinstance(ground.crs, (int, np.integer))
    system = ground.crs.to_wkt() if hasattr(ground.crs, "to_wkt") else f"EPSG:{ground.crs}" if code else str(ground.crs)
    with_gdal().write_raster(str(path), values, north_up, system, ground.unit)
    return str(path.absolute())


def _cone_index(given: str | float | PathLike) -> dict[str, Any]:
    """Keys of a region file: an index everywhere, or a raster [psi]."""
    text = os.fspath(given) if isinstance(given, os.PathLike) else str(given)
    if not text:
        return {}
    if Path(text).is_file():
        return {"raster": {"role": "cone_index", "file": str(Path(text).absolute()), "unit": "psi", "source": "given in Python",
                           "licence": "as its file says"}}
    unit = "kPa" if text.endswith("kPa") else "psi"
    try:
        index = float(text.removesuffix(unit))
    except ValueError:
        raise _core.InputError(f"map: cone_index {text!r} is neither a raster nor a number; give a number [psi], or one such as "
                               "'414kPa'") from None
    return {"cone_index": {"fixed": index, "unit": unit, "source": "given in Python"}}


def _region_file(elevation: str, soil: Mapping[str, Any], cone_index: str | float | PathLike, name: str, folder: Path) -> str:
    """A region of one soil: numbers are fixed, pairs are ranges, dicts as in a region file."""
    values: dict[str, Any] = {}
    for variable, value in soil.items():
        entry = dict(value) if isinstance(value, Mapping) else {"range": list(value)} if isinstance(value, tuple) else {"fixed": value}
        values[variable] = {**entry, "source": "given in Python"}
    measured = _cone_index(cone_index)
    rasters = [{"role": "elevation", "file": elevation, "source": "given in Python", "licence": "as its file says"}]
    rasters += [measured.pop("raster")] if "raster" in measured else []
    region = {"schema": "gonogo/region/1", "region": name, "values": values, "rasters": rasters, **measured}
    path = folder / "region.json"
    path.write_text(json.dumps(region, indent=2))
    return str(path.absolute())


def _model_file(model: Model | PathLike) -> str:
    return os.fspath(model.path if isinstance(model, Model) else model)


def _place(dem: Any, soil: Soil | None, cone_index: str | float | PathLike, region: PathLike | None, study: PathLike | None,
           folder: Path, crs: Any, transform: Any) -> dict[str, Any]:
    """Members of MapFiles that say what is mapped."""
    if region is not None and dem is not None or region is dem is study:
        raise _core.InputError("map: give dem, or a region file; one of the two")
    if dem is None:
        if soil is not None:
            raise _core.InputError("map: the region file names its soil; leave soil out")
        given = {"cone_index": str(cone_index)}  # the program says where it belongs
        return given if region is None else {"region": region, **given}
    elevation = _elevation_file(dem, crs, transform, folder)
    if isinstance(soil, Mapping):
        return {"region": _region_file(elevation, soil, cone_index, Path(elevation).stem, folder)}
    index = os.fspath(cone_index) if isinstance(cone_index, os.PathLike) else str(cone_index)
    return {"dem": elevation, "soil": soil or "", "cone_index": index}


def map_files(folder: Path, dem: Any, model: Model | PathLike, soil: Soil | None, region: PathLike | None, crs: Any,
              transform: Any, *, study: PathLike | None, settings: Mapping[str, float] | None,
              cone_index: str | float | PathLike = "", **others: str | float | PathLike | None) -> Any:
    """MapFiles of the arguments that map() and route() share. `folder` takes what has to be written."""
    files = with_gdal().MapFiles()
    files.model = _model_file(model)
    files.set = [f"{name}={value!r}" for name, value in (settings or {}).items()]
    if study is not None:
        files.study = study_file(study)
    for name, value in {**_place(dem, soil, cone_index, region, study, folder, crs, transform), **others}.items():
        if value is not None:
            setattr(files, name, os.fspath(value) if isinstance(value, os.PathLike) else value)
    return files


def map(dem: Any = None, model: Model | PathLike = "", soil: Soil | None = None, *, out: PathLike,
        region: PathLike | None = None, crs: Any = None, transform: Any = None, vehicle: PathLike = "",
        whole_vehicle: PathLike = "", dataset: PathLike | None = None, study: PathLike | None = None, moisture: str = "",
        cone_index: str | float | PathLike = "", heading: str | float = "", settings: Mapping[str, float] | None = None, max_speed: float = 0, height_unit: str = "",
        flat_is_ground: bool = False, members: Iterable[PathLike] = (), colour_blind_safe: bool = False,
        crossing_model: PathLike = "", threads: int = 0) -> Map:
    """The Go/NoGo map of a region, as `gonogo map` makes it.

    dem: elevation [m]: a path, a rasterio dataset, an xarray array with rio, or a numpy array [row, column] with crs (a number
    is an EPSG code) and transform. soil: USDA texture, class of the USCS, name of a shipped soil, soil file or raster of
    textures, at a moisture ("dry", "moist", "wet") or any; or numbers of a test, as --soil takes them ("bevameter:...", "cone:index=414,soil=CL");
    or variable -> number, (low, high), or an entry of a region file such as {"fixed": 31,
    "test": "direct_shear", "stage": "peak"}; without it the soil may be anything. cone_index: of fine-grained soil [psi],
    "414kPa", or a raster [psi].
    region: in place of dem, a region file, which names its rasters. study: thresholds and mission values of its section
    "map"; its region, where neither dem nor region is given. out: folder of the map. vehicle: name or file; refused unless
    the model is of it. whole_vehicle: that a quarter vehicle stands for. dataset: trials, for layers of speed, slip and
    sinkage; by default those beside the model. heading: of class, P(go) and reason: "uphill", "worst", "best", or degrees
    clockwise from grid north. settings: values of the mission, such as payload=500. max_speed: never exceeded [km/h]; 0: the
    driveline's. height_unit: "m", "ft" or "us-ft"; "": as the raster says. flat_is_ground: large areas of exactly one height
    are ground, not unknown. members: bootstrap members of the model, whose spread widens the interval on P(go).
    crossing_model: of trials that cross ditches, for those of the region; by default the one that ships for the vehicle.
    threads: 0: all cores.
    """
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    files = map_files(folder, dem, model, soil, region, crs, transform, study=study, settings=settings, vehicle=vehicle,
                      whole_vehicle=whole_vehicle, dataset=dataset, moisture=moisture, cone_index=cone_index, heading=str(heading),
                      max_speed_km_h=max_speed, height_unit=height_unit, flat_is_ground=flat_is_ground,
                      colour_blind_safe=colour_blind_safe, crossing_model=os.fspath(crossing_model), threads=threads)
    files.set_members([os.fspath(member) for member in members])
    return Map(folder, with_gdal().make_map(files, str(folder)))


def compare(first: Map | PathLike, second: Map | PathLike, out: PathLike) -> dict[str, Any]:
    """Compares two maps of one region, as `gonogo compare` does. Writes rasters and figures to the folder `out`."""
    one, two = (os.fspath(m.folder if isinstance(m, Map) else m) for m in (first, second))
    result: dict[str, Any] = with_gdal().compare_maps(one, two, os.fspath(out))
    return result
