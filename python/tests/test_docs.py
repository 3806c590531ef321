"""The examples of docs/python.md."""
import re

import pytest


@pytest.fixture(scope="module")
def blocks(root):
    text = (root / "docs" / "python.md").read_text()
    return re.findall(r"^## ([^\n]+)\n(?:(?!^## ).)*?```python\n(.*?)```", text, re.S | re.M)


def test_all_of_them_are_python(blocks):
    assert len(blocks) >= 5
    for title, code in blocks:
        compile(code, title, "exec")


def test_those_of_models_run(blocks, model_file):
    scope = {}
    code = dict(blocks)
    for title in ("Ask a model", "Anneal"):
        exec(code[title].replace('gonogo.Model("hmmwv")', f"gonogo.Model({str(model_file)!r})"), scope)
    assert scope["answer"].summary["energies"] == "verified"


def test_those_of_driving_run(blocks):
    scope = {}
    code = dict(blocks)
    exec("import gonogo\n" + code["Simulate"][code["Simulate"].index("ground = "):], scope)
    assert scope["simulation"].body(scope["driven"].chassis).velocity[0, 0] > 1
    exec(code["Learn to drive"], scope)
    assert scope["observation"].shape == (8, 7) and not scope["info"]["failed"].any()
