"""Fixtures: a small model and dataset, and the program that the module is compared with."""
import json
import os
import pathlib
import subprocess

import pytest

os.environ["SCIPY_ARRAY_API"] = "1"  # else scikit-learn skips one of its checks; read when scipy is imported

import gonogo  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def root():
    return ROOT


@pytest.fixture(scope="session")
def program():
    """Path of the program of the same build: its bits are the reference."""
    return pathlib.Path(os.environ["GONOGO_PROGRAM"])


@pytest.fixture(scope="session")
def dataset_file(root):
    return root / "data" / "hmmwv_32mm" / "dataset.h5"


@pytest.fixture(scope="session")
def model_file(program, dataset_file, root, tmp_path_factory):
    """A small model of the shipped trials, without a teacher: processes of 2,074 trials take minutes."""
    folder = tmp_path_factory.mktemp("model")
    text = json.loads((root / "configs" / "studies" / "hmmwv_32mm.json").read_text())
    text["vehicle"] = str(root / "configs" / "vehicles" / "hmmwv.json")
    text["learning"] = {"hidden": 6, "epochs": 20, "chains": 16, "folds": 2, "teacher": 0}
    (folder / "study.json").write_text(json.dumps(text))
    subprocess.run([program, "train", "--dataset", dataset_file, "--study", folder / "study.json", "--out",
                    folder / "model.h5"], check=True, capture_output=True)
    return folder / "model.h5"


@pytest.fixture(scope="session")
def model(model_file):
    return gonogo.Model(model_file)


@pytest.fixture(scope="session")
def bed():
    return gonogo.Bed.settle(0.5, 0.5, 0.25, grain_diameter=0.1, threads=2)


@pytest.fixture(scope="session")
def study(root, tmp_path_factory):
    """Three short trials of the demo's wheel; their beds go away with the folder."""
    folder = tmp_path_factory.mktemp("study")
    os.environ["GONOGO_CACHE"] = str(folder / "cache")
    text = json.loads((root / "configs" / "studies" / "demo.json").read_text())
    for key in ("region", "map"):
        del text[key]
    text["vehicle"] = str(root / "configs" / "vehicles" / "hmmwv_quarter.json")
    text["soil"]["calibration"] = str(root / "configs" / "soils" / "calibration_90mm.json")
    text["trial"]["bed"].update(length_m=1.8, packing_seeds=1, settle_s=0.05)
    text["trial"]["drive"].update(park_s=0.05, ramp_s=0.1, run_in_m=0.05, test_distance_m=0.2, minimum_drive_s=0.1,
                                  time_limit_s=0.8)
    text["design"].update(points=3, replicate_every=0, ranges={"slope_along": [0, 30]})
    text["design"]["fixed"].update(slope_across=0, friction_angle=30, cohesion=1, relative_density=0.5, payload=0, bed_depth=0.2,
                                   tyre_friction=0.8)
    (folder / "study.json").write_text(json.dumps(text))
    return folder / "study.json"
