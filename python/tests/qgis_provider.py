#!/usr/bin/env python3
"""The QGIS plug-in, headless, as the plug-in manager installs its zip: map, route and comparison of a hill, refusals, and
cancelling.

  qgis_provider.py <program gonogo>      Python of the system, with the package python3-qgis
"""
import math
import os
import pathlib
import struct
import sys
import tempfile
import unittest

os.environ["QT_QPA_PLATFORM"] = "offscreen"
ROOT = pathlib.Path(__file__).resolve().parents[2]
PLUGINS = pathlib.Path(tempfile.mkdtemp())  # of a user's profile
sys.path[:0] = [str(PLUGINS), "/usr/share/qgis/python/plugins", "/usr/share/qgis/python", str(ROOT / "scripts")]

from osgeo import gdal, osr  # noqa: E402
from qgis.core import (QgsApplication, QgsPointXY, QgsProcessingContext, QgsProcessingException,  # noqa: E402
                       QgsProcessingFeedback, QgsProject, QgsRasterLayer, QgsVectorLayer)

CELL, ROWS, COLUMNS, WEST, NORTH = 10.0, 60, 40, 730000.0, 4368600.0


def write_hill(path):
    """A plain in the south that steepens to 40 degrees in the north."""
    raster = gdal.GetDriverByName("GTiff").Create(str(path), COLUMNS, ROWS, 1, gdal.GDT_Float32)
    raster.SetGeoTransform((WEST, CELL, 0, NORTH, 0, -CELL))
    crs = osr.SpatialReference()
    crs.ImportFromEPSG(32610)
    raster.SetProjection(crs.ExportToWkt())
    height, heights = 0.0, []
    for row in reversed(range(ROWS)):
        height += CELL * math.tan(math.radians(40 * (ROWS - 1 - row) / (ROWS - 1)))
        heights.append(height)
    for row in range(ROWS):
        line = bytes().join(struct.pack("<f", heights[ROWS - 1 - row]) for _ in range(COLUMNS))
        raster.WriteRaster(0, row, COLUMNS, 1, line, buf_type=gdal.GDT_Float32)


class Feedback(QgsProcessingFeedback):
    """Keeps what was said; cancels at the first word when asked to."""

    def __init__(self, cancel=False):
        super().__init__(False)
        self.said, self.cancel_at_once = [], cancel

    def pushInfo(self, text):
        self.said.append(text)

    def pushCommandInfo(self, text):
        self.said.append(text)
        if self.cancel_at_once:
            self.cancel()


class Provider(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        import processing
        from pyplugin_installer.unzip import unzip
        from qgis_zip import pack

        unzip(str(pack(pathlib.Path(tempfile.mkdtemp()) / "gonogo.zip")), str(PLUGINS))
        from gonogo import classFactory

        cls.plugin = classFactory(None)
        cls.plugin.initProcessing()
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        write_hill(cls.folder / "hill.tif")
        cls.place = {"DEM": str(cls.folder / "hill.tif"), "MODEL": "hmmwv", "SOIL": "sandy loam", "MOISTURE": 3, "SETTINGS": "payload=500"}
        cls.processing = processing

    def run_algorithm(self, name, parameters, feedback=None):
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        return self.processing.run("gonogo:" + name, parameters, feedback=feedback or Feedback(), context=context)

    def test_the_plugin_manager_accepts_it(self):
        from pyplugin_installer.installer_data import plugins

        found = plugins.getInstalledPlugin("gonogo", str(PLUGINS / "gonogo"), readOnly=False)
        self.assertEqual((found["name"], found["error"]), ("gonogo", ""), found["error_details"])
        self.assertTrue(pathlib.Path(found["icon"]).is_file())
        self.assertTrue((PLUGINS / "gonogo/LICENSE").is_file())
        self.assertEqual([entry.name for entry in PLUGINS.iterdir()], ["gonogo"])

    def test_it_offers_three_algorithms(self):
        provider = QgsApplication.processingRegistry().providerById("gonogo")
        self.assertEqual(sorted(a.id() for a in provider.algorithms()), ["gonogo:compare", "gonogo:map", "gonogo:route"])

    def test_a_map_then_a_comparison(self):
        maps = {}
        for name, moisture in (("wet", 3), ("dry", 1)):
            maps[name] = str(self.folder / name)
            made = self.run_algorithm("map", {**self.place, "MOISTURE": moisture, "OUTPUT": maps[name]})
            layer = QgsRasterLayer(made["CLASS"], "class")
            self.assertTrue(layer.isValid())
            self.assertEqual((layer.width(), layer.height()), (COLUMNS, ROWS))
            self.assertTrue(pathlib.Path(made["PAGE"]).is_file())
            self.assertEqual(layer.renderer().type(), "paletted", "the style beside the layer is taken")
        p = QgsRasterLayer(maps["dry"] + "/p_go.tif", "p")
        middle = WEST + CELL * COLUMNS / 2
        at = [p.dataProvider().sample(QgsPointXY(middle, NORTH - CELL * row), 1)[0] for row in (10, 55)]
        self.assertLess(at[0], at[1], "the steep north is harder")
        made = self.run_algorithm("compare", {"FIRST": maps["dry"], "SECOND": maps["wet"], "OUTPUT": str(self.folder / "both")})
        self.assertTrue(QgsRasterLayer(made["CHANGE"], "change").isValid())

    def test_a_route(self):
        ways = str(self.folder / "ways.gpkg")
        made = self.run_algorithm("route", {**self.place, "START": f"{WEST + 50},{NORTH - 550} [EPSG:32610]",
                                            "END": f"{WEST + 350},{NORTH - 520} [EPSG:32610]", "COSTS": [3], "OUTPUT": ways})
        self.assertEqual(made["FOUND"], 1)
        layer = QgsVectorLayer(ways, "ways")
        self.assertTrue(layer.isValid())
        length = sum(f.geometry().length() for f in layer.getFeatures() if "weakest stretch" not in f["name"])
        self.assertGreater(length, 290)
        self.assertLess(length, 500)

    def test_a_refusal_is_the_sentence_of_the_program(self):
        for changed, said in (({"SOIL": "sandy lom"}, "sandy loam"), ({"MODEL": "humvee"}, "hmmwv"), ({"SETTINGS": "paylod=1"}, "payload")):
            with self.assertRaisesRegex(QgsProcessingException, said):
                self.run_algorithm("map", {**self.place, **changed, "OUTPUT": str(self.folder / "refused")})
            self.assertFalse((self.folder / "refused" / "map.json").exists())

    def test_it_can_be_cancelled(self):
        with self.assertRaisesRegex(QgsProcessingException, "cancelled"):
            self.run_algorithm("map", {**self.place, "OUTPUT": str(self.folder / "cancelled")}, Feedback(cancel=True))
        self.assertFalse((self.folder / "cancelled" / "map.json").exists())

    def test_a_missing_program_is_named(self):
        program = os.environ["GONOGO_PROGRAM"]
        os.environ["GONOGO_PROGRAM"] = "/nowhere/gonogo"
        try:
            with self.assertRaisesRegex(QgsProcessingException, "/nowhere/gonogo"):
                self.run_algorithm("map", {**self.place, "OUTPUT": str(self.folder / "none")})
        finally:
            os.environ["GONOGO_PROGRAM"] = program


if __name__ == "__main__":
    os.environ["GONOGO_PROGRAM"] = sys.argv.pop(1)
    application = QgsApplication([], False)
    application.initQgis()
    from processing.core.Processing import Processing

    Processing.initialize()
    result = unittest.main(verbosity=2, exit=False).result
    os._exit(0 if result.wasSuccessful() else 1)  # QGIS 3.22 may crash when it takes itself down
