"""A whole vehicle that drives to a goal."""
import numpy as np
from numpy.typing import NDArray

from . import _core
from ._worlds_env import WorldsEnv

_PLANE = 60.0  # period of hard ground [m]
_OVERTURNED = np.cos(np.radians(60))
Vector = NDArray[np.float64]


def _turned(q: Vector, v: Vector) -> Vector:
    """v turned by the unit quaternion q = (w, x, y, z)."""
    t = 2 * np.cross(q[1:], v)
    turned: Vector = v + q[0] * t + np.cross(q[1:], t)
    return turned


class VehicleVectorEnv(WorldsEnv):
    """A batch of worlds with one vehicle each.

    Action: throttle and steering in [-1, 1]. Throttle below zero brakes; wheel motors drive backwards. Steering above zero
    turns to the left, by what Vehicle.steering names. Observation: speed forward and to the left [m/s], yaw rate [rad/s],
    pitch (nose up) and roll (left side up) against the horizontal [rad], the goal ahead and to the left [m]. Reward: what
    the step came nearer to the goal [m]. An episode ends within `goal_radius` of the goal, or when the vehicle leans by more
    than 60 deg; it is truncated at `time_limit`.
    """

    def __init__(self, num_envs: int, *, vehicle: str = "hmmwv", payload: float = 0.0, bed: _core.Bed | None = None,
                 friction: float = 0.7, rolling_friction: float = 0.2, slopes: tuple[float, float] = (0.0, 10.0),
                 goals: tuple[float, float] = (8.0, 15.0), bearings: tuple[float, float] = (-60.0, 60.0),
                 goal_radius: float = 1.0, time_limit: float = 20.0, step_time: float = 0.1, iterations: int = 50,
                 threads: int = 1, gpu: bool = False) -> None:
        """bed: None: hard ground. Grains lie in a periodic box, which must be longer and wider than the vehicle.

        slopes: range of an episode's slope [deg], which rises in any direction. goals, bearings: ranges of distance [m] and
        direction [deg] of the goal from the start. payload [kg]. iterations: of the solver in a step; tracks need 150.
        """
        self._slopes, self._goals, self._bearings, self._radius = slopes, goals, bearings, goal_radius
        self._vehicle = _core.Vehicle.read(vehicle, payload)
        world, self._period, height = self._ground(bed, friction, rolling_friction)
        start = (self._period[0] / 2, self._period[1] / 2, height)
        self._driven = world.add_vehicle(self._vehicle, start)
        super().__init__(world, num_envs, 7, 2, grain_diameter=bed.grain_diameter if bed else None, time_limit=time_limit,
                         step_time=step_time, step=2e-3, iterations=iterations, threads=threads, gpu=gpu)
        self._design = self._chassis(0)[1] * np.array([1, -1, -1, -1])  # from the vehicle's axes to the body's
        self._way, self._at, self._goal, self._up = (np.zeros((num_envs, 3)) for _ in range(4))
        self._lean, self._left = np.ones(num_envs), np.zeros(num_envs)
        for k in range(num_envs):
            self._simulation.drive(self._driven, 0.0 if self._vehicle.wheel_motors else -1.0, 0.0, k)
        self._settle(0.5)

    def _ground(self, bed: _core.Bed | None, friction: float, rolling_friction: float) -> tuple[_core.World, Vector, float]:
        """World, its period along x and y [m], height of the ground [m]."""
        if bed is None:
            world = _core.World((_PLANE, _PLANE, 12.0), origin=(0.0, 0.0, -2.0), periodic=(True, True))
            world.add_floor(0.0, material=1)
            world.set_law(1, 2, friction)
            return world, np.array([_PLANE, _PLANE]), 0.0
        if not (bed.length > self._vehicle.length and bed.width > self._vehicle.width):
            raise _core.InputError(f"bed: {bed.length:g} m x {bed.width:g} m; it must be longer and wider than the vehicle, "
                                   f"{self._vehicle.length:g} m x {self._vehicle.width:g} m")
        return bed.world(friction, rolling_friction, headroom=6.0), np.array([bed.length, bed.width]), bed.highest_point

    def _chassis(self, k: int) -> tuple[Vector, Vector, Vector, Vector]:
        """Position, orientation, velocity and angular velocity of the chassis."""
        body = self._simulation.body(self._driven.chassis, k)
        return body.position[0], body.orientation[0].astype(float), body.velocity[0], body.angular_velocity[0]

    def _act(self, k: int, action: NDArray[np.float32]) -> None:
        self._simulation.drive(self._driven, float(action[0]), float(action[1]), k)

    def _start(self, k: int, random: np.random.Generator) -> None:
        self._simulation.restore(self._rest[k], k)
        slope, rises = np.radians(random.uniform(*self._slopes)), random.uniform(-np.pi, np.pi)
        self._tilt(k, slope, rises)
        self._up[k] = np.sin(slope) * np.cos(rises), np.sin(slope) * np.sin(rises), np.cos(slope)
        distance, bearing = random.uniform(*self._goals), np.radians(random.uniform(*self._bearings))
        self._goal[k] = distance * np.cos(bearing), distance * np.sin(bearing), 0
        self._way[k] = 0
        self._at[k] = self._chassis(k)[0]

    def _look(self, k: int) -> tuple[float, ...]:
        position, orientation, velocity, turning = self._chassis(k)
        step = position - self._at[k]
        step[:2] -= self._period * np.round(step[:2] / self._period)  # the ground is periodic
        self._way[k] += step
        self._at[k] = position
        forward, left, up = (_turned(orientation, _turned(self._design, axis)) for axis in np.eye(3))
        to_goal = self._goal[k] - self._way[k]
        self._left[k] = np.hypot(to_goal[0], to_goal[1])
        self._lean[k] = self._up[k] @ up
        return (velocity @ forward, velocity @ left, turning @ up, np.arcsin(np.clip(self._up[k] @ forward, -1, 1)),
                np.arctan2(self._up[k] @ left, self._lean[k]), to_goal @ forward, to_goal @ left)

    def _gained(self, k: int) -> float:
        return float(-self._left[k])

    def _is_over(self, k: int) -> bool:
        return bool(self._left[k] < self._radius or self._lean[k] < _OVERTURNED)
