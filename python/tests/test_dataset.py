import pathlib
import subprocess
import time

import numpy as np
import pandas
import pytest

import gonogo


def test_frame_has_the_programs_columns_and_bits(dataset_file, program, tmp_path):
    dataset = gonogo.Dataset(dataset_file)
    frame = dataset.to_pandas()
    done = subprocess.run([program, "dataset", "export", dataset_file, "--out", tmp_path / "trials.csv"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "trials.csv").read_text() == dataset.to_csv()
    table = pandas.read_csv(tmp_path / "trials.csv", keep_default_na=False, na_values=["nan"])
    assert list(table.columns) == list(frame.columns)
    assert len(frame) == len(dataset) == len(table)
    for name in table.columns:
        if pandas.api.types.is_numeric_dtype(table[name]):
            assert np.array_equal(frame[name], table[name], equal_nan=table[name].dtype == float), name
        else:
            assert list(frame[name].astype(str)) == list(table[name].astype(str)), name


def test_summary_counts_the_verdicts(dataset_file):
    dataset = gonogo.Dataset(dataset_file)
    counts = dataset.to_pandas()["verdict"].value_counts()
    assert dataset.summary()["verdicts"] == {name: count for name, count in counts.items() if count}
    assert dataset.provenance()["backend"]


def test_written_file_is_the_read_one(dataset_file, tmp_path):
    gonogo.Dataset(dataset_file).write(tmp_path / "copy.h5")
    assert (tmp_path / "copy.h5").read_bytes() == dataset_file.read_bytes()


def test_damage_is_told(tmp_path, dataset_file):
    damaged = tmp_path / "damaged.h5"
    damaged.write_bytes(dataset_file.read_bytes()[:5000])
    with pytest.raises(gonogo.InputError, match="damaged.h5"):
        gonogo.Dataset(damaged)


@pytest.mark.parametrize("name", ["crashes_1_10.h5", "never_ends_1_10.h5"])
def test_a_file_that_hdf5_itself_cannot_bear_ends_in_a_sentence(name):
    file = pathlib.Path(__file__).parents[2] / "tests/data/hdf5" / name  # of HDF5 1.10; newer ones may find the damage
    start = time.monotonic()
    with pytest.raises(gonogo.InputError, match=name) as refusal:
        gonogo.Dataset(file)
    assert time.monotonic() - start < 30
    assert "\n" not in str(refusal.value)
