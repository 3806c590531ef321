"""Routes through the program: places between, areas to avoid, departure, files for robots, and bad input. Files are read by
others' parsers: GeoPackage by sqlite3, YAML by PyYAML, PGM by Pillow, NetCDF by netCDF4, GeoTIFF by rasterio."""
import json
import sqlite3
import struct
import subprocess
import xml.etree.ElementTree as ElementTree

import netCDF4
import numpy as np
import PIL.Image
import pytest
import rasterio
import rasterio.warp
import yaml

import gonogo

CELL, ROWS, COLUMNS, WEST, SOUTH = 10.0, 60, 40, 730000.0, 4368000.0
NORTH = SOUTH + ROWS * CELL
START, END, UPHILL = "730055,4368055", "730345,4368255", "730345,4368335"
GO, SLOW_GO, NO_GO, UNKNOWN = 1, 2, 3, 4


@pytest.fixture(scope="module")
def ground(model, tmp_path_factory):
    """A plain in the south that steepens to the north, mapped."""
    slope = np.tan(np.radians(np.linspace(40, 0, ROWS)))
    height = np.repeat(np.cumsum((slope * CELL)[::-1])[::-1][:, None], COLUMNS, axis=1).astype(np.float32)
    soil = {name: (low + high) / 2 for name, (low, high) in model.sampled_ranges.items() if not name.startswith("slope")}
    soil.update(friction_angle=(30.0, 36.0))
    return gonogo.map(height, model, soil, out=tmp_path_factory.mktemp("ground"), crs="EPSG:32610",
                      transform=(CELL, 0.0, WEST, 0.0, -CELL, NORTH))


@pytest.fixture(scope="module")
def route(program, model_file, dataset_file, ground):
    def run(*words, status=0):
        done = subprocess.run([program, "route", "--model", model_file, "--dataset", dataset_file, "--region",
                               ground.folder / "region.json", *words], capture_output=True, text=True)
        assert done.returncode == status, done.stderr
        return json.loads(done.stdout) if status == 0 and "--json" in words else done.stderr
    return run


def line_of(file, name):
    """Corners of a line [east, north] from a GeoPackage: its header, then well-known binary."""
    [(blob,)] = sqlite3.connect(file).execute("select geom from routes where name = ?", (name,)).fetchall()
    assert blob[:2] == b"GP"
    start = 8 + {0: 0, 1: 32, 2: 48, 3: 48, 4: 64}[blob[3] >> 1 & 7]
    order = "<" if blob[start] else ">"
    kind, count = struct.unpack_from(order + "II", blob, start + 1)
    assert kind == 2
    return np.array(struct.unpack_from(f"{order}{2 * count}d", blob, start + 9)).reshape(-1, 2)


def dense(line, step=1.0):
    """Places along a line, `step` metres apart."""
    parts = [a + np.linspace(0, 1, 2 + int(np.hypot(*(b - a)) / step))[:, None] * (b - a) for a, b in zip(line, line[1:])]
    return np.concatenate(parts)


def test_the_way_passes_the_places_between_in_their_order(route, tmp_path):
    via = ["730300,4368080", "730100,4368200"]
    words = ("--from", START, "--to", END, "--cost", "shortest", "--json")
    found = route(*words, "--via", *via, "--out", tmp_path / "way.gpkg")["routes"][0]
    line = dense(line_of(tmp_path / "way.gpkg", "shortest"))
    at = []
    for text in via:
        away = np.hypot(*(line - np.array([float(x) for x in text.split(",")])).T)
        assert away.min() < CELL
        at.append(away.argmin())
    assert at == sorted(at)
    assert found["length_m"] > 1.3 * route(*words)["routes"][0]["length_m"]


def polygon(tmp_path, corners, name="avoid.geojson"):
    (tmp_path / name).write_text(json.dumps({
        "type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::32610"}},
        "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [corners]}}]}))
    return tmp_path / name


def test_the_way_keeps_out_of_polygons(route, tmp_path):
    west, east, south, north = WEST + 150, WEST + 250, SOUTH + 20, SOUTH + 200
    area = polygon(tmp_path, [[west, south], [east, south], [east, north], [west, north], [west, south]])
    words = ("--from", START, "--to", "730345,4368055", "--cost", "shortest", "--json")
    free = route(*words, "--out", tmp_path / "free.gpkg")["routes"][0]
    around = route(*words, "--avoid", area, "--out", tmp_path / "around.gpkg")["routes"][0]
    inside = lambda line: ((line > (west, south)) & (line < (east, north))).all(axis=1).any()
    assert inside(dense(line_of(tmp_path / "free.gpkg", "shortest")))
    assert not inside(dense(line_of(tmp_path / "around.gpkg", "shortest")))
    assert around["length_m"] > free["length_m"] + 10


def test_a_track_starts_at_its_departure_and_takes_the_time_of_the_route(route, tmp_path):
    found = route("--from", START, "--to", END, "--cost", "fastest", "--departure", "2026-05-01T06:00:00Z", "--out",
                  tmp_path / "way.gpx", "--json")["routes"][0]
    points = ElementTree.parse(tmp_path / "way.gpx").findall(".//{*}trkpt")
    times = np.array([point.find("{*}time").text.rstrip("Z") for point in points], dtype="datetime64[ms]")
    assert times[0] == np.datetime64("2026-05-01T06:00:00")
    assert (np.diff(times) > np.timedelta64(0)).all()
    assert (times[-1] - times[0]) / np.timedelta64(1, "s") == pytest.approx(found["time_s"], abs=1)


def test_a_track_stays_within_a_quarter_of_a_cell_a_metre_and_five_seconds_of_the_whole_way(route, ground, tmp_path):
    """The way from its GeoPackage, heights from the raster, times from the costs per metre of the eight headings."""
    words = ("--from", START, "--to", UPHILL, "--cost", "fastest", "--eight-directions")
    route(*words, "--out", tmp_path / "way.gpkg", "--grid-map", tmp_path / "costs.tif")
    route(*words, "--out", tmp_path / "way.gpx")
    line = line_of(tmp_path / "way.gpkg", "fastest")
    with rasterio.open(tmp_path / "costs.tif") as file:
        layer = dict(zip(file.descriptions, file.read().astype(float)))
    with rasterio.open(ground.folder / "elevation.tif") as file:
        height = file.read(1).astype(float)

    def cell(place):
        return int((NORTH - place[1]) / CELL), int((place[0] - WEST) / CELL)

    way = [(line[0], height[cell(line[0])], 0.0)]  # place, height, time at centres of cells and half way between them
    for a, b in zip(line, line[1:]):
        steps, heading = round(max(abs(b - a)) / CELL), round(np.degrees(np.arctan2(*(b - a)))) % 360
        for k in range(steps):
            c, d = a + (b - a) * k / steps, a + (b - a) * (k + 1) / steps
            half, (e, f) = np.hypot(*(d - c)) / 2, (cell(c), cell(d))
            crossed = height[e[0], e[1]], height[e[0], f[1]], height[f[0], e[1]], height[f[0], f[1]]  # bilinear
            way.append(((c + d) / 2, np.mean(crossed), way[-1][2] + half * layer[f"cost_{heading:03d}"][e]))
            way.append((d, height[f], way[-1][2] + half * layer[f"cost_{heading:03d}"][f]))
    place, ground_height, seconds = (np.array(part) for part in zip(*way))
    points = ElementTree.parse(tmp_path / "way.gpx").findall(".//{*}trkpt")
    lon, lat, told = (np.array([read(point) for point in points]) for read in (
        lambda p: float(p.get("lon")), lambda p: float(p.get("lat")), lambda p: float(p.find("{*}ele").text)))
    time = np.array([p.find("{*}time").text.rstrip("Z") for p in points], dtype="datetime64[ms]")
    time = (time - time[0]) / np.timedelta64(1, "s")
    kept = np.array(rasterio.warp.transform("EPSG:4326", "EPSG:32610", lon, lat)).T
    index = [np.hypot(*(place - point).T).argmin() for point in kept]
    assert (np.diff(index) > 0).all() and index[0] == 0 and index[-1] == len(place) - 1
    assert 2 < len(points) < len(place) / 2
    assert np.hypot(*(place[index] - kept).T).max() < 0.01  # eight digits of a degree are 1 mm
    assert told == pytest.approx(ground_height[index], abs=0.01)
    assert time == pytest.approx(seconds[index], abs=0.01)
    along = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(place, axis=0).T))])
    east, north, up, later = (np.interp(along, along[index], values) for values in (*kept.T, told, time))
    assert np.hypot(east - place[:, 0], north - place[:, 1]).max() <= CELL / 4 + 0.01
    assert np.abs(up - ground_height).max() <= 1 + 0.01
    assert np.abs(later - seconds).max() <= 5 + 0.01


def test_the_chance_to_get_through_is_told_with_the_weakest_stretch(route):
    found = route("--from", START, "--to", END, "--cost", "safest,shortest", "--json")["routes"]
    for way in found:
        assert 0 <= way["chance"] <= 1
        assert way["chance"] >= 1 - way["stuck_places"] - 1e-9
        if way["chance"] < 1:
            weakest = way["weakest"]
            assert 0 <= weakest["from_km"] < weakest["to_km"] <= way["length_m"] / 1000 + 1e-6
            assert 0 < weakest["stuck"] <= 1 - way["chance"] + 1e-9


def test_a_costmap_is_what_public_parsers_and_the_map_say(route, ground, tmp_path):
    route("--cost", "shortest", "--costmap", tmp_path / "map.yaml")
    head = yaml.safe_load((tmp_path / "map.yaml").read_text())
    assert head["image"] == "map.pgm" and head["mode"] == "raw" and head["negate"] == 0
    assert head["resolution"] == pytest.approx(CELL)
    assert head["origin"] == pytest.approx([WEST, SOUTH, 0.0])
    assert 0 < head["free_thresh"] < head["occupied_thresh"] < 1
    image = PIL.Image.open(tmp_path / "map.pgm")
    assert image.format == "PPM" and image.mode == "L"
    cost, best = np.asarray(image), ground.raster("go_best").values
    assert cost.shape == (ROWS, COLUMNS)
    assert set(np.unique(cost)) <= {*range(99), 100, 255}
    assert (cost[np.isnan(best)] == 255).all()
    assert not (best[cost < 100] == NO_GO).any()  # no heading is no-go everywhere here; test_pipeline_map has such cells
    assert np.isin(best[cost < 100], (GO, SLOW_GO)).mean() > 0.9  # 45 degrees are not among the map's 36 headings
    assert (cost < 100).sum() > 300
    # The shortest way costs 1 / cos of the slope; the south is level.
    per_metre = head["gonogo"]["at_0"] + cost / 98 * (head["gonogo"]["at_98"] - head["gonogo"]["at_0"])
    assert per_metre[-3, 5] == pytest.approx(1, abs=0.02)


def test_layers_for_grid_map_are_what_public_parsers_and_the_map_say(route, ground, tmp_path):
    route("--cost", "shortest", "--grid-map", tmp_path / "layers.nc")
    route("--cost", "shortest", "--grid-map", tmp_path / "layers.tif")
    with rasterio.open(tmp_path / "layers.tif") as file:
        assert file.count == 17 and file.crs.to_epsg() == 32610
        assert file.transform[:6] == pytest.approx((CELL, 0, WEST, 0, -CELL, NORTH))
        bands = {name: file.read(i + 1) for i, name in enumerate(file.descriptions)}
    with netCDF4.Dataset(tmp_path / "layers.nc") as file:
        by_name = {getattr(variable, "long_name", ""): variable for variable in file.variables.values()}
        for name, band in bands.items():
            layer = np.ma.filled(by_name[name][:].astype(np.float32), np.nan)
            if file.variables["y"][0] < file.variables["y"][-1]:  # rows from the south
                layer = layer[::-1]
            np.testing.assert_array_equal(layer, band, err_msg=name)
    with rasterio.open(ground.folder / "elevation.tif") as file:
        np.testing.assert_array_equal(bands["elevation"], file.read(1))
    best, worst = ground.raster("go_best").values, ground.raster("go_worst").values
    for heading in range(0, 360, 45):
        passes, cost = bands[f"go_{heading:03}"], bands[f"cost_{heading:03}"]
        assert (np.isfinite(cost) == (passes == 1)).all()
        assert not (passes[best == NO_GO] == 1).any()
        assert (passes[np.isin(worst, (GO, SLOW_GO))] == 1).all()
    assert (bands["go_180"] == 1).sum() > (bands["go_000"] == 1).sum()  # downhill is easier


@pytest.mark.parametrize("words, told", [
    (["--from", START, "--to", END, "--via", "730300"], ["--via", "730300", "easting,northing"]),
    (["--from", START, "--to", END, "--via", "0,0"], ["--via 0,0", "outside the elevation raster"]),
    (["--from", START, "--via", "730300,4368080"], ["--to is missing"]),
    (["--from", START, "--to", END, "--avoid", "none.geojson"], ["none.geojson"]),
    (["--from", START, "--to", END, "--departure", "2026-13-01T06:00:00Z"], ["--departure", "2026-13-01", "2026-05-01T06:00:00Z"]),
    (["--from", START, "--to", END, "--departure", "today"], ["--departure", "today"]),
    (["--costmap", "map.png"], ["--costmap", "map.png", ".yaml"]),
    (["--grid-map", "map.bag"], ["map.bag", ".nc"]),
    (["--from", START, "--to", END, "--cost", "scenic"], ["scenic", "least-energy"]),
])
def test_bad_input_is_refused_in_one_sentence(route, words, told, tmp_path):
    words = [str(tmp_path / word) if word.startswith(("none.", "map.")) else word for word in words]
    said = route(*words, "--out", tmp_path / "way.gpkg", status=2) if "--from" in words else route(*words, status=2)
    assert all(part in said for part in told), said
    assert len([line for line in said.strip().splitlines() if not line.startswith("map: ")]) == 1  # beside progress
    assert not list(tmp_path.iterdir())


def test_areas_to_avoid_are_polygons_and_leave_the_start_free(route, tmp_path):
    (tmp_path / "point.geojson").write_text(json.dumps({"type": "Point", "coordinates": [-120.0, 39.4]}))
    said = route("--from", START, "--to", END, "--avoid", tmp_path / "point.geojson", status=2)
    assert "point.geojson" in said and "polygon" in said
    everywhere = polygon(tmp_path, [[WEST, SOUTH], [WEST + 400, SOUTH], [WEST + 400, NORTH], [WEST, NORTH], [WEST, SOUTH]])
    said = route("--from", START, "--to", END, "--avoid", everywhere, status=2)
    assert "--from 730055" in said and "polygon to avoid" in said.replace("polygon to \navoid", "polygon to avoid")
