import json
import subprocess

import numpy as np
import pytest

import gonogo


@pytest.fixture(scope="module")
def record(study):
    return gonogo.Trial(study=study, slope_along=8, seed=3).run(threads=2)


def test_the_program_ends_alike(study, program, record):
    done = subprocess.run([program, "--json", "simulate", study, "--set", "slope_along=8", "--seed", "3"], check=True,
                          capture_output=True, text=True)
    answer = json.loads(done.stdout.splitlines()[-1])
    assert (record.verdict, record.reason) == (answer["verdict"], answer["reason"])
    assert record.variables == answer["variables"]
    assert {k: v for k, v in record.measures.items() if v == v} == {k: v for k, v in answer["measures"].items() if v is not None}


def test_frames_watch_without_changing_a_bit(study, record):
    trial = gonogo.Trial(study=study, slope_along=8, seed=3)
    times, heights = [], []
    for frame in trial.frames():
        times.append(frame.time)
        if len(times) == 1:
            assert np.array_equal(np.from_dlpack(frame.bodies_on_device().position), frame.bodies().position)
        if frame.wheel >= 0:
            heights.append(frame.bodies().position[frame.wheel, 2])
    assert np.allclose(np.diff(times), trial.step_size)
    assert len(heights) == len(times)
    assert np.ptp(heights) > 0
    assert trial.record.measures == pytest.approx(record.measures, abs=0, rel=0, nan_ok=True)


def test_a_frame_is_over_when_the_trial_goes_on(study):
    kept = []
    for frame in gonogo.Trial(study=study).frames(every=0.05):
        kept.append((frame, frame.bodies()))
    with pytest.raises(gonogo.InputError, match="has gone on"):
        kept[0][0].bodies()
    assert not np.array_equal(kept[0][1].position, kept[-1][1].position)


def test_a_loop_may_end_early(study):
    trial = gonogo.Trial(study=study)
    for frame in trial.frames():
        if frame.time > 0.05:
            break
    assert trial.record is None


def test_progress_is_called(study):
    calls = []
    gonogo.Trial(study=study).run(progress=lambda time, limit: calls.append((time, limit)), progress_interval=0.05)
    assert len(calls) >= 3
    assert all(0 <= time <= limit for time, limit in calls)


def test_an_error_in_a_callback_ends_the_trial(study):
    def fail(time, limit):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        gonogo.Trial(study=study).run(progress=fail)


def test_bad_input_is_told(study):
    with pytest.raises(gonogo.InputError, match="slope_along"):
        gonogo.Trial(study=study, slope_alon=3)
    with pytest.raises(gonogo.InputError, match="hmmwv_quarter"):
        gonogo.Trial("no_such_vehicle")
    with pytest.raises(gonogo.InputError, match="one of the two"):
        gonogo.Trial("hmmwv_quarter", study=study)
    assert gonogo.Trial("hmmwv_quarter", slope_along=5).variables["slope_along"] == 5
