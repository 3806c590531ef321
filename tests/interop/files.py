#!/usr/bin/env python3
"""Rasters and vectors that packages of Debian and PyPI ship as test data, read by gonogo and by GDAL's own Python.

  files.py <program gonogo>      the system's Python, with python3-gdal; exit status 77: the packages cannot be fetched

A raster either becomes a map whose cells have a class exactly where GDAL's masked elevations have a slope, or is refused in one
sentence that names it. The shapes of a vector file close the cells that GDAL rasterises, or the file is refused so. Prints a
table of counts.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

import numpy
from osgeo import gdal, ogr, osr

gdal.UseExceptions()
DEBIAN = ("r-cran-raster", "r-cran-sf", "r-cran-stars", "r-cran-terra", "python3-xarray")
PYPI = ("pyogrio==0.13.0",)
RASTERS = (".tif", ".nc", ".grd", ".img", ".asc")
VECTORS = (".shp", ".gpkg", ".geojson", ".gml")
CONTRACT = pathlib.Path(__file__).resolve().parents[2] / "configs/schema/variables.json"
NO_CLASS = 255  # of go.tif
WIDEST = 3e5  # half a ground [m]
SIDE = 60  # cells of the ground under a vector file


def fetch(folder):
    """Unpacks the packages; False where one cannot be had."""
    download = ["apt-get", "download", "-qq", *DEBIAN]
    if subprocess.run(download, cwd=folder, stderr=subprocess.DEVNULL).returncode:
        subprocess.run(["apt-get", "update", "-qq"])  # lists may be missing, or older than the packages
        if subprocess.run(download, cwd=folder, stderr=subprocess.DEVNULL).returncode:
            return False
    for package in folder.glob("*.deb"):
        subprocess.run(["dpkg", "-x", package, folder], check=True)
    pip = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary", ":all:", "-d", folder, *PYPI]
    if subprocess.run(pip, stderr=subprocess.DEVNULL).returncode:
        return False
    for wheel in folder.glob("*.whl"):
        zipfile.ZipFile(wheel).extractall(folder)
    return True


def run(program, *words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, timeout=120)


def check_refusal(ending, file):
    """One sentence that names the file, and nothing else."""
    said = [line for line in ending.stderr.splitlines() if line.startswith("gonogo: ")]
    assert ending.returncode == 2, f"{file}: exit status {ending.returncode}: {ending.stderr}"
    assert len(said) == 1 and file.name in said[0], f"{file}: said {ending.stderr!r}"


def has_slope(file):
    """Cells whose elevation and that of all eight neighbours is known, by GDAL's mask."""
    raster = gdal.Open(str(file))  # a band does not keep its raster alive
    band = raster.GetRasterBand(1)
    known = band.GetMaskBand().ReadAsArray() > 0
    known &= numpy.isfinite(band.ReadAsArray().astype(float))
    inner = numpy.zeros_like(known)
    rows, columns = known.shape
    if rows > 2 and columns > 2:
        inner[1:-1, 1:-1] = True
        for row in range(3):
            for column in range(3):
                inner[1:-1, 1:-1] &= known[row:rows - 2 + row, column:columns - 2 + column]
    return inner


def layer(out, name):
    """Values of a map's layer."""
    raster = gdal.Open(str(out / f"{name}.tif"))
    return raster.ReadAsArray()


def check_raster(program, file, out):
    """Whether it was mapped."""
    ending = run(program, "map", "--model", "hmmwv", "--dem", file, "--soil", "sand", "--moisture", "dry", "--flat-is-ground",
                 "--out", out)
    if ending.returncode:
        check_refusal(ending, file)
        return False
    mapped = layer(out, "go") != NO_CLASS
    expected = has_slope(file)
    if mapped.shape != expected.shape:  # degrees, which the map puts on a grid in metres
        assert mapped.any() == expected.any(), f"{file}: {mapped.sum()} cells mapped of {expected.sum()} known"
        return True
    different = int((mapped != expected).sum())
    assert different == 0, f"{file}: {different} of {mapped.size} cells differ from GDAL's mask"
    return True


def flat_shapes(file):
    """The first layer in metres: its own system, or the UTM zone of its first shape. None for tables,
    single points and maps of the world."""
    shapes = ogr.Open(str(file))
    first = shapes.GetLayer(0)
    if first.GetGeomType() == ogr.wkbNone or first.GetSpatialRef() is None or first.GetFeatureCount() == 0:
        return None
    system = first.GetSpatialRef()
    longest = None  # edge in the file's units: straight edges in degrees are no straight lines on the ground
    if system.IsGeographic():
        longest = 0.01
        shape = first.GetNextFeature()  # it owns its geometry
        middle = shape.GetGeometryRef().Centroid()
        system = osr.SpatialReference()
        system.ImportFromEPSG((32600 if middle.GetY() > 0 else 32700) + int(middle.GetX() // 6) + 31)
    try:
        flat = gdal.VectorTranslate("", str(file), format="Memory", layers=[first.GetName()],
                                    geometryType="CONVERT_TO_LINEAR", dstSRS=system.ExportToWkt(),
                                    segmentizeMaxDist=longest)
    except RuntimeError:  # of all the world: no zone holds it
        return None
    west, east, south, north = flat.GetLayer(0).GetExtent()
    return flat if max(east - west, north - south) > 0 else None


def ground_under(flat, folder):
    """Ground around the first shape, twice as wide as the layer, or as a zone of UTM allows."""
    layer = flat.GetLayer(0)
    west, east, south, north = layer.GetExtent()
    size = min(max(east - west, north - south), WIDEST)
    shape = layer.GetNextFeature()
    middle = shape.GetGeometryRef().Centroid()
    layer.ResetReading()
    cell = 2 * size / SIDE
    ground = gdal.GetDriverByName("GTiff").Create(str(folder / "ground.tif"), SIDE, SIDE, 1, gdal.GDT_Float32)
    ground.SetGeoTransform((middle.GetX() - size, cell, 0, middle.GetY() + size, 0, -cell))
    ground.SetProjection(layer.GetSpatialRef().ExportToWkt())
    rows, columns = numpy.mgrid[:SIDE, :SIDE]
    ground.GetRasterBand(1).WriteArray(100 + 0.001 * numpy.sin(columns) * numpy.cos(rows))
    ground.FlushCache()
    return ground


def closed_by_gdal(ground, flat):
    """Cells that shapes touch."""
    burnt = gdal.GetDriverByName("MEM").Create("", SIDE, SIDE, 1, gdal.GDT_Byte)
    burnt.SetGeoTransform(ground.GetGeoTransform())
    burnt.SetProjection(ground.GetProjection())
    gdal.RasterizeLayer(burnt, [1], flat.GetLayer(0), burn_values=[1], options=["ALL_TOUCHED=TRUE"])
    return burnt.ReadAsArray() > 0


def check_vector(program, file, folder):
    """"mapped", "refused" or "no ground": nothing lies in the plane."""
    flat = flat_shapes(file)
    if flat is None:
        return "no ground"
    ground = ground_under(flat, folder)
    given = {name: {"fixed": value, "source": "made"} for name, value in
             (("friction_angle", 32), ("cohesion", 2), ("relative_density", 0.5))}
    origin = {"source": "made", "licence": "CC0"}
    region = {"schema": "gonogo/region/1", "region": "interop", "rasters": [{"role": "elevation", "file": "ground.tif", **origin}],
              "obstacles": [{"kind": "buildings", "file": str(file), **origin}], "values": given, "texture": "sand"}
    (folder / "region.json").write_text(json.dumps(region))
    out = folder / "map"
    ending = run(program, "map", "--model", "hmmwv", "--region", folder / "region.json", "--out", out)
    if ending.returncode:
        check_refusal(ending, file)
        return "refused"
    go, reason = layer(out, "go"), layer(out, "reason")
    built_up = next(row["code"] for row in json.loads(CONTRACT.read_text())["reasons"] if row["name"] == "built_up")
    inner = (slice(1, -1), slice(1, -1))
    different = int((closed_by_gdal(ground, flat)[inner] != (reason == built_up)[inner]).sum())
    assert go.shape == (SIDE, SIDE) and different <= SIDE // 10, f"{file}: {different} cells differ from GDAL's rasterisation"
    return "mapped"


def main(program):
    folder = pathlib.Path(tempfile.mkdtemp())
    if not fetch(folder):
        print("interop: the packages cannot be fetched; nothing was checked")
        return 77
    counts = {"raster": {}, "vector": {}}
    for number, file in enumerate(sorted(p for p in folder.rglob("*") if p.suffix in RASTERS + VECTORS)):
        place = folder / f"case{number}"
        place.mkdir()
        if file.suffix in RASTERS:
            kind, what = "raster", "mapped" if check_raster(program, file, place / "map") else "refused"
        else:
            kind, what = "vector", check_vector(program, file, place)
        counts[kind][what] = counts[kind].get(what, 0) + 1
        print(f"{what:10} {re.sub('.*site-library/|.*dist-packages/', '', str(file.relative_to(folder)))}")
    for kind, of in counts.items():
        print(f"{kind}s: " + ", ".join(f"{count} {what}" for what, count in sorted(of.items())))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
