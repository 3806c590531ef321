"""Go/NoGo mobility maps for off-road vehicles: trials, models of them, and annealing problems.

    >>> model = gonogo.Model("hmmwv")
    >>> model.predict({"slope_along": [0, 10, 20], "friction_angle": 32})
    array([...])

Units are those of the contract, see gonogo.variables(); elsewhere SI and radians.
"""
import os as _os

# The library looks for vehicles, soils and studies by name beside its program, which here is Python. Worker processes
# inherit the variable.
_os.environ.setdefault("GONOGO_SHARE", _os.path.join(_os.path.dirname(__file__), "share"))

from ._core import (Bed, Bodies, Contacts, DeviceBodies, DeviceError, DrivenVehicle, Frame, InputError, Simulation, Snapshot,
                    StepReport, TrialRecord, Vehicle, WheelRig, World, cuda_device_names, max_threads, revision, set_threads)
from ._core import version as _version
from ._campaign import Campaign
from ._contract import Measure, Variable, measures, outcomes, variables
from ._dataset import Dataset
from ._files import shipped
from ._mapping import Map, Raster, compare, map, read_raster
from ._model import Answer, Model
from ._route import route
from ._training import evaluate, train
from ._trial import Trial

__version__ = _version()

__all__ = ["Answer", "Bed", "Bodies", "Campaign", "Contacts", "Dataset", "DeviceBodies", "DeviceError", "DrivenVehicle", "Frame",
           "InputError", "Map", "Measure", "Model", "Raster", "Simulation", "Snapshot", "StepReport", "Trial", "TrialRecord",
           "Variable", "Vehicle", "WheelRig", "World", "compare", "cuda_device_names", "evaluate", "map", "max_threads",
           "measures", "outcomes", "read_raster", "revision", "route", "set_threads", "shipped", "train", "variables"]
