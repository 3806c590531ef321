"""Puts the provider into the Processing toolbox and takes it out again."""
from qgis.core import QgsApplication

from .provider import GonogoProvider


class GonogoPlugin:
    def __init__(self):
        self.provider = None

    def initProcessing(self):
        self.provider = GonogoProvider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):
        self.initProcessing()

    def unload(self):
        QgsApplication.processingRegistry().removeProvider(self.provider)
