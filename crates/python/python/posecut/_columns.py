"""Fields of nodes and edges by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

from posecut import _posecut

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Columns(Mapping[str, "NDArray[Any] | list[Any]"]):
    """Fields of all nodes, or of all edges, by name: a table that is read only when asked.

    Numbers and flags are arrays, with NaN where a record has no number. Texts, and whatever else a program wrote, are lists with
    None. Fields within "truth" have names such as "truth.correct". pandas.DataFrame(dict(graph.edges)) is a table of them.
    """

    __slots__ = ("_cache", "_native", "_of")

    def __init__(self, native: _posecut.Graph, of: Literal["nodes", "edges"]) -> None:
        self._native = native
        self._of = of
        self._cache: dict[str, NDArray[np.generic] | list[Any]] = {}

    def __getitem__(self, name: str) -> NDArray[Any] | list[Any]:
        if name not in self._cache:
            column = self._native.column(self._of, name)
            if column is None:
                raise KeyError(f"no {self._of[:-1]} has the field {name!r}; those with fields are {', '.join(self)}")
            self._cache[name] = column
        return self._cache[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._native.column_names(self._of))

    def __len__(self) -> int:
        return len(self._native.column_names(self._of))

    def __contains__(self, name: object) -> bool:
        return name in self._native.column_names(self._of)

    def __repr__(self) -> str:
        return f"<fields of {self._of}: {', '.join(self)}>"
