"""gonogo:map"""
import os

from qgis.core import (QgsProcessingAlgorithm, QgsProcessingContext, QgsProcessingOutputFile,
                       QgsProcessingOutputHtml, QgsProcessingOutputRasterLayer, QgsProcessingParameterEnum,
                       QgsProcessingParameterFolderDestination)

from .place import add_place, place_arguments
from .program import run_program

HEADINGS = ["uphill", "worst", "best"]
LAYERS = {"CLASS": ("go", "Class"), "P_GO": ("p_go", "P(go)"), "REASON": ("reason", "Reason")}


class MapAlgorithm(QgsProcessingAlgorithm):
    def name(self):
        return "map"

    def displayName(self):
        return "Go/NoGo map"

    def shortHelpString(self):
        return ("Where the vehicle of a trained model can go on an elevation raster: class, probability and reason of every cell. "
                "The output folder also holds speed, slip, a page (index.html), a figure and a table of areas. A layer says "
                "unknown where the model was never trained; an elevation raster alone leaves the soil open.")

    def createInstance(self):
        return MapAlgorithm()

    def initAlgorithm(self, configuration=None):
        add_place(self)
        self.addParameter(QgsProcessingParameterEnum("HEADING", "Heading", HEADINGS, defaultValue=0))
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder of the map"))
        for key, (_, title) in LAYERS.items():
            self.addOutput(QgsProcessingOutputRasterLayer(key, title))
        self.addOutput(QgsProcessingOutputHtml("PAGE", "Page"))
        self.addOutput(QgsProcessingOutputFile("SUMMARY", "Summary (JSON)"))

    def processAlgorithm(self, parameters, context, feedback):
        folder = self.parameterAsString(parameters, "OUTPUT", context)
        heading = HEADINGS[self.parameterAsEnum(parameters, "HEADING", context)]
        arguments = ["map", *place_arguments(self, parameters, context), "--heading", heading, "--out", folder]
        run_program(arguments, feedback)
        results = {"OUTPUT": folder, "PAGE": os.path.join(folder, "index.html"), "SUMMARY": os.path.join(folder, "map.json")}
        for key, (layer, title) in LAYERS.items():
            results[key] = os.path.join(folder, layer + ".tif")
            details = QgsProcessingContext.LayerDetails(title, context.project(), key)  # a style lies beside each layer
            context.addLayerToLoadOnCompletion(results[key], details)
        return results
