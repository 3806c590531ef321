"""Datasets of trials."""
import os
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from . import _core
from ._contract import names
from ._files import PathLike

if TYPE_CHECKING:
    import pandas


class Dataset:
    """The trials of a campaign: dataset.h5, one row per trial."""

    def __init__(self, path: PathLike) -> None:
        """Raises InputError for a file that is missing, damaged or of another contract."""
        self._dataset = _core.Dataset.read(os.fspath(path))

    def __len__(self) -> int:
        return len(self._dataset)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Column name -> array [n], in the units of the contract. verdict and reason are codes."""
        columns: dict[str, NDArray[Any]] = self._dataset.columns()
        return columns

    def to_pandas(self) -> "pandas.DataFrame":
        """One row per trial with the columns of `gonogo dataset export`; verdict and reason are categories."""
        import pandas

        frame = pandas.DataFrame(self.columns())
        for column, section in (("verdict", "verdicts"), ("reason", "reasons")):
            name_of = names(section)
            frame[column] = pandas.Categorical(frame[column].map(name_of), categories=list(name_of.values()))
        frame["failed_checks"] = frame["failed_checks"].map(_core.names_of_checks)
        return frame

    def to_csv(self) -> str:
        """Header and one line per trial, as `gonogo dataset export` writes them."""
        return self._dataset.csv()

    def write(self, path: PathLike) -> None:
        """Writes the HDF5 file, byte for byte as it was read."""
        self._dataset.write(os.fspath(path))

    def summary(self) -> dict[str, Any]:
        """Counts of verdicts and reasons, ranges of variables and measures, agreement of replicates."""
        return self._dataset.summary()

    def provenance(self) -> dict[str, Any]:
        """What the rows depend on: study, program, contract, inputs and libraries."""
        return self._dataset.provenance()
