"""Conversion from and to evo's trajectories."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from posecut._graph import Graph
from posecut._posecut import Error

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def to_evo(graph: Graph, *, session: str | None = None, poses: Literal["estimate", "truth"] = "estimate") -> Any:
    """An evo PoseTrajectory3D of the nodes that have a pose and a time (utime), of one session or of all; z is 0 in the plane.

    If no node has a time, it is an evo PosePath3D.
    """
    import numpy as np
    from evo.core.trajectory import PosePath3D, PoseTrajectory3D

    table = _spatial(graph.poses if poses == "estimate" else graph.truth)
    times = np.asarray(graph.nodes["utime"], dtype=np.float64) * 1e-6
    chosen = ~np.isnan(table).any(axis=1)
    if session is not None:
        chosen &= np.array([name == session for name in graph.nodes["session"]], dtype=np.bool_)
    timed = chosen & ~np.isnan(times)
    if not chosen.any():
        which = "of this graph" if session is None else f"of session {session!r}"
        raise Error(f"no node {which} has a pose of the kind {poses!r}; choose others")
    if not timed.any():
        return PosePath3D(table[chosen, :3], table[chosen][:, [6, 3, 4, 5]])
    order = np.flatnonzero(timed)[np.argsort(times[timed], kind="stable")]
    return PoseTrajectory3D(table[order, :3], table[order][:, [6, 3, 4, 5]], times[order])


def from_evo(trajectory: Any, *, session: str = "0") -> Graph:
    """A graph of the poses of an evo trajectory or path, without edges, as posecut.read reads a file of TUM or KITTI."""
    import numpy as np

    count = trajectory.num_poses
    poses = np.hstack([trajectory.positions_xyz, np.asarray(trajectory.orientations_quat_wxyz)[:, [1, 2, 3, 0]]])
    stamps = getattr(trajectory, "timestamps", None)
    times = {} if stamps is None else {"utime": [round(stamp * 1e6) for stamp in np.asarray(stamps).tolist()]}
    return Graph.from_arrays(
        poses,
        np.empty((0, 2), dtype=np.int64),
        np.empty((0, 7)),
        np.empty((0, 6, 6)),
        node_fields={"session": [session] * count, "frame": range(count), **times},
    )


def _spatial(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Poses of the plane in space."""
    import numpy as np

    if poses.shape[1] == 7:
        return poses
    x, y, angle = poses.T
    zero = np.where(np.isnan(angle), np.nan, 0.0)
    return np.stack([x, y, zero, zero, zero, np.sin(angle / 2), np.cos(angle / 2)], axis=1)
