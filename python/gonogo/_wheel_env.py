"""A quarter vehicle's wheel on a sloping bed of grains."""
import numpy as np
from numpy.typing import NDArray

from . import _core
from ._worlds_env import WorldsEnv


class WheelVectorEnv(WorldsEnv):
    """A batch of worlds with one wheel each.

    Action: throttle in [-1, 1]; a share of the max torque forwards, or when negative of the brake. Observation: speed along
    the heading [m/s], speed of the rim [m/s], sinkage of the wheel below the bed's mean surface [m], slope along [rad],
    distance left [m]. Reward: distance covered in the step [m]. An episode ends at `distance`, and is truncated at
    `time_limit`.
    """

    def __init__(self, num_envs: int, *, vehicle: str = "hmmwv_quarter", friction: float = 0.6, rolling_friction: float = 0.2,
                 slopes: tuple[float, float] = (0.0, 20.0), distance: float = 2.0, time_limit: float = 5.0,
                 step_time: float = 0.05, bed: _core.Bed | None = None, threads: int = 1, gpu: bool = False) -> None:
        """slopes: range of an episode's slope along [deg]. bed: default 2 m x 0.7 m x 0.3 m of 100 mm grains."""
        self._slopes, self._distance = slopes, distance
        self._bed = bed or _core.Bed.settle(2.0, 0.7, 0.3, grain_diameter=0.1, threads=threads)
        self._rig = _core.WheelRig.read(_core.shipped_file("vehicles", "vehicle", vehicle))
        world = self._bed.world(friction, rolling_friction)
        self._reach = self._rig.radius + self._rig.lug_height
        axle = (0.5, self._bed.width / 2, self._bed.highest_point + self._reach)
        self._wheel, _, self._motor = world.add_wheel_rig(self._rig, axle)
        super().__init__(world, num_envs, 5, 1, grain_diameter=self._bed.grain_diameter, time_limit=time_limit,
                         step_time=step_time, step=2e-3, iterations=50, threads=threads, gpu=gpu)
        self._slope, self._travelled, self._x = (np.zeros(num_envs) for _ in range(3))
        for k in range(num_envs):
            self._simulation.set_motor(self._motor, 0.0, self._rig.max_torque, k)
        self._settle(0.3)

    def _act(self, k: int, action: NDArray[np.float32]) -> None:
        throttle = float(action[0])
        full_speed = 100.0 if throttle > 0 else 0.0  # [rad/s]: out of reach, so the torque decides
        self._simulation.set_motor(self._motor, full_speed, abs(throttle) * self._rig.max_torque, k)

    def _start(self, k: int, random: np.random.Generator) -> None:
        self._simulation.restore(self._rest[k], k)
        self._slope[k] = np.radians(random.uniform(*self._slopes))
        self._tilt(k, self._slope[k])
        self._x[k] = self._simulation.body(self._wheel, k).position[0, 0]
        self._travelled[k] = 0

    def _look(self, k: int) -> tuple[float, ...]:
        wheel = self._simulation.body(self._wheel, k)
        x, half = wheel.position[0, 0], self._bed.length / 2
        self._travelled[k] += (x - self._x[k] + half) % self._bed.length - half  # the bed is periodic
        self._x[k] = x
        sinkage = self._bed.surface + self._reach - wheel.position[0, 2]
        rim = wheel.angular_velocity[0, 1] * self._rig.radius
        return wheel.velocity[0, 0], rim, sinkage, self._slope[k], self._distance - self._travelled[k]

    def _gained(self, k: int) -> float:
        return float(self._travelled[k])

    def _is_over(self, k: int) -> bool:
        return bool(self._travelled[k] >= self._distance)
