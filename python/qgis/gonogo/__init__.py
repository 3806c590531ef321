"""QGIS plug-in: maps, routes and comparisons in the Processing toolbox."""


def classFactory(iface):  # the name is QGIS's
    from .plugin import GonogoPlugin

    return GonogoPlugin()
