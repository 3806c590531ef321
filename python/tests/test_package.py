"""The package as a whole: version, import, documentation, stubs."""
import inspect
import pathlib
import subprocess
import sys

import gonogo
from gonogo import _core


def test_version_is_the_programs(program):
    done = subprocess.run([program, "--version"], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == f"gonogo {gonogo.__version__} ({gonogo.revision()})"


def test_import_loads_nothing_heavy():
    code = "import sys, gonogo; print(*sorted({m.split('.')[0] for m in sys.modules} & {'pandas', 'dimod', 'sklearn', 'torch', 'osgeo'}))"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == ""


def test_the_module_loads_neither_torch_nor_gdal():
    loaded = subprocess.run(["ldd", _core.__file__], check=True, capture_output=True, text=True).stdout
    assert "libstdc++" in loaded
    assert not any(name in loaded for name in ("torch", "gdal", "cairo"))


def test_everything_public_is_documented():
    for name in gonogo.__all__:
        thing = getattr(gonogo, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and thing.__module__.startswith("gonogo._") and not issubclass(thing, (Exception, tuple)):
            members = [m for m in vars(thing) if not m.startswith("_") and callable(getattr(thing, m))]
            assert members or vars(thing)


def test_stubs_and_package_are_strictly_typed():
    folder = pathlib.Path(gonogo.__file__).parent
    checked = ["gonogo", "gonogo._core", "gonogo._map", "gonogo._train", "gonogo.worker"]  # not what wraps untyped packages
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", *(f"-m{name}" for name in checked)], cwd=folder.parent,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_shipped_files_are_found():
    assert "hmmwv" in gonogo.shipped("vehicles")
    assert "calibration_90mm" in gonogo.shipped("soils")
    assert "demo" in gonogo.shipped("studies")
