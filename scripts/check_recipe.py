#!/usr/bin/env python3
"""conda's recipe where conda's hosts do not resolve: rendered for linux-64, then a package of what the build folder installs, made and
tested by rattler-build. Its requirements, and the test of the Python module, are left out, as no channel holds them here.

  python3 -m venv v && v/bin/pip install py-rattler-build pyyaml
  v/bin/python scripts/check_recipe.py [build folder, build/cpu-release]
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import yaml
from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, ToolConfiguration, VariantConfig

ROOT = pathlib.Path(__file__).resolve().parents[1]
VARIANT = {"python": ["3.12.*"], "cxx_compiler": ["gxx"], "c_stdlib": ["sysroot"], "c_stdlib_version": ["2.17"]}


def rendered(file, variant):
    linux = PlatformConfig(target_platform="linux-64", build_platform="linux-64", host_platform="linux-64")
    (only,) = Stage0Recipe.from_file(file).render(VariantConfig(variant), RenderConfig(platform=linux))
    return only


def write_channel(folder):
    """One without packages."""
    for platform in ("noarch", "linux-64"):
        (folder / platform).mkdir(parents=True)
        empty = {"info": {"subdir": platform}, "packages": {}, "packages.conda": {}, "repodata_version": 1}
        (folder / platform / "repodata.json").write_text(json.dumps(empty))
    return folder.as_uri()


def main(build):
    whole = rendered(ROOT / "recipe/recipe.yaml", VARIANT).recipe.to_dict()
    counts = {kind: len(names) for kind, names in whole["requirements"].items()}
    print(f"rendered {whole['package']['name']} {whole['package']['version']}, requirements: {counts}")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run(["cmake", "--install", build, "--prefix", folder / "tree"], check=True, stdout=subprocess.DEVNULL)
        part = {key: whole[key] for key in ("schema_version", "package", "about")}
        part["about"] = {key: value for key, value in part["about"].items() if key != "license_file"}
        part["source"] = [{"path": str(folder / "tree"), "use_gitignore": False}]
        part["build"] = {"number": 0, "script": ["cp -a . $PREFIX/"]}
        part["tests"] = [test for test in whole["tests"] if "python" not in test]
        (folder / "recipe.yaml").write_text(yaml.safe_dump(part))
        made = rendered(folder / "recipe.yaml", {}).run_build(ToolConfiguration(test_strategy="native"), output_dir=folder / "out",
                                                              channels=[write_channel(folder / "channel")])
        size = sum(path.stat().st_size for path in (folder / "out/linux-64").glob("*.conda"))
    print(f"{made}: {size / 1e6:.1f} MB, {len(part['tests'])} tests passed")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "build/cpu-release")
