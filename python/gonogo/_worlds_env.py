"""What the environments share: worlds that step together, each an episode of its own."""
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import _core

GRAVITY = 9.81  # [m/s^2]


class WorldsEnv(gymnasium.vector.VectorEnv):
    """A batch of worlds. An ended world begins anew in the step after its last one.

    An episode whose simulation fails is truncated, and `failed` of the step's info is true there.
    """

    metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}

    def __init__(self, world: _core.World, num_envs: int, observations: int, actions: int, *, grain_diameter: float | None,
                 time_limit: float, step_time: float, step: float, iterations: int, threads: int, gpu: bool) -> None:
        self.num_envs = num_envs
        self._time_limit, self._step_time = time_limit, step_time
        self._simulation = _core.Simulation([world] * num_envs, step=step, iterations=iterations, grain_diameter=grain_diameter,
                                            threads=threads, gpu=gpu)
        self._steps = max(1, round(step_time / self._simulation.step_size))
        self.single_observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (observations,), np.float32)
        self.single_action_space = gymnasium.spaces.Box(-1.0, 1.0, (actions,), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._time = np.zeros(num_envs)
        self._ended = np.zeros(num_envs, dtype=bool)

    # What an environment says of world k.

    def _act(self, k: int, action: NDArray[np.float32]) -> None:
        """Holds an action, inside [-1, 1], from now on."""
        raise NotImplementedError

    def _start(self, k: int, random: np.random.Generator) -> None:
        """Puts the world to the beginning of an episode."""
        raise NotImplementedError

    def _look(self, k: int) -> tuple[float, ...]:
        """The observation now."""
        raise NotImplementedError

    def _gained(self, k: int) -> float:
        """What an episode has gained so far, as of the latest look; rewards are its differences."""
        raise NotImplementedError

    def _is_over(self, k: int) -> bool:
        """Whether the episode is at its end, as of the latest look."""
        raise NotImplementedError

    # Gymnasium.

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
            self._act(k, np.clip(actions[k], -1, 1))
        before = np.array([self._gained(k) for k in range(self.num_envs)])
        self._simulation.step(self._steps)
        self._time += self._step_time
        observation = self._observe()
        for k in np.flatnonzero(began):  # the step that begins an episode does not count
            self._begin(int(k))
            observation[k] = self._look(int(k))
        gained = np.array([self._gained(k) for k in range(self.num_envs)]) - before
        terminated = np.array([self._is_over(k) for k in range(self.num_envs)]) & ~began
        failed = np.array([self._simulation.report(k).flags != 0 for k in range(self.num_envs)]) & ~began
        terminated &= ~failed
        truncated = ((self._time >= self._time_limit - 1e-9) | failed) & ~terminated & ~began
        self._ended = terminated | truncated
        return observation, np.where(began, 0.0, gained), terminated, truncated, {"failed": failed}

    def _begin(self, k: int) -> None:
        self._start(k, self._random[k])
        self._time[k] = 0
        self._ended[k] = False
        self._look(k)

    def _observe(self) -> NDArray[np.float32]:
        return np.array([self._look(k) for k in range(self.num_envs)], dtype=np.float32)

    def _settle(self, seconds: float) -> None:
        """All worlds come to rest; every episode begins there."""
        self._simulation.step(round(seconds / self._simulation.step_size))
        self._rest = [self._simulation.snapshot(k) for k in range(self.num_envs)]

    def _tilt(self, k: int, slope: float, direction: float = 0.0) -> None:
        """Gravity of a bed that rises by `slope` towards `direction`, from x towards y [rad]."""
        along = -GRAVITY * np.sin(slope)
        self._simulation.set_gravity((along * np.cos(direction), along * np.sin(direction), -GRAVITY * np.cos(slope)), k)


class OneWorldEnv(gymnasium.Env):  # type: ignore[type-arg]
    """One world of a batch as gymnasium.Env."""

    def __init__(self, batch: WorldsEnv) -> None:
        self._one = batch
        self.observation_space = batch.single_observation_space
        self.action_space = batch.single_action_space

    def reset(self, *, seed: int | None = None,
              options: dict[str, Any] | None = None) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins an episode."""
        super().reset(seed=seed)
        observation, info = self._one.reset(seed=seed)
        return observation[0], info

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One step of `step_time`."""
        observation, reward, terminated, truncated, info = self._one.step(np.asarray(action)[None])
        return (observation[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), {"failed": bool(info["failed"][0])})
