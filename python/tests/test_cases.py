"""Cases from public trackers, tests/data/cases: what the reports say is right, of the program as it is called there."""
import json
import shutil
import subprocess

import numpy as np
import pytest
import rasterio
import rasterio.vrt
import rioxarray
from sklearn.metrics import balanced_accuracy_score

import gonogo
from gonogo.sklearn import RbmClassifier


@pytest.fixture
def cases(root, tmp_path):
    """A copy, as commands write beside the input."""
    return shutil.copytree(root / "tests/data/cases", tmp_path / "cases")


def run(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def made_map(program, out, *words):
    """What the program says, and the counts of area.csv."""
    said = run(program, "map", "--model", "hmmwv", *words, "--out", out)
    return said, (out / "area.csv").read_text()


def soil_names(folder):
    """Of each cell [row, column]; nodata is empty."""
    region = json.loads((folder / "region.json").read_text())
    name = {soil["code"]: "+".join(sorted(soil["mixture"])) for soil in region["soils"]}
    codes = gonogo.read_raster(folder / "soil_class.tif")
    return np.vectorize(lambda code: name.get(code, ""))(codes.values), codes.transform


def test_case_01_a_rare_flag_is_learned():
    rng = np.random.default_rng(1)
    flag = np.zeros(2000)
    flag[:100] = 1
    rng.shuffle(flag)
    given = np.column_stack([flag, rng.normal(size=flag.size)])
    machine = RbmClassifier(epochs=100, random_state=1).fit(given, flag.astype(int))
    assert balanced_accuracy_score(flag, machine.predict(given)) == 1
    low, high = machine.predict_proba([[0, 0.0], [1, 0.0]])[:, 1]
    assert low < 0.1
    assert high > 0.8


def test_case_02_masks_nodata_and_scale_go_with_the_array(cases, tmp_path):
    folder = cases / "02-python-masked-array"
    given = dict(model="hmmwv", soil="sand", moisture="dry")
    wanted = gonogo.map(folder / "declared.tif", **given, out=tmp_path / "file")["go"]
    assert np.isnan(wanted).sum() >= 400
    array = rioxarray.open_rasterio(folder / "declared.tif").load()
    ways = {"axes": array.squeeze().transpose("x", "y"), "south first": array.sortby("y"),
            "scale": rioxarray.open_rasterio(folder / "decimetres.tif").load()}
    made = {name: gonogo.map(way, **given, out=tmp_path / name)["go"] for name, way in ways.items()}
    with rasterio.open(folder / "declared.tif") as file:
        made["masked"] = gonogo.map(file.read(1, masked=True), crs=file.crs, transform=file.transform, **given, out=tmp_path / "masked")["go"]
        with rasterio.vrt.WarpedVRT(file, crs="EPSG:32632") as warped:
            made["warped"] = gonogo.map(warped, **given, out=tmp_path / "warped")["go"]
    with rasterio.MemoryFile((folder / "declared.tif").read_bytes()) as memory, memory.open() as file:
        made["memory"] = gonogo.map(file, **given, out=tmp_path / "memory")["go"]
    for name, go in made.items():
        assert np.array_equal(go, wanted, equal_nan=True), name


def test_case_03_a_table_of_r_is_read(cases, program):
    folder = cases / "03-mukey-csv-of-soildb"
    run(program, "region", "make", folder, "--texture-error", 0)
    names, _ = soil_names(folder)
    half = names.shape[1] // 2
    assert set(np.unique(names[:, :half - 1])) == {"loam"}
    assert set(np.unique(names[:, half + 1:])) == {"sand"}
    water = gonogo.read_raster(folder / "water.tif").values
    assert np.allclose(water[:, :half - 1], 25 / 1.4, atol=0.01)
    assert np.isnan(water[:, half + 1:]).all()  # NA


def test_case_04_nad83_lies_under_nad83_2011(cases, program):
    folder = cases / "04-nad83-2011-and-gnatsgo"
    assert "up to 2.5 m" in run(program, "region", "make", folder, "--texture-error", 0)
    names, transform = soil_names(folder)
    rows, columns = names.shape
    # The raster of soils lies askew in its own projection: easting of each cell's middle on the map.
    with rasterio.open(folder / "soil_class.tif") as file, rasterio.vrt.WarpedVRT(file, crs="EPSG:6339", resampling=rasterio.enums.Resampling.nearest) as on_map:
        codes = on_map.read(1)
        east = np.array([[on_map.xy(r, c)[0] for c in range(on_map.width)] for r in range(on_map.height)])
    region = json.loads((folder / "region.json").read_text())
    code = {"+".join(soil["mixture"]): soil["code"] for soil in region["soils"]}
    assert set(code) == {"loam", "sand"}
    assert (codes == code["loam"]).sum() > 100
    assert east[codes == code["loam"]].max() < 560600 + 45
    assert east[codes == code["sand"]].min() > 560600 - 45
    assert rows * columns > 100
    assert abs(transform[0]) == pytest.approx(30, abs=1)


def test_case_05_soil_grids_lie_under_cgcs2000(cases, program):
    folder = cases / "05-cgcs2000-and-soilgrids"
    assert "up to 2.5 m" in run(program, "region", "make", folder, "--texture-error", 0)
    names, _ = soil_names(folder)
    assert set(np.unique(names)) <= {"loam", ""}
    assert (names == "loam").mean() > 0.9


def test_case_07_voids_of_a_cone_index_are_no_measurements(cases, program, tmp_path):
    folder = cases / "07-cone-index-void"
    _, declared = made_map(program, tmp_path / "declared", "--region", folder / "declared.json")
    for name in ("undeclared", "digits"):
        said, area = made_map(program, tmp_path / name, "--region", folder / f"{name}.json")
        assert "3600 cells" in said
        assert "no cone index" in said
        assert area == declared
        for layer in ("go.tif", "reason.tif"):
            one, two = (gonogo.read_raster(tmp_path / n / layer).values for n in (name, "declared"))
            assert np.array_equal(one, two, equal_nan=True)
    region = json.loads((folder / "undeclared.json").read_text())
    region["rasters"][1].update(role="moisture", file="water_undeclared.tif")
    del region["rasters"][1]["unit"]
    region.update(soil="silt loam", moisture={"dry": [0, 18], "moist": [18, 28], "wet": [28, 1000], "source": "made"})
    (folder / "water.json").write_text(json.dumps(region))
    done = subprocess.run([program, "map", "--model", "hmmwv", "--region", folder / "water.json", "--out", tmp_path / "water"],
                          capture_output=True, text=True, check=False)
    assert "-9999, which is no water content" in done.stdout + done.stderr or done.returncode == 2


def test_case_09_a_circle_closes_the_cells_of_its_straight_form(cases, program, tmp_path):
    folder = cases / "09-curved-obstacles"
    closed = []
    for name in ("circle", "circle_linear"):
        _, area = made_map(program, tmp_path / name, "--region", folder / f"{name}.json")
        closed += [int(line.split(",")[2]) for line in area.splitlines() if line.startswith("no_go,built_up")]
    # Cells of 10 m that a disc of 200 m in the middle of four touches, by their nearest points; the straight form has a
    # vertex on the corner of one more.
    offsets = np.arange(-25, 25) * 10
    nearest = np.maximum(np.maximum(offsets, -(offsets + 10)), 0)
    assert closed[0] == (np.hypot(nearest[:, None], nearest[None, :]) < 200).sum()
    assert 0 <= closed[1] - closed[0] <= 1


def test_case_12_a_site_grid_makes_a_map_without_a_globe(cases, program, tmp_path):
    said, _ = made_map(program, tmp_path / "map", "--dem", cases / "12-local-engineering-crs/site.tif", "--soil", "sand", "--moisture", "dry")
    assert "overlay.kml" in said  # why there is none
    made = {path.name for path in (tmp_path / "map").iterdir()}
    assert {"go.tif", "index.html", "map.png", "classes.gpkg"} <= made
    assert "overlay.kml" not in made
    assert gonogo.read_raster(tmp_path / "map/go.tif").transform[0] == 0.5


@pytest.mark.parametrize("heading", [45, 225])
def test_case_14_south_up_is_north_up_the_other_way(cases, program, tmp_path, heading):
    made = {}
    for name in ("north", "south"):
        made_map(program, tmp_path / name, "--dem", cases / f"14-south-up/{name}.tif", "--soil", "sand", "--moisture", "dry", "--heading", heading)
        made[name] = {layer: gonogo.read_raster(tmp_path / name / f"{layer}.tif").values for layer in ("go", "p_go", "speed")}
    for layer, values in made["north"].items():
        assert np.array_equal(values, made["south"][layer], equal_nan=True), layer
