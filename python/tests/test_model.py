import csv
import json
import subprocess

import numpy as np
import pandas
import pytest

import gonogo

NAMES = [v.name for v in gonogo.variables()]


def points(count, seed=1):
    random = np.random.default_rng(seed)
    low, high = (np.array([getattr(v, end) for v in gonogo.variables()]) for end in ("min", "max"))
    return low + (high - low) * random.random((count, len(NAMES)))


def test_the_program_gives_the_same_bits(model, model_file, program, tmp_path):
    frame = pandas.DataFrame(points(200), columns=NAMES)
    frame.loc[::7, "friction_angle"] = np.nan
    frame.to_csv(tmp_path / "points.csv", index=False)
    subprocess.run([program, "infer", "--model", model_file, "--csv", tmp_path / "points.csv", "--out", tmp_path / "answers.csv"],
                   check=True, capture_output=True)
    read_back = pandas.read_csv(tmp_path / "points.csv")
    with open(tmp_path / "answers.csv", newline="") as file:
        answers = list(csv.DictReader(file))
    p = model.predict(read_back)
    assert [float(row["p_go"]) for row in answers] == pytest.approx(list(p), abs=5e-7)
    one = {name: value for name, value in read_back.iloc[3].items()}
    done = subprocess.run([program, "--json", "infer", "--model", model_file,
                           *(f"--set={name}={value!r}" for name, value in one.items())], check=True, capture_output=True, text=True)
    answer = json.loads(done.stdout.splitlines()[-1])
    assert answer["p_go"] == model.predict(one)  # the program's JSON has all digits
    assert answer == model.infer(one)


def test_shipped_models_have_names():
    assert "hmmwv_32mm" in gonogo.shipped("models")
    by_vehicle, by_name = gonogo.Model("hmmwv"), gonogo.Model("hmmwv_32mm")
    assert by_vehicle.path == by_name.path
    assert by_name.predict({"slope_along": 0}) > by_name.predict({"slope_along": 25})
    with pytest.raises(gonogo.InputError, match="hmmwv"):
        gonogo.Model("humvee")


def test_frames_dicts_and_arrays_agree(model):
    table = points(50)
    p = model.predict(table)
    frame = pandas.DataFrame(table, columns=NAMES, index=np.arange(100, 150))
    series = model.predict(frame[NAMES[::-1]])
    assert np.array_equal(series.to_numpy(), p)
    assert list(series.index) == list(frame.index)
    assert np.array_equal(model.predict({name: frame[name] for name in NAMES}), p)
    assert model.predict(dict(zip(NAMES, table[4]))) == p[4]
    outcomes = model.predict_outcomes(frame)
    assert list(outcomes.columns) == list(gonogo.outcomes())
    assert np.allclose(outcomes.sum(axis=1), 1)
    assert np.allclose(outcomes["go"] + outcomes["slow_go"], series)


def test_a_subset_is_summed_out(model):
    answer = model.infer({"slope_along": 12})
    p = model.predict({"slope_along": [0, 12, 30]})
    assert p[1] == answer["p_go"]
    assert p[0] > p[2]


def test_bits_do_not_depend_on_threads(model):
    table, threads = points(3000), gonogo.max_threads()
    p = model.predict(table)
    gonogo.set_threads(1)
    alone = model.predict(table)
    gonogo.set_threads(threads)
    assert np.array_equal(alone, p)


def test_sentences_are_the_programs(model, model_file, program):
    done = subprocess.run([program, "infer", "--model", model_file, "--set=slope_alon=3"], capture_output=True, text=True)
    with pytest.raises(gonogo.InputError) as raised:
        model.predict({"slope_alon": 3})
    assert done.stderr.strip() == f"gonogo: {raised.value}"
    with pytest.raises(gonogo.InputError, match="row 1: slope_along: 95 lies outside -45 to 45 deg"):
        model.predict({"slope_along": [3, 95]})
    with pytest.raises(gonogo.InputError, match="columns given"):
        model.predict(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="no_such_file"):
        gonogo.Model("no_such_file.h5")


def test_reconstruct_matches_the_program(model, model_file, program):
    done = subprocess.run([program, "--json", "infer", "--model", model_file, "--set=slope_along=20", "--outcome",
                           "no_go/traction", "--reconstruct"], check=True, capture_output=True, text=True)
    answer = model.reconstruct({"slope_along": 20}, "no_go/traction")
    assert answer == json.loads(done.stdout.splitlines()[-1])
    bins = answer["reconstruction"]["friction_angle"]["bins"]
    assert sum(b["probability"] for b in bins) == pytest.approx(1)


def test_novelty_is_zero_on_a_trial(model, dataset_file):
    frame = gonogo.Dataset(dataset_file).to_pandas()
    row = frame[[name for name in NAMES if name in frame]].iloc[[0]]  # without the sizes of obstacles, which no trial has
    assert model.novelty(row)[0] == 0
    assert model.novelty(row.reindex(columns=NAMES, fill_value=0))[0] == 0
    assert model.inside_sampled_box(row)[0]
    assert set(model.sampled_ranges) == set(NAMES)


def test_samples_follow_the_model(model):
    given = {v.name: (v.min + v.max) / 2 for v in gonogo.variables() if v.name != "slope_along"}
    drawn = model.sample(400, given, sampler="exact", seed=3)
    assert drawn.summary["reads"] == 400
    frame = drawn.to_pandas()
    assert len(frame) > 300
    assert (frame["friction_angle"] == given["friction_angle"]).all()
    assert frame["slope_along"].nunique() > 3
    again = model.sample(400, given, sampler="exact", seed=3)
    assert again.columns.keys() == drawn.columns.keys()
    assert all(np.array_equal(again.columns[name], drawn.columns[name]) for name in drawn.columns)
