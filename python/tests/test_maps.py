import json
import subprocess

import numpy as np
import pytest

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
    subprocess.run([program, "map", "--model", "hmmwv", "--dem", tmp_path / "map/elevation.vrt", "--soil", "sandy loam", "--moisture",
                    "wet", "--set", "payload=500", "--max-speed", "40", "--out", tmp_path / "same"], check=True, capture_output=True)
    for layer in ("go.tif", "p_go.tif", "speed.tif"):
        assert (tmp_path / "map" / layer).read_bytes() == (tmp_path / "same" / layer).read_bytes(), layer
    assert "p_go" in made.layers


def test_a_written_raster_reads_back(made, hill):
    again = gonogo.read_raster(made.folder / "elevation.vrt")
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
