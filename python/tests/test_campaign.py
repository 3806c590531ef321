import subprocess

import numpy as np
import pytest

import gonogo


def test_the_program_writes_the_same_bytes(study, program, tmp_path):
    campaign = gonogo.Campaign(study, tmp_path / "python")
    calls = []
    dataset = campaign.run(workers=2, progress=lambda done, trials: calls.append((done, trials)), progress_interval=0.1)
    assert len(dataset) == 3
    assert calls[-1] == (3, 3)
    subprocess.run([program, "campaign", "run", study, "--out", tmp_path / "program", "--workers", "1"], check=True, capture_output=True)
    ours, theirs = ((tmp_path / name / "dataset.h5").read_bytes() for name in ("python", "program"))
    assert ours == theirs
    design = campaign.design()
    frame = dataset.to_pandas().reindex(columns=[v.name for v in gonogo.variables()], fill_value=0)  # no sizes of obstacles
    assert np.array_equal(frame.to_numpy(), design)
    status = campaign.status()
    assert (status["done"], status["trials"], status["running"]) == (3, 3, False)
    before = (tmp_path / "python" / "dataset.h5").stat().st_mtime_ns
    campaign.run(workers=1)
    assert (tmp_path / "python" / "dataset.h5").stat().st_mtime_ns == before


def test_a_study_that_is_missing_is_told(tmp_path):
    with pytest.raises(gonogo.InputError, match="no_study"):
        gonogo.Campaign("no_study", tmp_path)
