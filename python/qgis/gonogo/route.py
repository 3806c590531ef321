"""gonogo:route"""
from qgis.core import (QgsProcessing, QgsProcessingAlgorithm, QgsProcessingOutputNumber, QgsProcessingParameterEnum,
                       QgsProcessingParameterPoint, QgsProcessingParameterVectorDestination)

from .place import add_place, place_arguments
from .program import run_program

COSTS = ["fastest", "safest", "least-energy", "shortest"]


class RouteAlgorithm(QgsProcessingAlgorithm):
    def name(self):
        return "route"

    def displayName(self):
        return "Route"

    def shortHelpString(self):
        return ("Ways from one point to another that the vehicle of a trained model can drive: fastest, safest, of least energy, "
                "shortest. Each is a line with its length, time, energy and the chance to get through.")

    def createInstance(self):
        return RouteAlgorithm()

    def initAlgorithm(self, configuration=None):
        add_place(self)
        self.addParameter(QgsProcessingParameterPoint("START", "Start"))
        self.addParameter(QgsProcessingParameterPoint("END", "End"))
        self.addParameter(QgsProcessingParameterEnum("COSTS", "What a way has least of", COSTS, allowMultiple=True,
                                                     defaultValue=[0, 1]))
        self.addParameter(QgsProcessingParameterVectorDestination("OUTPUT", "Ways", QgsProcessing.TypeVectorLine))
        self.addOutput(QgsProcessingOutputNumber("FOUND", "Number of ways found"))

    def processAlgorithm(self, parameters, context, feedback):
        crs = self.parameterAsRasterLayer(parameters, "DEM", context).crs()
        start, end = (self.parameterAsPoint(parameters, name, context, crs) for name in ("START", "END"))
        costs = [COSTS[i] for i in self.parameterAsEnums(parameters, "COSTS", context)]
        lines = self.parameterAsOutputLayer(parameters, "OUTPUT", context)
        arguments = ["route", *place_arguments(self, parameters, context), "--from", f"{start.x()!r},{start.y()!r}",
                     "--to", f"{end.x()!r},{end.y()!r}", "--cost", ",".join(costs), "--out", lines]
        result = run_program(arguments, feedback)
        return {"OUTPUT": lines, "FOUND": sum(bool(way["found"]) for way in result["routes"])}
