"""Tables and arrays as nobody should hand them over: each is read as what it says, or refused in a sentence; none reads as something else."""
import subprocess

import numpy as np
import pandas
import pyproj
import pytest
import rasterio
import rioxarray  # noqa: F401  gives arrays their .rio
import xarray
from rasterio.transform import Affine, from_origin

import gonogo
from gonogo import _mapping

HEADER = "slope_along,slope_across,friction_angle,cohesion,relative_density,bed_depth,commanded_speed,payload,tyre_friction\n"
ROW = "10,0,32,2,0.5,0.2,2,500,0.9\n"
PLAIN = HEADER + ROW
SEMICOLONS = PLAIN.replace(",", ";")

SAME = {  # tables that say what the plain one says
    "plus": PLAIN.replace("10,", "+10,", 1), "trailing point": PLAIN.replace("10,", "10.,", 1), "exponent": PLAIN.replace("500", "5e2"),
    "blanks": PLAIN.replace(",", " , "), "tabs": PLAIN.replace(",", "\t"), "semicolons": SEMICOLONS, "decimal commas": SEMICOLONS.replace(".", ","),
    "sep line": "sep=;\n" + SEMICOLONS, "byte order mark": "\ufeff" + PLAIN, "quoted header": '"' + HEADER.strip().replace(",", '","') + '"\n' + ROW,
    "quoted row": HEADER + '"' + ROW.strip().replace(",", '","') + '"\n', "old Macintosh": PLAIN.replace("\n", "\r"),
    "Windows": PLAIN.replace("\n", "\r\n"), "twice returned": PLAIN.replace("\n", "\r\r\n"), "no last line end": PLAIN.strip(),
    "remark": HEADER + "# note\n" + ROW, "blank lines": HEADER + "\n\n" + ROW + "\n\n", "another order": ",".join(HEADER.strip().split(",")[::-1]) + "\n"
    + ",".join(ROW.strip().split(",")[::-1]) + "\n", "trailing separator": HEADER + ROW.strip() + ",\n", "zeros": PLAIN.replace("10,", "0010.000,", 1)}

REFUSED = {  # and what the refusal says
    "hexadecimal": (PLAIN.replace("10,", "0x0A,", 1), "0x0A"), "thousands": (PLAIN.replace("500", '"1,000"'), "1,000"),
    "per cent": (PLAIN.replace("0.5", "50%"), "50%"), "unit": (PLAIN.replace("10,", "10 deg,", 1), "10 deg"),
    "Fortran": (PLAIN.replace("32", "3.2D1"), "3.2D1"), "typographic minus": (PLAIN.replace("10,", "\u221210,", 1), "line 2"),
    "no-break space": (PLAIN.replace("32", "\u00a032"), "line 2"), "full width": (PLAIN.replace("32", "\uff13\uff12"), "line 2"),
    "infinity": (PLAIN.replace("32", "inf"), "inf"), "overflow": (PLAIN.replace("32", "1e999"), "1e999"), "date": (PLAIN.replace("10,", "10-Jan,", 1), "10-Jan"),
    "formula": (PLAIN.replace("10,", "=5+5,", 1), "=5"), "truth": (PLAIN.replace("10,", "TRUE,", 1), "TRUE"),
    "column twice": (PLAIN.replace("cohesion", "slope_along"), "appears twice"), "other case": (PLAIN.replace("slope_across", "Slope_Across"), "did you mean"),
    "unknown column": (HEADER.strip() + ",note\n" + ROW.strip() + ",x\n", "note"), "short row": (HEADER + "10,0,32\n", "3 cells"),
    "long row": (HEADER + ROW.strip() + ",1,2\n", "11 cells"), "no header": (ROW + ROW, "no variable"), "empty": ("", "holds no points"),
    "header again": (PLAIN + HEADER + ROW, "line 3"), "open quote": (HEADER + '"' + ROW, "a quote begins"), "pipes": (PLAIN.replace(",", "|"), "no variable"),
    "only blanks": (PLAIN.replace(",", " "), "no variable"), "mixed decimals": (SEMICOLONS.replace("0.5", "0,5"), "0,5"),
    "out of range": (PLAIN.replace("32", "320"), "lies outside"), "unit in header": (PLAIN.replace("angle", "angle [deg]"), "did you mean"),
    "no text": (PLAIN.replace("32", "3\x002"), "bytes of value 0"), "UTF-16": (PLAIN.encode("utf-16"), "UTF-16"),
    "spreadsheet": (b"PK\x03\x04" + b"x" * 100, "as .xlsx"), "Latin-1": ((HEADER.strip() + ",h\xfc\n" + ROW.strip() + ",1\n").encode("latin-1"), "no variable")}


def answered(program, folder, table):
    """Whether it was taken; the columns of the answer, or what the refusal says."""
    path = folder / "points.csv"
    path.write_bytes(table if isinstance(table, bytes) else table.encode())
    done = subprocess.run([program, "infer", "--model", "hmmwv", "--csv", path, "--out", folder / "answers.csv"], capture_output=True,
                          check=False)
    if done.returncode:
        said = [line for line in done.stderr.decode(errors="replace").splitlines() if line.startswith("gonogo: ")]
        assert done.returncode == 2 and len(said) == 1
        return False, said[0]
    rows = pandas.read_csv(folder / "answers.csv", sep=None, engine="python")
    return True, [rows[name].tolist() for name in ("p_go", "go", "slow_go")]


@pytest.fixture(scope="module")
def plain(program, tmp_path_factory):
    taken, answers = answered(program, tmp_path_factory.mktemp("plain"), PLAIN)
    assert taken and len(answers[0]) == 1
    return answers


@pytest.mark.parametrize("name", SAME)
def test_a_table_in_another_dress_says_the_same(program, tmp_path, plain, name):
    assert answered(program, tmp_path, SAME[name]) == (True, plain)


@pytest.mark.parametrize("name", REFUSED)
def test_a_table_that_says_nothing_certain_is_refused_in_a_sentence(program, tmp_path, name):
    taken, said = answered(program, tmp_path, REFUSED[name][0])
    assert not taken and REFUSED[name][1] in said


TRANSFORM, CRS, SIDE = from_origin(500000, 4400000, 10, 10), "EPSG:32610", 16
GROUND = (100 + 0.5 * np.mgrid[:SIDE, :SIDE][1] + 0.3 * np.sin(np.mgrid[:SIDE, :SIDE][0])).astype("float32")
HOLED = np.where(np.mgrid[:SIDE, :SIDE][0] < 4, np.nan, GROUND)
X, Y = 500005 + 10.0 * np.arange(SIDE), 4399995 - 10.0 * np.arange(SIDE)
ARRAY = xarray.DataArray(GROUND, dims=("y", "x"), coords={"x": X, "y": Y}).rio.write_crs(CRS)
PLACE = dict(crs=CRS, transform=TRANSFORM)

GROUNDS = {  # (given, where, heights that a map must see)
    "lists": (GROUND.tolist(), PLACE, GROUND), "other byte order": (GROUND.astype(">f4"), PLACE, GROUND),
    "Fortran's order": (np.asfortranarray(GROUND), PLACE, GROUND), "a view": (np.repeat(GROUND, 2, 0)[::2], PLACE, GROUND),
    "backward view": (GROUND[::-1].copy()[::-1], PLACE, GROUND), "doubles": (GROUND.astype("float64"), PLACE, GROUND),
    "halves": (GROUND.astype("float16"), PLACE, GROUND.astype("float16")), "bytes": (GROUND.astype("uint8"), PLACE, GROUND.astype("uint8")),
    "int64": (GROUND.astype("int64"), PLACE, GROUND.astype("int64")), "matrix": (np.matrix(GROUND), PLACE, GROUND),
    "frame": (pandas.DataFrame(GROUND), PLACE, GROUND), "memory": (memoryview(GROUND), PLACE, GROUND),
    "masked, filled with 0": (np.ma.array(GROUND, mask=np.isnan(HOLED), fill_value=0), PLACE, HOLED),
    "mask over nonsense": (np.ma.array(np.where(np.isnan(HOLED), 7777, GROUND), mask=np.isnan(HOLED)), PLACE, HOLED),
    "six numbers": (GROUND, dict(crs=CRS, transform=tuple(TRANSFORM)[:6]), GROUND), "a code": (GROUND, dict(crs=32610, transform=TRANSFORM), GROUND),
    "numpy's code": (GROUND, dict(crs=np.int32(32610), transform=TRANSFORM), GROUND),
    "pyproj": (GROUND, dict(crs=pyproj.CRS(32610), transform=TRANSFORM), GROUND),
    "rasterio": (GROUND, dict(crs=rasterio.crs.CRS.from_epsg(32610), transform=TRANSFORM), GROUND),
    "south up": (GROUND[::-1], dict(crs=CRS, transform=Affine(10, 0, 500000, 0, 10, 4400000 - 10 * SIDE)), GROUND),
    "westward": (GROUND[:, ::-1], dict(crs=CRS, transform=Affine(-10, 0, 500000 + 10 * SIDE, 0, -10, 4400000)), GROUND),
    "xarray": (ARRAY, {}, GROUND), "xarray, x first": (ARRAY.transpose("x", "y"), {}, GROUND),
    "xarray, x backward": (ARRAY.isel(x=slice(None, None, -1)), {}, GROUND), "xarray, y backward": (ARRAY.isel(y=slice(None, None, -1)), {}, GROUND),
    "xarray, one band": (ARRAY.expand_dims(band=1), {}, GROUND), "xarray, fill value": (ARRAY.where(~np.isnan(HOLED), -99).rio.write_crs(CRS)
                                                                                      .assign_attrs(_FillValue=-99.0), {}, HOLED),
    "xarray, missing value": (ARRAY.where(~np.isnan(HOLED), -99).rio.write_crs(CRS).assign_attrs(missing_value=-99.0), {}, HOLED),
    "xarray, packed": (((ARRAY - 100) * 4).rio.write_crs(CRS).assign_attrs(scale_factor=0.25, add_offset=100.0), {}, GROUND)}

NO_GROUND = {  # (given, where, what the refusal says)
    "truths": (GROUND > 104, PLACE, "whole or real numbers"), "objects": (GROUND.astype(object), PLACE, "whole or real numbers"),
    "texts": (GROUND.astype(str), PLACE, "whole or real numbers"), "dates": (GROUND.astype("int64").astype("datetime64[s]"), PLACE, "whole or real"),
    "records": (np.zeros((9, 9), dtype=[("z", "f4")]), PLACE, "whole or real numbers"), "complex": (GROUND.astype("complex64"), PLACE, "whole or real"),
    "one band in front": (GROUND[None], PLACE, "3 dimensions"), "a row": (GROUND.ravel(), PLACE, "1 dimensions"), "a number": (5, PLACE, "0 dimensions"),
    "nothing": (np.empty((0, 5)), PLACE, "0 x 5 cells"), "no place": (GROUND, {}, "needs crs= and transform="),
    "GDAL's order": (GROUND, dict(crs=CRS, transform=TRANSFORM.to_gdal()), "do not run west to east"),
    "identity": (GROUND, dict(crs=CRS, transform=Affine.identity()), "is the identity"), "turned": (GROUND, dict(crs=CRS, transform=Affine.rotation(5)), "straighten"),
    "three numbers": (GROUND, dict(crs=CRS, transform=(1, 2, 3)), "six are needed"), "text": (GROUND, dict(crs=CRS, transform="10 0 500000"), "six numbers"),
    "no such system": (GROUND, dict(crs="EPSG:999999", transform=TRANSFORM), "no coordinate system"),
    "no name": (GROUND, dict(crs="", transform=TRANSFORM), "no coordinate system"),
    "coordinates NaN": (ARRAY.assign_coords(x=np.where(np.arange(SIDE) == 3, np.nan, X)), {}, "are not all numbers"),
    "coordinates uneven": (ARRAY.assign_coords(x=np.where(np.arange(SIDE) > 9, X + 50, X)), {}, "equal ones"),
    "coordinates alike": (ARRAY.assign_coords(x=np.full(SIDE, X[0])), {}, "west to east"),
    "two times": (xarray.concat([ARRAY, ARRAY], "time"), {}, "choose one of each"), "a Dataset": (ARRAY.to_dataset(name="z"), {}, "a Dataset of xarray"),
    "scale a text": (ARRAY.assign_attrs(scale_factor="a"), {}, "are numbers"), "fill value a text": (ARRAY.assign_attrs(_FillValue="x"), {}, "are numbers")}


def handed_over(given, crs=None, transform=None, *, folder):
    """The raster that a map of it reads."""
    return gonogo.read_raster(_mapping._elevation_file(given, crs, transform, folder))


@pytest.mark.parametrize("name", GROUNDS)
def test_an_array_in_another_dress_is_the_same_ground(tmp_path, name):
    given, where, wanted = GROUNDS[name]
    raster = handed_over(given, **where, folder=tmp_path)
    assert np.array_equal(raster.values, np.asarray(wanted, dtype="float32"), equal_nan=True)
    assert raster.transform == pytest.approx(tuple(TRANSFORM)[:6])
    assert pyproj.CRS(raster.crs).to_epsg() == 32610


@pytest.mark.parametrize("name", NO_GROUND)
def test_an_array_that_is_no_ground_is_refused_in_a_sentence(tmp_path, name):
    given, where, said = NO_GROUND[name]
    with pytest.raises(gonogo.InputError, match=said):
        handed_over(given, **where, folder=tmp_path)
