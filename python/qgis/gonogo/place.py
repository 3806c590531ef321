"""Parameters that map and route share: the raster, the model, the soil."""
from qgis.core import (QgsProcessingParameterEnum, QgsProcessingParameterNumber, QgsProcessingParameterRasterLayer,
                       QgsProcessingParameterString)

MOISTURES = ["any", "dry", "moist", "wet"]


def add_place(algorithm):
    algorithm.addParameter(QgsProcessingParameterRasterLayer("DEM", "Elevation [m], in a projected coordinate system"))
    algorithm.addParameter(QgsProcessingParameterString("MODEL", "Model: name of a shipped one, of its vehicle, or a file",
                                                        defaultValue="hmmwv"))
    algorithm.addParameter(QgsProcessingParameterString("SOIL", "Soil: USDA texture, USCS class, name or numbers of a "
                                                        "test; empty: it may be anything", optional=True))
    algorithm.addParameter(QgsProcessingParameterRasterLayer("SOIL_RASTER", "Soil: raster of USDA textures", optional=True))
    algorithm.addParameter(QgsProcessingParameterString("CONE_INDEX", "Cone index of fine-grained soil: 60 [psi] or 414kPa",
                                                        optional=True))
    algorithm.addParameter(QgsProcessingParameterEnum("MOISTURE", "Moisture", MOISTURES, defaultValue=0))
    algorithm.addParameter(QgsProcessingParameterString("SETTINGS", "Values of the mission: payload=500 tyre_friction=0.8",
                                                        optional=True))
    algorithm.addParameter(QgsProcessingParameterNumber("MAX_SPEED", "Speed that is never exceeded [km/h]",
                                                        QgsProcessingParameterNumber.Double, optional=True, minValue=1))


def place_arguments(algorithm, parameters, context):
    """Arguments of the program for these parameters."""
    dem = algorithm.parameterAsRasterLayer(parameters, "DEM", context)
    arguments = ["--model", algorithm.parameterAsString(parameters, "MODEL", context), "--dem", file_of(dem)]
    raster = algorithm.parameterAsRasterLayer(parameters, "SOIL_RASTER", context)
    soil = file_of(raster) if raster else algorithm.parameterAsString(parameters, "SOIL", context).strip()
    if soil:
        arguments += ["--soil", soil]
    index = algorithm.parameterAsString(parameters, "CONE_INDEX", context).strip()
    if index:
        arguments += ["--cone-index", index]
    moisture = MOISTURES[algorithm.parameterAsEnum(parameters, "MOISTURE", context)]
    if moisture != "any":
        arguments += ["--moisture", moisture]
    for setting in algorithm.parameterAsString(parameters, "SETTINGS", context).replace(",", " ").split():
        arguments += ["--set", setting]
    if parameters.get("MAX_SPEED") is not None:
        arguments += ["--max-speed", repr(algorithm.parameterAsDouble(parameters, "MAX_SPEED", context))]
    return arguments


def file_of(layer):
    """The file behind a raster layer, without what a provider adds to it."""
    return layer.source().split("|")[0]
