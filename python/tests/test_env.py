import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import gonogo
from gonogo.env import VehicleEnv, VehicleVectorEnv, WheelEnv, WheelVectorEnv


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


LEVEL = dict(slopes=(0.0, 0.0), goals=(40.0, 40.0), bearings=(0.0, 0.0))


def drive(env, throttle, steering, count):
    """The last observation and the sum of rewards of one action held for `count` steps."""
    way = 0
    for _ in range(count):
        observation, reward, terminated, truncated, info = env.step(np.array([throttle, steering], dtype=np.float32))
        assert not (terminated or truncated or info["failed"])
        way += reward
    return observation, way


def test_vehicle_conformance():
    check_env(VehicleEnv(time_limit=1.0), skip_render_check=True)


@pytest.mark.parametrize("vehicle", ["hmmwv", "viper"])
def test_a_vehicle_drives_and_turns_to_both_sides(vehicle):
    env = VehicleEnv(vehicle=vehicle, **LEVEL)
    yaws = []
    for steering in (0.6, -0.6):
        first, _ = env.reset(seed=3)
        assert first[5:] == pytest.approx([40, 0], abs=0.01)
        assert first[:5] == pytest.approx(np.zeros(5), abs=0.02)
        straight, way = drive(env, 0.5, 0.0, 8)
        assert straight[0] > 0.4 and abs(straight[1]) < 0.1
        assert way == pytest.approx(40 - np.hypot(*straight[5:]), abs=1e-3)
        turning, _ = drive(env, 0.4, steering, 10)
        yaws.append(turning[2])
        assert np.sign(turning[6]) == -np.sign(steering)  # the goal straight ahead is now on the other side
    assert yaws[0] > 0.1
    assert yaws[1] == pytest.approx(-yaws[0], rel=0.2)


def test_a_braked_vehicle_stands_on_a_slope_and_a_free_one_rolls_down():
    env = VehicleEnv(slopes=(8.0, 8.0), goals=(40.0, 40.0))
    speeds = []
    for throttle in (-1.0, 0.0):
        env.reset(seed=2)
        observation, _ = drive(env, throttle, 0.0, 15)
        speeds.append(np.hypot(observation[0], observation[1]))
        tilt = np.degrees(np.arcsin(np.hypot(np.sin(observation[3]), np.sin(observation[4]) * np.cos(observation[3]))))
        assert tilt == pytest.approx(8, abs=1.5)  # pitch and roll are those of the slope, but for the springs
    assert speeds[0] < 0.05 < 0.2 < speeds[1]


def test_the_goal_ends_an_episode():
    env = VehicleEnv(slopes=(0.0, 0.0), goals=(3.0, 3.0), bearings=(0.0, 0.0))
    env.reset(seed=1)
    way = ended = 0
    while not ended:
        observation, reward, terminated, truncated, _ = env.step(np.array([0.6, 0.0], dtype=np.float32))
        way += reward
        ended = terminated or truncated
    assert terminated and np.hypot(*observation[5:]) < 1.0
    assert way == pytest.approx(3 - np.hypot(*observation[5:]), abs=0.01)


def test_vehicles_of_a_batch_are_themselves_alone():
    batch, alone = VehicleVectorEnv(2, vehicle="mgru3_rover"), VehicleEnv(vehicle="mgru3_rover")
    seen, _ = batch.reset(seed=4)
    first, _ = alone.reset(seed=5)
    assert np.array_equal(seen[1], first)
    for action in ((0.8, 0.5), (-0.3, -1.0), (1.0, 0.0)):
        seen, rewards, *_ = batch.step(np.tile(np.array(action, dtype=np.float32), (2, 1)))
        one, reward, *_ = alone.step(np.array(action, dtype=np.float32))
        assert np.array_equal(seen[1], one)
        assert rewards[1] == reward


def test_a_rover_on_grains(bed):
    with pytest.raises(gonogo.InputError, match="longer and wider"):
        VehicleEnv(vehicle="mgru3_rover", bed=bed)
    wide = gonogo.Bed.settle(2.2, 2.0, 0.3, grain_diameter=0.14)
    env = VehicleEnv(vehicle="mgru3_rover", bed=wide, **LEVEL)
    env.reset(seed=1)
    observation, way = drive(env, 1.0, 0.0, 6)
    assert observation[0] > 0.05 and way > 0.02
