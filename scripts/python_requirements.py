#!/usr/bin/env python3
"""Prints what building and testing the Python module needs from PyPI, one requirement a line, as pyproject.toml names it."""
import pathlib
import tomllib

project = tomllib.loads((pathlib.Path(__file__).parent.parent / "pyproject.toml").read_text())
build = [name for name in project["build-system"]["requires"] if name.startswith("nanobind")]
print(*build, *project["project"]["dependencies"], *project["project"]["optional-dependencies"]["tests"], sep="\n")
