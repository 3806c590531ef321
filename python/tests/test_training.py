import pytest

import gonogo


def test_the_program_trains_the_same_bytes(model_file, dataset_file, tmp_path):
    trained = gonogo.train(dataset_file, tmp_path / "model.h5", study=model_file.parent / "study.json")
    assert (tmp_path / "model.h5").read_bytes() == model_file.read_bytes()
    assert trained.predict({"slope_along": 5}) == gonogo.Model(model_file).predict({"slope_along": 5})


def test_other_trials_help_and_vehicles_shift_a_family(root, tmp_path):
    quick = {"hidden": 4, "epochs": 2, "folds": 2, "teacher": 0}
    data = root / "data"
    together = gonogo.train([data / "quarter_wheel_90mm/dataset.h5", data / "hmmwv_32mm_fresh/dataset.h5"], tmp_path / "both.h5", learning=quick)
    assert [other["trials"] for other in together.provenance["other_trials"]] == [88]  # the whole vehicle's are finer
    family = gonogo.train(data / "wheeled_family_32mm/dataset.h5", tmp_path / "family.h5", learning=quick,
                          vehicles=[data / "viper_32mm/dataset.h5"])
    (viper,) = family.provenance["vehicle_odds"]["vehicles"]
    assert (viper["vehicle"], viper["trials"]) == ("viper", 660)
    with pytest.raises(gonogo.InputError, match="no family to calibrate"):
        gonogo.train(data / "viper_32mm/dataset.h5", tmp_path / "none.h5", vehicles=[data / "viper_32mm/dataset.h5"])


def test_a_held_out_set_is_scored(dataset_file, tmp_path):
    model = gonogo.train(dataset_file, tmp_path / "model.h5", learning={"hidden": 4, "epochs": 10, "folds": 2, "teacher": 0}, hold_out=60)
    report = gonogo.evaluate(model, dataset_file)
    assert report["trials"] > 40
    assert report["scores"]


def test_bad_settings_are_told(dataset_file, tmp_path):
    with pytest.raises(gonogo.InputError, match="hiden"):
        gonogo.train(dataset_file, tmp_path / "model.h5", learning={"hiden": 4})


def test_a_family_is_asked_for_whole_vehicles_alone(root, tmp_path):
    wheels = root / "data" / "quarter_wheel_90mm" / "dataset.h5"
    for family in (True, "wheeled_family_32mm"):
        with pytest.raises(gonogo.InputError, match="a wheel by itself"):
            gonogo.train(wheels, tmp_path / "model.h5", family=family)
