"""Pose graphs."""

from __future__ import annotations

import json
import logging
import os
import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Union

from posecut import _posecut
from posecut._columns import Columns
from posecut._options import Option, words

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

Path = Union[str, "os.PathLike[str]"]

_LOGGER = logging.getLogger("posecut")


class Doubt(UserWarning):
    """A reason to check a result before trusting it: the programs print it even with --quiet."""


class Graph:
    """A pose graph. It never changes: each method returns a new graph.

    Arrays cannot be written to; they belong to the graph and are made once. Rows are nodes or edges in ascending order of id. What a
    record does not have is NaN.
    """

    __slots__ = ("_ends", "_flagged", "_native", "_tables", "doubts", "messages", "statistics")

    _native: _posecut.Graph
    _tables: dict[str, NDArray[np.float64]]
    _flagged: dict[str, NDArray[np.bool_]]
    _ends: NDArray[np.int64] | None

    #: Figures of the last stage: what its program writes to --stats.
    statistics: dict[str, Any]
    #: Names of the doubts of the last stage (docs/doubts.md).
    doubts: list[str]
    #: What the last stage said.
    messages: list[str]

    def __init__(self) -> None:
        raise TypeError("graphs come from posecut.read, Graph.from_arrays or Graph.from_bytes")

    # ---- making ----

    @classmethod
    def _of(cls, native: _posecut.Graph) -> Graph:
        graph = cls.__new__(cls)
        graph._native = native
        graph._tables, graph._flagged, graph._ends = {}, {}, None
        graph.statistics, graph.doubts, graph.messages = {}, [], []
        return graph

    @staticmethod
    def from_arrays(
        poses: ArrayLike,
        ends: ArrayLike,
        measurements: ArrayLike,
        information: ArrayLike,
        landmark: ArrayLike | None = None,
        *,
        ids: Sequence[int] | None = None,
        edge_ids: Sequence[int] | None = None,
        node_fields: Mapping[str, Iterable[Any]] | None = None,
        edge_fields: Mapping[str, Iterable[Any]] | None = None,
    ) -> Graph:
        """A graph of arrays, with the shapes of the properties of the same names.

        poses: (N, 3) or (N, 7). ends: (E, 2), rows of poses. measurements: (E, 3) or (E, 7). information: (E, 3, 3) or (E, 6, 6), or
        one matrix for all edges, in the order translation, rotation. landmark: (E,) flags; by default the first edge between two
        successive rows is odometry, and each other one a landmark edge. Further fields go by their names in the format, such as
        node_fields={"session": [...], "frame": [...]}; by default the session is "0" and the frame the row.
        """
        import numpy as np

        poses = np.asarray(poses, dtype=np.float64)
        ends = np.asarray(ends, dtype=np.int64).reshape(-1, 2)
        information = np.asarray(information, dtype=np.float64)
        if information.ndim == 2:
            information = np.broadcast_to(information, (len(ends), *information.shape))
        kinds = _landmark(ends) if landmark is None else np.asarray(landmark, dtype=np.bool_)
        fields: dict[str, Iterable[Any]] = {"session": ["0"] * len(poses), "frame": range(len(poses))}
        return Graph._of(
            _posecut.from_arrays(
                poses,
                ends,
                np.asarray(measurements, dtype=np.float64),
                information,
                kinds,
                None if ids is None else [int(value) for value in ids],
                None if edge_ids is None else [int(value) for value in edge_ids],
                _fields({**fields, **(node_fields or {})}),
                _fields(edge_fields or {}),
            )
        )

    @staticmethod
    def from_bytes(content: bytes, name: str = "bytes") -> Graph:
        """A graph of the bytes of pose-graph JSON Lines; errors call them by this name."""
        return Graph._of(_posecut.from_bytes(content, name))

    # ---- looking ----

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return self._native.dimension

    @property
    def poses(self) -> NDArray[np.float64]:
        """(N, 3) or (N, 7): the estimates, world from body."""
        return self._table("poses")

    @property
    def truth(self) -> NDArray[np.float64]:
        """(N, 3) or (N, 7): the ground truth."""
        return self._table("truth")

    @property
    def fixed(self) -> NDArray[np.bool_]:
        """(N,): whether the node stays at its pose."""
        return self._flags("fixed")

    @property
    def ends(self) -> NDArray[np.int64]:
        """(E, 2): the rows of the nodes that each edge joins. Their ids are graph.edges["from"] and graph.edges["to"]."""
        if self._ends is None:
            self._ends = self._native.ends()
        return self._ends

    @property
    def measurements(self) -> NDArray[np.float64]:
        """(E, 3) or (E, 7): the pose of the second node in the frame of the first."""
        return self._table("measurements")

    @property
    def information(self) -> NDArray[np.float64]:
        """(E, 3, 3) or (E, 6, 6): the information matrices, in the order translation, rotation."""
        return self._table("information")

    @property
    def landmark(self) -> NDArray[np.bool_]:
        """(E,): whether it is a landmark edge; else it is odometry."""
        return self._flags("landmark")

    @property
    def rejected(self) -> NDArray[np.bool_]:
        """(E,): whether a stage has rejected the edge; graph.edges["rejected_by"] says which."""
        return self._flags("rejected")

    @property
    def nodes(self) -> Columns:
        """The fields of the nodes by name: id, session, frame, utime, and those that other programs wrote."""
        return Columns(self._native, "nodes")

    @property
    def edges(self) -> Columns:
        """The fields of the edges by name: id, kind, from, to, rejected_by, cost, score, verify_probability and others."""
        return Columns(self._native, "edges")

    def field(self, name: str) -> NDArray[Any] | list[Any]:
        """A field of all edges: graph.edges[name]."""
        return self.edges[name]

    @property
    def provenance(self) -> list[dict[str, Any]]:
        """What each stage did, oldest first."""
        found: list[dict[str, Any]] = json.loads(self._native.provenance())
        return found

    def __repr__(self) -> str:
        rejected = int(self.rejected.sum())
        return (
            f"<posecut.Graph of dimension {self.dimension}: {self._native.node_count} nodes, {self._native.edge_count} edges, "
            f"{int(self.landmark.sum())} of them landmark edges, {rejected} rejected>"
        )

    # ---- stages ----

    def verify(self, **options: Option) -> Graph:
        """Judges every landmark edge by evidence: accepted, rejected or undecided, with a reason (posecut-verify)."""
        return self._run("verify", options)

    def pcm(self, **options: Option) -> Graph:
        """Rejects edges outside the largest pairwise consistent set (posecut-pcm)."""
        return self._run("pcm", options)

    def multicut(self, **options: Option) -> Graph:
        """Rejects edges that a minimum-cost multicut cuts (posecut-multicut)."""
        return self._run("multicut", options)

    def optimize(self, **options: Option) -> Graph:
        """Optimises the poses over the edges in use (posecut-optimize)."""
        return self._run("optimize", options)

    def readmit(self, **options: Option) -> Graph:
        """Judges every edge by the map that the others make (posecut-readmit)."""
        return self._run("readmit", options)

    def label(self, **options: Option) -> Graph:
        """Writes which landmark edges are correct, from labels or ground truth (posecut-label)."""
        return self._run("label", options)

    def run(self, stage: str, /, **options: Option) -> Graph:
        """Runs any stage by its name, such as "ransac" or "oracle". posecut.options(stage) lists its options."""
        return self._run(stage, options)

    def evaluate(self, reference: Graph | None = None, **options: Option) -> dict[str, Any]:
        """Compares with a reference, or with the graph's own truth: what posecut-evaluate writes."""
        native = None if reference is None else reference._native
        result: dict[str, Any] = json.loads(self._native.evaluate(native, words(options)))
        return result

    def _run(self, stage: str, options: Mapping[str, Option]) -> Graph:
        native, said = self._native.run(stage, words(options))
        return _reported(Graph._of(native), said)

    # ---- changing ----

    def with_poses(self, poses: ArrayLike) -> Graph:
        """The graph with these poses, such as those of another optimiser. A row of NaN is a node without a pose."""
        import numpy as np

        return Graph._of(self._native.with_poses(np.asarray(poses, dtype=np.float64)))

    def with_rejected(self, rejected: ArrayLike, by: str = "python") -> Graph:
        """The graph in which exactly these edges are rejected. New rejections get this name; earlier ones keep theirs."""
        import numpy as np

        return Graph._of(self._native.with_rejected(np.asarray(rejected, dtype=np.bool_), by))

    def without_rejected(self) -> Graph:
        """The graph without its rejected edges, for tools that do not know the mark."""
        return Graph._of(self._native.without_rejected())

    # ---- writing ----

    def write(self, path: Path, **options: Option) -> None:
        """Writes a file in the format of its name (.jsonl, .g2o, .toro, .jrl, .tum, .kitti, also with .gz), or that of to="g2o".

        The file appears completely or not at all. Only JSON Lines hold everything; other formats leave out rejected edges, unless
        keep_rejected=True. The other options are those of posecut-convert.
        """
        _log(self._native.write(path, words(options)))

    def to_bytes(self, **options: Option) -> bytes:
        """The content of the file that write(path, **options) writes, JSON Lines by default."""
        content, said = self._native.to_bytes(words(options))
        _log(said)
        return content

    def __reduce__(self) -> tuple[Any, ...]:
        return (_restored, (self.to_bytes(), self.statistics, self.doubts, self.messages))

    def _table(self, which: Literal["poses", "truth", "measurements", "information"]) -> NDArray[np.float64]:
        if which not in self._tables:
            self._tables[which] = self._native.table(which)
        return self._tables[which]

    def _flags(self, which: Literal["landmark", "rejected", "fixed"]) -> NDArray[np.bool_]:
        if which not in self._flagged:
            self._flagged[which] = self._native.flags(which)
        return self._flagged[which]


def read(paths: Path | Iterable[Path], /, **options: Option) -> Graph:
    """Reads a graph from a file, or one graph from several: pose-graph JSON Lines, g2o, TORO, JRL, TUM or KITTI, also compressed.

    The format is that of the content. The options are those of posecut-convert: odometry="next-id", session="a",
    repair_information=True, skip_unknown=True, closures="table.csv", from_="tum" and others.
    """
    several = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    native, said = _posecut.read(several, words(options))
    return _reported(Graph._of(native), said)


def options(stage: str) -> str:
    """The options of a stage, as the help of its program shows them: --max-iterations 5 is max_iterations=5 here."""
    return _posecut.help(stage)


def _reported(graph: Graph, said: tuple[str, list[str], list[tuple[str, str]]]) -> Graph:
    """The graph with what its stage reported, after that has been passed on."""
    graph.statistics, graph.doubts = json.loads(said[0]), said[1]
    graph.messages = [text for _, text in said[2]]
    for kind, text in said[2]:
        if kind == "doubt":
            # The caller of the method of this module that called.
            warnings.warn(text, Doubt, stacklevel=4)
    _log(said)
    return graph


def _log(said: tuple[str, list[str], list[tuple[str, str]]]) -> None:
    levels = {"information": logging.INFO, "warning": logging.WARNING}
    for kind, text in said[2]:
        if kind in levels:
            _LOGGER.log(levels[kind], text)


def _landmark(ends: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Every edge but the first between two successive rows."""
    import numpy as np

    low = ends.min(axis=1, initial=np.iinfo(np.int64).max)
    landmark = np.ones(len(ends), dtype=np.bool_)
    successive = np.flatnonzero(np.abs(ends[:, 0] - ends[:, 1]) == 1)
    landmark[successive[np.unique(low[successive], return_index=True)[1]]] = False
    return landmark


def _fields(fields: Mapping[str, Iterable[Any]]) -> str:
    """Columns as JSON; scalars of numpy become those of Python."""
    return json.dumps({name: list(values) for name, values in fields.items()}, default=lambda value: value.item())


def _restored(content: bytes, statistics: dict[str, Any], doubts: list[str], messages: list[str]) -> Graph:
    graph = Graph.from_bytes(content, "pickle")
    graph.statistics, graph.doubts, graph.messages = statistics, doubts, messages
    return graph
