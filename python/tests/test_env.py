import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import gonogo
from gonogo.env import WheelEnv, WheelVectorEnv


@pytest.fixture(scope="module")
def options():
    bed = gonogo.Bed.settle(1.2, 0.6, 0.25, grain_diameter=0.12, threads=2)
    return dict(bed=bed, distance=0.3, time_limit=0.6, slopes=(0.0, 12.0))


def test_conformance(options):
    check_env(WheelEnv(**options), skip_render_check=True)


def test_throttle_drives_and_brake_holds(options):
    env = WheelEnv(**{**options, "slopes": (0.0, 0.0)})
    ways = []
    for throttle in (1.0, -1.0):
        env.reset(seed=1)
        way = ended = 0
        while not ended:
            observation, reward, terminated, truncated, _ = env.step(np.array([throttle], dtype=np.float32))
            way += reward
            ended = terminated or truncated
        ways.append((way, terminated))
    assert ways[0][0] > 0.25
    assert abs(ways[1][0]) < 0.1 and not ways[1][1]


def test_a_batch_is_its_worlds_alone(options):
    batch = WheelVectorEnv(2, **options)
    alone = WheelEnv(**options)
    seen, _ = batch.reset(seed=4)
    first, _ = alone.reset(seed=5)
    assert np.array_equal(seen[1], first)
    for throttle in (0.4, 0.9, -0.2):
        seen, rewards, *_ = batch.step(np.full((2, 1), throttle, dtype=np.float32))
        one, reward, *_ = alone.step(np.array([throttle], dtype=np.float32))
        assert np.array_equal(seen[1], one)
        assert rewards[1] == reward


def test_an_ended_world_begins_anew(options):
    batch = WheelVectorEnv(1, **{**options, "time_limit": 0.1})
    batch.reset(seed=1)
    action = np.zeros((1, 1), dtype=np.float32)
    batch.step(action)
    assert batch.step(action)[3][0]  # truncated
    _, reward, terminated, truncated, _ = batch.step(action)
    assert reward[0] == 0 and not terminated[0] and not truncated[0]
