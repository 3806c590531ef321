"""Gymnasium environments: a whole vehicle with throttle and steering, and the wheel of a quarter vehicle.

    envs = gonogo.env.VehicleVectorEnv(8, vehicle="hmmwv", threads=2)     # eight worlds that step together
    env = gonogo.env.WheelEnv()                                           # one world, as gymnasium.Env
"""
from typing import Any

from ._vehicle_env import VehicleVectorEnv
from ._wheel_env import WheelVectorEnv
from ._worlds_env import OneWorldEnv

__all__ = ["VehicleEnv", "VehicleVectorEnv", "WheelEnv", "WheelVectorEnv"]


class VehicleEnv(OneWorldEnv):
    """One world of VehicleVectorEnv, with the same options."""

    def __init__(self, **options: Any) -> None:
        super().__init__(VehicleVectorEnv(1, **options))


class WheelEnv(OneWorldEnv):
    """One world of WheelVectorEnv, with the same options."""

    def __init__(self, **options: Any) -> None:
        super().__init__(WheelVectorEnv(1, **options))
