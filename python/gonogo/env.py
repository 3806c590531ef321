"""Gymnasium environments: a quarter vehicle's wheel on a sloping bed of grains.

    envs = gonogo.env.WheelVectorEnv(8, threads=2)     # eight worlds that step together
    env = gonogo.env.WheelEnv()                        # one of them, as gymnasium.Env

Action: throttle in [-1, 1]; a share of the max torque forwards, or when negative of the brake. Observation: speed along the
heading [m/s], speed of the rim [m/s], sinkage of the wheel below the bed's mean surface [m], slope along [rad], distance left
[m]. Reward: distance covered in the step [m]. An episode ends at `distance`, and is truncated at `time_limit`.
"""
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _core

_GRAVITY = 9.81  # [m/s^2]


class WheelVectorEnv(gymnasium.vector.VectorEnv):
    """A batch of worlds, each an episode of its own. An ended world begins anew in the step after its last one."""

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, num_envs: int, *, vehicle: str = "hmmwv_quarter", friction: float = 0.6, rolling_friction: float = 0.2,
                 slopes: tuple[float, float] = (0.0, 20.0), distance: float = 2.0, time_limit: float = 5.0,
                 step_time: float = 0.05, bed: _core.Bed | None = None, threads: int = 1) -> None:
        """slopes: range of an episode's slope along [deg]. bed: default 2 m x 0.7 m x 0.3 m of 100 mm grains."""
        self.num_envs = num_envs
        self._slopes, self._distance, self._time_limit, self._step_time = slopes, distance, time_limit, step_time
        self._bed = bed or _core.Bed.settle(2.0, 0.7, 0.3, grain_diameter=0.1, threads=threads)
        self._rig = _core.WheelRig.read(_core.shipped_file("vehicles", "vehicle", vehicle))
        world = self._bed.world(friction, rolling_friction)
        radius = self._rig.radius + self._rig.lug_height
        axle = (0.5, self._bed.width / 2, self._bed.highest_point + radius)
        self._wheel, _, self._motor = world.add_wheel_rig(self._rig, axle)
        self._simulation = _core.Simulation([world] * num_envs, step=2e-3, iterations=50,
                                            grain_diameter=self._bed.grain_diameter, threads=threads)
        self._steps = max(1, round(step_time / self._simulation.step_size))
        self._let_down()
        self.single_observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (5,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._slope, self._travelled, self._time = (np.zeros(num_envs) for _ in range(3))
        self._x = np.zeros(num_envs)
        self._ended = np.zeros(num_envs, dtype=bool)

    def reset(self, *, seed: int | list[int | None] | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins all episodes; world k draws from seed + k, or from seed[k]."""
        seeds = seed if isinstance(seed, list) else [None if seed is None else seed + k for k in range(self.num_envs)]
        if seed is not None or not hasattr(self, "_random"):
            self._random = [np.random.default_rng(s) for s in seeds]
        for k in range(self.num_envs):
            self._begin(k)
        return self._observe(), {}

    def step(self, actions: NDArray[np.float32]) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_],
                                                           NDArray[np.bool_], dict[str, Any]]:
        """One step of `step_time` in every world."""
        began = self._ended.copy()
        for k in range(self.num_envs):
            if began[k]:
                self._begin(k)
            throttle = float(np.clip(actions[k][0], -1, 1))
            full_speed = 100.0 if throttle > 0 else 0.0  # [rad/s]: out of reach, so the torque decides
            self._simulation.set_motor(self._motor, full_speed, abs(throttle) * self._rig.max_torque, k)
        before = self._travelled.copy()
        self._simulation.step(self._steps)
        self._time += self._step_time
        observation = self._observe()
        for k in np.flatnonzero(began):  # the step that begins an episode does not count
            self._begin(int(k))
        if began.any():
            observation = self._observe()
        terminated = (self._travelled >= self._distance) & ~began
        truncated = (self._time >= self._time_limit - 1e-9) & ~terminated & ~began
        self._ended = terminated | truncated
        return observation, np.where(began, 0.0, self._travelled - before), terminated, truncated, {}

    def _let_down(self) -> None:
        """The wheel settles on level ground; every episode begins there."""
        for k in range(self.num_envs):
            self._simulation.set_motor(self._motor, 0.0, self._rig.max_torque, k)
        self._simulation.step(round(0.3 / self._simulation.step_size))
        self._start = [self._simulation.snapshot(k) for k in range(self.num_envs)]

    def _begin(self, k: int) -> None:
        self._simulation.restore(self._start[k], k)
        self._slope[k] = np.radians(self._random[k].uniform(*self._slopes))
        self._simulation.set_gravity((-_GRAVITY * np.sin(self._slope[k]), 0.0, -_GRAVITY * np.cos(self._slope[k])), k)
        self._x[k] = self._simulation.bodies(k).position[self._wheel, 0]
        self._travelled[k] = self._time[k] = 0
        self._ended[k] = False

    def _observe(self) -> NDArray[np.float32]:
        observation = np.empty((self.num_envs, 5), dtype=np.float32)
        for k in range(self.num_envs):
            bodies = self._simulation.bodies(k)
            position = bodies.position[self._wheel]
            half = self._bed.length / 2
            self._travelled[k] += (position[0] - self._x[k] + half) % self._bed.length - half  # the bed is periodic
            self._x[k] = position[0]
            sinkage = self._bed.surface + self._rig.radius + self._rig.lug_height - position[2]
            rim = bodies.angular_velocity[self._wheel, 1] * self._rig.radius
            observation[k] = (bodies.velocity[self._wheel, 0], rim, sinkage, self._slope[k],
                              self._distance - self._travelled[k])
        return observation


class WheelEnv(gymnasium.Env):  # type: ignore[type-arg]
    """One world of WheelVectorEnv, with the same options."""

    def __init__(self, **options: Any) -> None:
        self._one = WheelVectorEnv(1, **options)
        self.observation_space = self._one.single_observation_space
        self.action_space = self._one.single_action_space

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        observation, info = self._one.reset(seed=seed)
        return observation[0], info

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One step of `step_time`."""
        observation, reward, terminated, truncated, info = self._one.step(np.asarray(action)[None])
        return observation[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), info
