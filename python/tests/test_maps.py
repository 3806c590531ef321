import datetime
import json
import pathlib
import sqlite3
import subprocess

import numpy as np
import pytest
import rasterio
import rasterio.vrt
import rioxarray
import xarray

import gonogo

SOIL = {"friction_angle": (25.0, 35.0), "cohesion": 2.0, "relative_density": 0.5, "payload": 0.0, "tyre_friction": 0.8,
        "bed_depth": 0.3, "commanded_speed": 3.0}
CELL, ROWS, COLUMNS = 10.0, 60, 40
TRANSFORM = (CELL, 0.0, 730000.0, 0.0, -CELL, 4368000.0 + ROWS * CELL)


@pytest.fixture(scope="module")
def hill():
    """A plain in the south that steepens to the north [row, column]."""
    slope = np.tan(np.radians(np.linspace(40, 0, ROWS)))
    height = np.cumsum((slope * CELL)[::-1])[::-1]
    return np.repeat(height[:, None], COLUMNS, axis=1).astype(np.float32)


@pytest.fixture(scope="module")
def soil(model):
    """Values inside what the model's trials sampled."""
    return {name: SOIL[name] if low <= np.mean(SOIL[name]) <= high else (low + high) / 2
            for name, (low, high) in model.sampled_ranges.items() if name in SOIL}


@pytest.fixture(scope="module")
def made(hill, soil, model, tmp_path_factory):
    return gonogo.map(hill, model, soil, out=tmp_path_factory.mktemp("map"), crs="EPSG:32610", transform=TRANSFORM)


def test_layers_are_arrays_on_the_ground(made, hill):
    p = made.raster("p_go")
    assert p.values.shape == hill.shape
    assert p.transform == TRANSFORM
    assert "32610" in p.crs or "UTM zone 10N" in p.crs
    inside = p.values[~np.isnan(p.values)]
    assert ((inside >= 0) & (inside <= 1)).all()
    south, north = np.nanmean(p.values[-20:-2]), np.nanmean(p.values[8:20])
    assert south > north
    assert sum(made.summary["share"].values()) == pytest.approx(1)
    assert set(np.unique(made["go"][~np.isnan(made["go"])])) <= {1, 2, 3, 4}


def test_the_program_makes_the_same_bits(made, model_file, program, tmp_path):
    subprocess.run([program, "map", "--model", model_file, "--region", made.folder / "region.json", "--out", tmp_path / "map"],
                   check=True, capture_output=True)
    for layer in ("go.tif", "p_go.tif", "reason.tif", "p_go_low.tif"):
        assert (tmp_path / "map" / layer).read_bytes() == (made.folder / layer).read_bytes(), layer


def test_a_shipped_model_and_a_named_soil(hill, program, tmp_path):
    files = dict(soil="sandy loam", moisture="wet", settings={"payload": 500.0}, max_speed=40.0)
    made = gonogo.map(hill, "hmmwv", **files, out=tmp_path / "map", crs="EPSG:32610", transform=TRANSFORM)
    subprocess.run([program, "map", "--model", "hmmwv", "--dem", tmp_path / "map/elevation.tif", "--soil", "sandy loam", "--moisture",
                    "wet", "--set", "payload=500", "--max-speed", "40", "--out", tmp_path / "same"], check=True, capture_output=True)
    for layer in ("go.tif", "p_go.tif", "speed.tif"):
        assert (tmp_path / "map" / layer).read_bytes() == (tmp_path / "same" / layer).read_bytes(), layer
    assert "p_go" in made.layers


def test_every_measure_of_a_soil_makes_the_map_that_the_program_makes(hill, program, tmp_path):
    place = dict(crs="EPSG:32610", transform=TRANSFORM, settings={"payload": 500.0})
    for k, (soil, index) in enumerate([("bevameter:n=1.1,k_c=0.99,k_phi=1528,c=1.04,phi=28,K=25", ""), ("SM", ""),
                                       ("cone:index=414,soil=CL,phi=20", ""), ("CL", 60)]):
        made = gonogo.map(hill, "hmmwv", soil, cone_index=index, out=tmp_path / f"made{k}", **place)
        given = ["--soil", soil] + (["--cone-index", str(index)] if index else [])
        subprocess.run([program, "map", "--model", "hmmwv", "--dem", made.folder / "elevation.tif", *given, "--set", "payload=500",
                        "--out", tmp_path / f"same{k}"], check=True, capture_output=True)
        assert (made.folder / "p_go.tif").read_bytes() == (tmp_path / f"same{k}/p_go.tif").read_bytes(), soil
    assert "60 psi" in (tmp_path / "made3/index.html").read_text()


def test_a_cone_index_beside_values_is_that_of_the_region(hill, tmp_path):
    place = dict(crs="EPSG:32610", transform=TRANSFORM)
    soil = {"friction_angle": {"fixed": 15, "test": "direct_shear", "stage": "peak"}, "cohesion": 5.0}
    soft = gonogo.map(hill, "hmmwv", soil, cone_index=5, out=tmp_path / "soft", **place)
    inputs = json.loads((tmp_path / "soft/map.json").read_text())["inputs"]
    assert inputs["cone_index_kPa"] == pytest.approx(5 * 6.894757, rel=1e-4)
    assert soft.summary["share"]["go"] == 0
    with pytest.raises(gonogo.InputError, match="neither a raster nor a number"):
        gonogo.map(hill, "hmmwv", soil, cone_index="soft", out=tmp_path / "word", **place)


def test_rasters_of_other_packages_make_the_same_map(made, hill, tmp_path):
    """A path, a dataset of rasterio and an array of xarray, each with a library of GDAL of its own in this process."""
    file = tmp_path / "hill.tif"
    place = dict(driver="GTiff", height=ROWS, width=COLUMNS, count=1, dtype="float32", crs="EPSG:32610",
                 transform=rasterio.Affine(*TRANSFORM))
    with rasterio.open(file, "w", **place) as raster:
        raster.write(hill, 1)
    maps = [gonogo.map(file, "hmmwv", "sand", moisture="wet", out=tmp_path / "path")]
    with rasterio.open(file) as raster:
        maps.append(gonogo.map(raster, "hmmwv", "sand", moisture="wet", out=tmp_path / "rasterio"))
    with rioxarray.open_rasterio(file) as array:
        maps.append(gonogo.map(array, "hmmwv", "sand", moisture="wet", out=tmp_path / "xarray"))
    for other in maps[1:]:
        for layer in ("go", "p_go", "reason"):
            assert np.array_equal(other[layer], maps[0][layer], equal_nan=True), layer
    with rasterio.open(tmp_path / "path" / "p_go.tif") as raster:
        assert np.array_equal(raster.read(1, masked=True).filled(np.nan), maps[0]["p_go"], equal_nan=True)
        assert raster.transform == rasterio.Affine(*maps[0].raster("p_go").transform)


def test_the_same_ground_handed_over_in_any_way_makes_the_same_map(hill, tmp_path):
    """Masks, nodata, scale, names of axes and their direction, of numpy, rasterio and xarray; some live in memory alone."""
    holes = hill.copy()
    holes[5:8, 6:11] = -32768
    place = dict(driver="GTiff", height=ROWS, width=COLUMNS, count=1, dtype="float32", crs="EPSG:32610", nodata=-32768,
                 transform=rasterio.Affine(*TRANSFORM))
    with rasterio.open(tmp_path / "holes.tif", "w", **place) as raster:
        raster.write(holes, 1)
    given = dict(model="hmmwv", soil="sand", moisture="dry")
    wanted = gonogo.map(tmp_path / "holes.tif", **given, out=tmp_path / "file")["p_go"]
    assert np.isnan(wanted).any()
    ways = {}
    with rasterio.open(tmp_path / "holes.tif") as raster:
        ways["masked"] = dict(dem=raster.read(1, masked=True), crs=raster.crs, transform=raster.transform)
        upside_down = raster.transform @ rasterio.Affine(1, 0, 0, 0, -1, ROWS)
        ways["south up"] = dict(dem=raster.read(1, masked=True)[::-1], crs=raster.crs, transform=upside_down)
    with rioxarray.open_rasterio(tmp_path / "holes.tif") as array:
        array.load()
    ways["nodata"] = dict(dem=array)
    ways["axes"] = dict(dem=array.squeeze().transpose("x", "y"))
    ways["ascending"] = dict(dem=array.sortby("y"))
    counts = array.astype("float64") / 0.5
    counts.attrs.update(scale_factor=0.5, add_offset=0.0, _FillValue=-65536.0)
    ways["scale"] = dict(dem=counts)
    with rasterio.MemoryFile((tmp_path / "holes.tif").read_bytes()) as memory, memory.open() as raster:
        made = {"in memory": gonogo.map(raster, **given, out=tmp_path / "memory")}
    with rasterio.open(tmp_path / "holes.tif") as raster, rasterio.vrt.WarpedVRT(raster, crs=raster.crs) as warped:
        made["warped"] = gonogo.map(warped, **given, out=tmp_path / "warped")
    for name, way in ways.items():
        made[name] = gonogo.map(**way, **given, out=tmp_path / name)
    for name, other in made.items():
        assert np.array_equal(other["p_go"], wanted, equal_nan=True), name
    with pytest.raises(gonogo.InputError, match="rows do not run west to east"):
        gonogo.map(hill, **given, out=tmp_path / "turned", crs="EPSG:32610", transform=(10, 1, 0, 1, -10, 0))


def test_an_array_that_is_no_ground_is_refused_and_names_of_axes_are_found(hill, tmp_path):
    given = dict(model="hmmwv", soil="sand", moisture="dry")
    place = dict(crs="EPSG:32610", transform=TRANSFORM)
    x, y = (TRANSFORM[2] + CELL * (np.arange(COLUMNS) + 0.5), TRANSFORM[5] - CELL * (np.arange(ROWS) + 0.5))
    array = xarray.DataArray(hill, dims=("y", "x"), coords={"y": y, "x": x}).rio.write_crs("EPSG:32610")
    uneven = array.assign_coords(x=np.where(np.arange(COLUMNS) > 20, x + 50, x))
    for words, dem, way in (
            ("complex64", hill.astype("complex64"), place), ("whole or real numbers", hill > 100, place),
            ("0 x 40 cells", hill[:0], place), ("six are needed", hill, dict(crs="EPSG:32610", transform=(1, 2, 3))),
            ("rasterio gives for a raster without a place", hill, dict(crs="EPSG:32610", transform=rasterio.Affine.identity())),
            ("six numbers are needed", hill, dict(crs="EPSG:32610", transform="10 0 500000")),
            ("longitudes and latitudes", hill, dict(crs="EPSG:32610", transform=(1e-4, 0, -122.5, 0, -1e-4, 39.5))),
            ("are not all numbers", array.assign_coords(x=np.where(np.arange(COLUMNS) == 3, np.nan, x)), {}),
            ("scale_factor and add_offset are numbers", array.assign_attrs(scale_factor="a"), {}),
            ("equal ones", uneven, {}), ("needs crs= and transform=", array.drop_vars(["x", "y"]), {}),
            ("a Dataset of xarray", array.to_dataset(name="z"), {}),
            ("choose one of each", xarray.concat([array, array], "time"), {})):
        with pytest.raises(gonogo.InputError, match=words):
            gonogo.map(dem, **given, **way, out=tmp_path / "refused")
    wanted = gonogo.map(hill, **given, **place, out=tmp_path / "plain")["p_go"]
    ways = {"named": (array.rename(x="easting", y="northing").transpose("easting", "northing"), {}),
            "placed by hand": (array.drop_vars(["x", "y"]), dict(transform=TRANSFORM)),
            "without system": (array.drop_vars("spatial_ref"), dict(crs="EPSG:32610")),
            "system by code": (array.drop_vars("spatial_ref"), dict(crs=32610))}
    for name, (dem, way) in ways.items():
        assert np.array_equal(gonogo.map(dem, **given, **way, out=tmp_path / name)["p_go"], wanted, equal_nan=True), name
    file = dict(driver="GTiff", height=ROWS, width=COLUMNS, dtype="float32", crs="EPSG:32610", transform=rasterio.Affine(*TRANSFORM))
    with rasterio.open(tmp_path / "open.tif", "w+", count=1, **file) as raster:
        raster.write(hill, 1)
        assert np.array_equal(gonogo.map(raster, **given, out=tmp_path / "open")["p_go"], wanted, equal_nan=True)
    with rasterio.MemoryFile() as memory, memory.open(count=3, **file) as picture:
        with pytest.raises(gonogo.InputError, match="3 bands"):
            gonogo.map(picture, **given, out=tmp_path / "picture")


def test_a_written_raster_reads_back(made, hill):
    again = gonogo.read_raster(made.folder / "elevation.tif")
    assert np.array_equal(again.values, hill)
    assert again.transform == TRANSFORM


def test_a_route_avoids_what_it_cannot_cross(made, model, tmp_path):
    start, end = (730050.0, 4368050.0), (730350.0, 4368080.0)
    found = gonogo.route(model=model, region=made.folder / "region.json", start=start, end=end, costs=["shortest"],
                         lines=tmp_path / "way.geojson")
    way = found["routes"][0]
    assert way["found"]
    assert 290 < way["length_m"] < 500
    line = json.loads((tmp_path / "way.geojson").read_text())
    assert line["features"]


START, END, VIA = (730050.0, 4368050.0), (730350.0, 4368080.0), (730200.0, 4368180.0)


def test_a_route_passes_by_and_keeps_out(made, model, tmp_path):
    """Lengths against straight lines on the plain, and against one another."""
    wall = [[[730190, 4367900], [730210, 4367900], [730210, 4368140], [730190, 4368140], [730190, 4367900]]]
    (tmp_path / "wall.geojson").write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:32610"}},
        "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": wall}}]}))

    def length(**options):
        found = gonogo.route(model=model, region=made.folder / "region.json", start=START, end=END, costs=["shortest"], **options)
        return found["routes"][0]["length_m"]

    straight = np.hypot(END[0] - START[0], END[1] - START[1])
    assert length() == pytest.approx(straight, abs=15)  # places are cells of 10 m
    by = sum(np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in ((START, VIA), (VIA, END)))
    assert length(via=[VIA]) == pytest.approx(by, abs=20)
    around = sum(np.hypot(b[0] - a[0], b[1] - a[1]) for a, b in ((START, (730200, 4368150)), ((730200, 4368150), END)))
    assert length(avoid=tmp_path / "wall.geojson") == pytest.approx(around, abs=25)
    assert straight * 1.02 < length(any_angle=False) < straight * 1.09


def test_files_of_routes_are_the_programs(made, program, tmp_path):
    """With the shipped model: its measures date the track."""
    departure = datetime.datetime(2026, 5, 1, 8, tzinfo=datetime.timezone(datetime.timedelta(hours=2)))
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    for folder in (ours, theirs):
        folder.mkdir()
    names = {"lines": "way.gpx", "reach": "reach.tif", "costmap": "cost.yaml", "grid_map": "grid.tif"}
    region = made.folder / "region.json"
    gonogo.route(model="hmmwv", region=region, start=START, end=END, via=[VIA], costs=["safest"], departure=departure,
                 **{option: ours / name for option, name in names.items()})
    places = [f"--{name}={x},{y}" for name, (x, y) in (("from", START), ("to", END), ("via", VIA))]
    options = {"lines": "--out", "reach": "--reach", "costmap": "--costmap", "grid_map": "--grid-map"}
    subprocess.run([program, "route", "--model", "hmmwv", "--region", region, *places, "--cost", "safest",
                    "--departure", "2026-05-01T06:00:00Z",
                    *(part for option, name in names.items() for part in (options[option], theirs / name))],
                   check=True, capture_output=True)
    for name in (*names.values(), "cost.pgm"):
        assert (ours / name).read_bytes() == (theirs / name).read_bytes(), name
    assert "2026-05-01T06:00:00Z" in (ours / "way.gpx").read_text()


def test_polygons_of_reach_and_regions(made, model, tmp_path):
    found = gonogo.route(model=model, region=made.folder / "region.json", start=START, costs=["shortest"],
                         isochrones=tmp_path / "bands.gpkg", interval=100.0, regions=tmp_path / "regions.gpkg")
    assert {pathlib.Path(file).name for file in found["files"]} >= {"bands.gpkg", "regions.gpkg"}
    with sqlite3.connect(tmp_path / "bands.gpkg") as file:
        table, = file.execute("SELECT table_name FROM gpkg_contents").fetchone()
        bands = file.execute(f'SELECT count(*) FROM "{table}"').fetchone()[0]
    assert bands >= 3  # the plain is 400 m long


def test_a_model_of_other_trials_answers_for_no_ditch(hill, tmp_path):
    with pytest.raises(gonogo.InputError, match="no trial of it crosses a ditch"):
        gonogo.map(hill, "hmmwv", crs="EPSG:32610", transform=TRANSFORM, soil="loam", crossing_model="hmmwv",
                   out=tmp_path / "map")


def test_map_options_reach_the_program(hill, model_file, program, tmp_path):
    """Heights in feet, a heading, and colours."""
    files = dict(crs="EPSG:32610", transform=TRANSFORM, soil="loam", moisture="dry", heading=45, height_unit="ft",
                 flat_is_ground=True, colour_blind_safe=True)
    made = gonogo.map(hill, "hmmwv", **files, out=tmp_path / "map")
    subprocess.run([program, "map", "--model", "hmmwv", "--dem", tmp_path / "map/elevation.tif", "--soil", "loam", "--moisture", "dry",
                    "--heading", "45", "--height-unit", "ft", "--flat-is-ground", "--colour-blind-safe", "--out", tmp_path / "same"],
                   check=True, capture_output=True)
    for layer in ("go.tif", "p_go.tif", "go.qml"):
        assert (tmp_path / "map" / layer).read_bytes() == (tmp_path / "same" / layer).read_bytes(), layer
    level = gonogo.map(hill, "hmmwv", **{**files, "height_unit": "m"}, out=tmp_path / "metres")
    assert np.nanmean(made["p_go"]) > np.nanmean(level["p_go"])  # a third as steep


def test_errors_of_routes_say_what_to_do(made, model):
    place = dict(model=model, region=made.folder / "region.json", start=START, end=END)
    with pytest.raises(gonogo.InputError, match="time zone"):
        gonogo.route(**place, departure=datetime.datetime(2026, 5, 1))
    with pytest.raises(gonogo.InputError, match="departure"):
        gonogo.route(**place, departure="tomorrow")
    with pytest.raises(gonogo.InputError, match="no_such"):
        gonogo.route(**place, avoid="no_such.geojson")
    with pytest.raises(gonogo.InputError, match="nothing is asked for"):
        gonogo.route(model=model, region=made.folder / "region.json")


def test_errors_say_what_to_do(hill, model, tmp_path):
    with pytest.raises(gonogo.InputError, match="crs= and transform="):
        gonogo.map(hill, model, SOIL, out=tmp_path)
    with pytest.raises(gonogo.InputError, match="one of the two"):
        gonogo.map(model=model, out=tmp_path)
    with pytest.raises(gonogo.InputError, match="leave soil out"):
        gonogo.map(model=model, soil="sand", region="region.json", out=tmp_path)
    with pytest.raises(gonogo.InputError, match="sandy loam"):
        gonogo.map(hill, "hmmwv", "sandy lom", out=tmp_path, crs="EPSG:32610", transform=TRANSFORM)
    with pytest.raises(gonogo.InputError, match="no_such.tif"):
        gonogo.map("no_such.tif", model, SOIL, out=tmp_path)
    with pytest.raises(gonogo.InputError, match="no finished map"):
        gonogo.Map(tmp_path / "nothing")
