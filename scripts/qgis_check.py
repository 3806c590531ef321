#!/usr/bin/python3
"""How QGIS shows a map: scripts/qgis_check.py <folder for pictures> <map folder or file> ...

Opens every GeoTIFF and GeoPackage as QGIS does when it is dragged into a project, with the style that lies beside or
inside it, and checks what came: coordinate system, renderer, class names and colours (against GDAL's colour table), name
of the band. Draws each layer with its legend into <folder for pictures>. By hand only; QGIS is no dependency of the project:

    apt-get install --no-install-recommends python3-qgis python3-gdal
    scripts/qgis_check.py out/qgis out/demo/map routes.gpkg
"""
import os
import pathlib
import sys

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
from osgeo import gdal, ogr  # noqa: E402
from qgis.PyQt.QtCore import QSize  # noqa: E402
from qgis.PyQt.QtGui import QColor, QImage, QPainter  # noqa: E402
from qgis.core import (Qgis, QgsApplication, QgsLayerTree, QgsLayerTreeModel, QgsLegendRenderer,  # noqa: E402
                       QgsLegendSettings, QgsMapRendererSequentialJob, QgsMapSettings, QgsRasterLayer, QgsRenderContext,
                       QgsVectorLayer)

SIDE, LEGEND = 800, 480  # of the drawn map and of the room for its legend [pixels]
checked = 0


def check(truth, what):
    global checked
    if not truth:
        raise SystemExit("FAILED: " + what)
    checked += 1


def classes_of_gdal(band):
    """{value: (name, colour)} of a class layer: names of its attribute table, colours of its colour table."""
    rows, table = band.GetDefaultRAT(), band.GetColorTable()
    return {rows.GetValueAsInt(row, 0): (rows.GetValueAsString(row, 1),
                                         "#%02x%02x%02x" % table.GetColorEntry(rows.GetValueAsInt(row, 0))[:3])
            for row in range(rows.GetRowCount())}


def check_raster(layer, path):
    dataset = gdal.Open(str(path))
    band, renderer = dataset.GetRasterBand(1), layer.renderer()
    check(layer.crs().isValid() and layer.crs().authid() in ("", f"EPSG:{dataset.GetSpatialRef().GetAuthorityCode(None)}"),
          f"{path}: coordinate system {layer.crs().authid()}")
    check(band.GetDescription() and band.GetDescription() in layer.bandName(1), f"{path}: band {layer.bandName(1)}")
    if band.GetColorTable():
        check(renderer.type() == "paletted", f"{path}: renderer {renderer.type()}")
        shown = {int(c.value): (c.label, c.color.name()) for c in renderer.classes()}
        check(shown == classes_of_gdal(band), f"{path}: classes {shown}, GDAL {classes_of_gdal(band)}")
        return
    check(renderer.type() == "singlebandpseudocolor", f"{path}: renderer {renderer.type()}")
    items = renderer.shader().rasterShaderFunction().colorRampItemList()
    check(len(items) >= 2 and all(item.color.isValid() for item in items), f"{path}: ramp of {len(items)} colours")
    check(items[0].label and items[-1].label, f"{path}: both ends of the ramp have names")


def check_vector(layer, path):
    renderer = layer.renderer()
    check(layer.crs().isValid(), f"{path}: coordinate system")
    check(layer.featureCount() > 0, f"{path}: {layer.name()} is not empty")
    check(renderer.type() == "categorizedSymbol", f"{path}: {layer.name()} has a {renderer.type()}")
    named = [c for c in renderer.categories() if c.label()]
    check(named, f"{path}: {layer.name()} has named classes")
    values = {feature[renderer.classAttribute()] for feature in layer.getFeatures()}
    known = {c.value() for c in renderer.categories()}
    check(values <= known, f"{path}: {layer.name()} has values {values} and classes {known}")


def draw(layers, picture):
    """The layers, the first one on top, and their legend to the right."""
    settings = QgsMapSettings()
    settings.setLayers(layers)
    settings.setDestinationCrs(layers[0].crs())
    settings.setExtent(layers[-1].extent())
    settings.setOutputSize(QSize(SIDE, SIDE))
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    check(not job.errors(), f"{picture}: {[e.message for e in job.errors()]}")
    page = QImage(SIDE + LEGEND, SIDE, QImage.Format_RGB32)
    page.fill(QColor("white"))
    painter = QPainter(page)
    painter.drawImage(0, 0, job.renderedImage())
    tree = QgsLayerTree()
    for layer in layers:
        tree.addLayer(layer)
    model = QgsLayerTreeModel(tree)
    legend = QgsLegendRenderer(model, QgsLegendSettings())
    painter.translate(SIDE + 10, 10)
    painter.scale(3, 3)  # millimetres to pixels
    context = QgsRenderContext.fromQPainter(painter)
    legend.drawLegend(context)
    painter.end()
    check(page.save(str(picture)), f"{picture} is written")


def open_layers(path):
    if path.suffix == ".tif":
        layers = [QgsRasterLayer(str(path), path.stem)]
    else:
        names = [layer.GetName() for layer in ogr.Open(str(path)) if layer.GetGeomType() != ogr.wkbNone]
        layers = [QgsVectorLayer(f"{path}|layername={name}", name, "ogr") for name in names]
    for layer in layers:
        check(layer.isValid(), f"{path} opens")
        (check_raster if path.suffix == ".tif" else check_vector)(layer, path)
    return layers


def main():
    out, files = pathlib.Path(sys.argv[1]), []
    for word in map(pathlib.Path, sys.argv[2:]):
        files += sorted([*word.glob("*.tif"), *word.glob("*.gpkg")]) if word.is_dir() else [word]
    out.mkdir(parents=True, exist_ok=True)
    for path in files:
        layers = open_layers(path)
        print(path, *(layer.name() for layer in layers))
        draw(layers[::-1], out / (path.stem + ".png"))
    print(f"QGIS {Qgis.QGIS_VERSION}: {len(files)} files, {checked} checks passed")


application = QgsApplication([], False)
if "QGIS_PREFIX_PATH" not in os.environ:
    application.setPrefixPath("/usr", True)
application.initQgis()
main()
sys.stdout.flush()
os._exit(0)  # some versions of QGIS fail while they are taken down
