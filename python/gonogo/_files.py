"""Files that ship with the package."""
import os
from collections.abc import Sequence
from pathlib import Path

PathLike = str | os.PathLike[str]


def shipped(kind: str) -> Sequence[str]:
    """Names of what ships of a kind: "models", "vehicles", "soils" or "studies"."""
    if kind == "models":
        from . import _core

        return _core.shipped_models()
    return sorted(path.stem for path in (Path(os.environ["GONOGO_SHARE"]) / "configs" / kind).glob("*.json"))


def study_file(name: PathLike) -> str:
    """A study's path, or the shipped study of this name."""
    from . import _core

    return _core.shipped_file("studies", "study", os.fspath(name))
