"""Packages for other programs: the QGIS plug-in by the rules of plugins.qgis.org, and the recipe of conda."""
import configparser
import pathlib
import re
import subprocess
import sys
import urllib.parse
import zipfile

import yaml

# Rules of plugins.qgis.org: qgis-app/plugins/validator.py of qgis/QGIS-Plugins-Website, commit 013f38bd.
REQUIRED = ("name", "description", "version", "qgisMinimumVersion", "author", "email", "about", "tracker", "repository")
FLAGS = ("experimental", "deprecated", "server", "supportsQt6")
LARGEST = 25_000_000  # [B]


def test_the_zip_keeps_every_rule_of_the_plug_in_repository(root, tmp_path):
    made = tmp_path / "gonogo.zip"
    address = "https://example.org/gonogo"
    subprocess.run([sys.executable, root / "scripts/qgis_zip.py", "--out", made, "--repository", address], check=True, capture_output=True)
    assert made.stat().st_size < LARGEST
    with zipfile.ZipFile(made) as archive:
        names = archive.namelist()
        assert archive.testzip() is None
        metadata = configparser.ConfigParser()
        metadata.optionxform = str
        metadata.read_string(archive.read("gonogo/metadata.txt").decode("utf8"))
    assert {name.split("/")[0] for name in names} == {"gonogo"}
    assert {"gonogo/__init__.py", "gonogo/metadata.txt", "gonogo/LICENSE"} <= set(names)
    assert not [name for name in names if ".." in name or name.startswith("/") or ".pyc" in name]
    assert not {"__MACOSX", ".git", "__pycache__"} & {part for name in names for part in name.split("/")}
    general = metadata["general"]
    assert not [key for key in REQUIRED if not general.get(key, "").strip()]
    assert re.fullmatch(r"[^/]+", general["author"])
    assert "gonogo/" + general["icon"] in names
    assert all(general.get(flag, "True").lower() in ("true", "false") for flag in FLAGS)
    for key in ("tracker", "repository", "homepage"):
        parsed = urllib.parse.urlparse(general[key])
        assert parsed.scheme == "https" and parsed.netloc
    assert not re.search(r"[<>]", general["about"] + general["description"])  # shown as HTML


def test_versions_are_one(root):
    project = re.search(r"project\(gonogo VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]
    recipe = yaml.safe_load((root / "recipe/recipe.yaml").read_text())
    assert recipe["context"]["version"] == project
    for file, pattern in (("pyproject.toml", r'^version = "(.*)"'), ("CITATION.cff", r"^version: (.*)"),
                          ("python/qgis/gonogo/metadata.txt", r"^version=(.*)")):
        assert re.search(pattern, (root / file).read_text(), re.MULTILINE)[1] == project, file


# Packages of conda-forge for what CMake looks for; the rest comes with the compiler, or is left out by the recipe's options.
HOST = {"Boost": "libboost-headers", "CLI11": "cli11", "Eigen3": "eigen", "GDAL": "libgdal-core", "HDF5": "hdf5", "PNG": "libpng",
        "nanobind": "nanobind", "nlohmann_json": "nlohmann_json", "Python": "python"}
LEFT_OUT = {"CUDAToolkit", "Torch", "MPI", "Catch2", "Python3"}
OF_THE_COMPILER = {"OpenMP", "Threads", "PkgConfig"}


def test_the_recipe_names_every_library_that_cmake_looks_for(root):
    recipe = yaml.safe_load(re.sub(r"- \$\{\{.*\}\}.*", "- templated", (root / "recipe/recipe.yaml").read_text()))
    host = {str(line).split()[0] for line in recipe["requirements"]["host"]}
    found = set()
    for file in root.rglob("CMakeLists.txt"):
        parts = file.relative_to(root).parts
        if parts[0] not in ("build", "examples", "tests", ".cache", "out"):
            found |= set(re.findall(r"find_package\((\w+)", file.read_text()))
    assert found <= set(HOST) | LEFT_OUT | OF_THE_COMPILER
    assert {HOST[name] for name in found & set(HOST)} | {"cairo", "xxhash"} <= host
    assert pathlib.Path(root / recipe["about"]["license_file"]).is_file()
