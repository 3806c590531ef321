#!/usr/bin/env python3
"""Packs the QGIS plug-in as a zip for the plug-in manager (Install from ZIP).

  scripts/qgis_zip.py [--out out/gonogo-qgis.zip] [--repository URL]

plugins.qgis.org wants the address of the sources, too: give it with --repository. The same files give the same bytes.
"""
import argparse
import configparser
import io
import pathlib
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
FOLDER = ROOT / "python/qgis/gonogo"
REQUIRED = ("name", "qgisMinimumVersion", "description", "about", "version", "author", "email")  # by plugins.qgis.org


def metadata(repository):
    """Text of metadata.txt; exits where a key that the plug-in manager shows is missing."""
    config = configparser.ConfigParser()
    config.optionxform = str  # QGIS keeps capitals
    config.read_string((FOLDER / "metadata.txt").read_text())
    general = config["general"]
    if missing := [key for key in REQUIRED if not general.get(key)]:
        sys.exit(f"{FOLDER / 'metadata.txt'}: [general] lacks {', '.join(missing)}; add them")
    if repository:
        general["repository"] = general["homepage"] = repository
        general["tracker"] = repository.rstrip("/") + "/issues"
    text = io.StringIO()
    config.write(text, space_around_delimiters=False)
    return text.getvalue()


def pack(out, repository=""):
    """Writes the zip: one folder, without compiled files, with the licence."""
    files = {path.relative_to(FOLDER).as_posix(): path.read_bytes() for path in FOLDER.rglob("*")
             if path.is_file() and "__pycache__" not in path.parts}
    files["metadata.txt"] = metadata(repository).encode()
    files["LICENSE"] = (ROOT / "LICENSE").read_bytes()
    out.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo("gonogo/" + name, date_time=(2020, 1, 1, 0, 0, 0))
            entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, files[name])
    return out


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/gonogo-qgis.zip")
    parser.add_argument("--repository", default="")
    arguments = parser.parse_args()
    made = pack(arguments.out, arguments.repository)
    print(f"{made}: {made.stat().st_size} bytes; in QGIS: Plugins, Manage and Install Plugins, Install from ZIP")
