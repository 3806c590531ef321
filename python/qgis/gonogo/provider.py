"""The group "gonogo" of the Processing toolbox."""
from pathlib import Path

from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .compare import CompareAlgorithm
from .map import MapAlgorithm
from .program import SETTING
from .route import RouteAlgorithm


class GonogoProvider(QgsProcessingProvider):
    def id(self):
        return "gonogo"

    def name(self):
        return "gonogo"

    def longName(self):
        return "gonogo: Go/NoGo mobility maps"

    def icon(self):
        return QIcon(str(Path(__file__).parent / "icon.svg"))

    def load(self):
        from processing.core.ProcessingConfig import ProcessingConfig, Setting

        ProcessingConfig.settingIcons[self.name()] = self.icon()
        ProcessingConfig.addSetting(Setting(self.name(), SETTING, "Program gonogo (empty: the one on PATH)", ""))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        from processing.core.ProcessingConfig import ProcessingConfig

        ProcessingConfig.removeSetting(SETTING)

    def loadAlgorithms(self):
        for algorithm in (MapAlgorithm, RouteAlgorithm, CompareAlgorithm):
            self.addAlgorithm(algorithm())
