"""gonogo:compare"""
import os

from qgis.core import (QgsProcessingAlgorithm, QgsProcessingContext, QgsProcessingOutputRasterLayer, QgsProcessingParameterFile,
                       QgsProcessingParameterFolderDestination)

from .program import run_program

LAYERS = {"CHANGE": ("change", "Change of class"), "DIFFERENCE": ("difference", "Difference of P(go)"),
          "SIGNIFICANCE": ("significance", "Significance of the difference")}


class CompareAlgorithm(QgsProcessingAlgorithm):
    def name(self):
        return "compare"

    def displayName(self):
        return "Compare two maps"

    def shortHelpString(self):
        return ("Where one map passes and the other does not, and how sure that is. The maps are of one region: two vehicles, two "
                "moistures, or before and after more trials.")

    def createInstance(self):
        return CompareAlgorithm()

    def initAlgorithm(self, configuration=None):
        for name, title in (("FIRST", "Folder of a map"), ("SECOND", "Folder of another map of the region")):
            self.addParameter(QgsProcessingParameterFile(name, title, QgsProcessingParameterFile.Folder))
        self.addParameter(QgsProcessingParameterFolderDestination("OUTPUT", "Folder of the comparison"))
        for key, (_, title) in LAYERS.items():
            self.addOutput(QgsProcessingOutputRasterLayer(key, title))

    def processAlgorithm(self, parameters, context, feedback):
        folder = self.parameterAsString(parameters, "OUTPUT", context)
        maps = [self.parameterAsString(parameters, name, context) for name in ("FIRST", "SECOND")]
        run_program(["compare", *maps, "--out", folder], feedback)
        results = {"OUTPUT": folder}
        for key, (layer, title) in LAYERS.items():
            results[key] = os.path.join(folder, layer + ".tif")
            context.addLayerToLoadOnCompletion(results[key], QgsProcessingContext.LayerDetails(title, context.project(), key))
        return results
