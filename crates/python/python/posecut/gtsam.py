"""Conversion from and to gtsam's factor graphs.

gtsam orders the tangent of Pose3 as rotation, translation; posecut as translation, rotation. Errors are the same otherwise: the
logarithm of the measured pose's inverse times the relative pose.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from posecut._graph import Graph
from posecut._posecut import Error

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

# Rows of gtsam's tangent in the order of posecut's, by degrees of freedom. The orders are each other's inverse.
_ORDER = {3: [0, 1, 2], 6: [3, 4, 5, 0, 1, 2]}


def to_gtsam(graph: Graph, *, anchor: bool = True) -> tuple[Any, Any]:
    """A gtsam.NonlinearFactorGraph of the edges in use, and the gtsam.Values of the poses. Keys are the ids of the nodes.

    A fixed node gets a prior that holds it. If no node is fixed, the first one gets such a prior, so that gtsam can optimise; not so
    with anchor=False. Edges without a measurement are left out.
    """
    import gtsam
    import numpy as np

    flat = graph.dimension == 2
    between = gtsam.BetweenFactorPose2 if flat else gtsam.BetweenFactorPose3
    prior = gtsam.PriorFactorPose2 if flat else gtsam.PriorFactorPose3
    freedom = 3 if flat else 6
    order = np.ix_(_ORDER[freedom], _ORDER[freedom])
    ids, poses = [int(node) for node in graph.nodes["id"]], graph.poses
    values, factors = gtsam.Values(), gtsam.NonlinearFactorGraph()
    for node, pose in zip(ids, poses, strict=True):
        if np.isnan(pose).any():
            raise Error(f"node {node} has no pose, but gtsam needs one for every node; optimise the graph first")
        values.insert(node, _to_pose(pose))
    fixed = np.flatnonzero(graph.fixed)
    for row in fixed if len(fixed) or not anchor else range(min(1, len(ids))):
        factors.add(prior(ids[row], _to_pose(poses[row]), gtsam.noiseModel.Constrained.All(freedom)))
    measurements, information = graph.measurements, graph.information
    usable = ~graph.rejected & ~np.isnan(measurements).any(axis=1)
    for edge in np.flatnonzero(usable):
        first, second = graph.ends[edge]
        noise = _to_noise(information[edge][order])
        factors.add(between(ids[first], ids[second], _to_pose(measurements[edge]), noise))
    return factors, values


def from_gtsam(
    factors: Any,
    values: Any,
    *,
    landmark: Callable[[int, int], bool] | None = None,
    session: str = "0",
    priors: Literal["anchor", "fix", "ignore"] = "anchor",
    skip_unknown: bool = False,
) -> Graph:
    """A graph of a gtsam.NonlinearFactorGraph and gtsam.Values, with Pose2 or Pose3 throughout.

    The ids of nodes are gtsam's keys; a symbol such as x17 is frame 17 of session x, any other key is a frame of the given session.
    By default the first factor between two successive keys is odometry, and every other one a landmark edge; landmark(first, second)
    decides otherwise. Robust kernels are left out: the stages judge the edges themselves.

    posecut has no priors. With "anchor", one prior fixes its pose at its mean, which changes nothing but the position of the whole
    map, and several are an error. "fix" does so with each of them, and "ignore" leaves all out.
    """
    import gtsam
    import numpy as np

    keys = sorted(values.keys())
    flat = _is_flat(values, keys)
    freedom, width = (3, 3) if flat else (6, 7)
    between = gtsam.BetweenFactorPose2 if flat else gtsam.BetweenFactorPose3
    prior = gtsam.PriorFactorPose2 if flat else gtsam.PriorFactorPose3
    order = np.ix_(_ORDER[freedom], _ORDER[freedom])
    rows = {key: row for row, key in enumerate(keys)}
    poses = np.array([_from_pose(values.atPose2(key) if flat else values.atPose3(key)) for key in keys]).reshape(-1, width)
    ends, measurements, information, kinds = [], [], [], []
    fixed: dict[int, NDArray[np.float64]] = {}
    successive: set[tuple[int, int]] = set()
    for index in range(factors.size()):
        factor = factors.at(index)
        if factor is None:
            continue
        named = [int(key) for key in factor.keys()]
        missing = [key for key in named if key not in rows]
        if missing:
            raise Error(f"factor {index}: there is no value for key {_name(missing[0])}; give an initial estimate of every pose")
        if isinstance(factor, between):
            first, second = named
            pair = (min(named), max(named))
            is_odometry = abs(first - second) == 1 and pair not in successive
            successive.add(pair)
            ends.append((rows[first], rows[second]))
            measurements.append(_from_pose(factor.measured()))
            information.append(_from_noise(factor.noiseModel(), freedom, index)[order])
            kinds.append(landmark(first, second) if landmark is not None else not is_odometry)
        elif isinstance(factor, prior):
            fixed[named[0]] = _from_pose(factor.prior())
        elif not skip_unknown:
            names = ", ".join(_name(key) for key in named)
            raise Error(
                f"factor {index}: {type(factor).__name__} on {names} is not a relative pose or a prior of this graph's kind of poses; "
                "remove it, or set skip_unknown=True to leave out all such factors"
            )
    if priors == "anchor" and len(fixed) > 1:
        raise Error(f'there are priors on {len(fixed)} poses, which posecut cannot weigh; set priors to "fix" or "ignore"')
    flags = [None] * len(keys) if priors == "ignore" else [True if key in fixed else None for key in keys]
    for key, mean in fixed.items() if priors != "ignore" else ():
        poses[rows[key]] = mean
    sessions, frames = zip(*(_session(key, session) for key in keys), strict=True) if keys else ((), ())
    return Graph.from_arrays(
        poses,
        np.array(ends, dtype=np.int64).reshape(-1, 2),
        np.array(measurements).reshape(-1, width),
        np.array(information).reshape(-1, freedom, freedom),
        np.array(kinds, dtype=np.bool_),
        ids=keys,
        node_fields={"session": sessions, "frame": frames, "fixed": flags},
    )


def _is_flat(values: Any, keys: list[int]) -> bool:
    """Whether the values are Pose2; an error if one is neither Pose2 nor Pose3, or both kinds are there."""
    kinds = {_kind(values, key) for key in keys}
    if len(kinds) > 1:
        raise Error("the values hold poses of the plane and of space; a graph has poses of one kind")
    return kinds == {2}


def _kind(values: Any, key: int) -> int:
    for dimension, at in ((2, values.atPose2), (3, values.atPose3)):
        try:
            at(key)
            return dimension
        except RuntimeError:  # gtsam says so of another type.
            continue
    raise Error(f"the value of key {_name(key)} is no pose, but the nodes of a graph are Pose2 or Pose3; leave it out")


def _to_pose(row: NDArray[np.float64]) -> Any:
    import gtsam

    if len(row) == 3:
        return gtsam.Pose2(*row)
    x, y, z, w = row[3:]
    return gtsam.Pose3(gtsam.Rot3.Quaternion(w, x, y, z), row[:3])


def _from_pose(pose: Any) -> NDArray[np.float64]:
    import gtsam
    import numpy as np

    if isinstance(pose, gtsam.Pose2):
        return np.array([pose.x(), pose.y(), pose.theta()])
    turn = pose.rotation().toQuaternion()
    return np.array([*pose.translation(), turn.x(), turn.y(), turn.z(), turn.w()])


def _to_noise(information: NDArray[np.float64]) -> Any:
    import gtsam
    import numpy as np

    try:
        return gtsam.noiseModel.Gaussian.SqrtInformation(np.linalg.cholesky(information).T)
    except np.linalg.LinAlgError:
        # Semidefinite: any root of the matrix weighs the same.
        sizes, axes = np.linalg.eigh(information)
        root = np.linalg.qr((axes * np.sqrt(np.maximum(sizes, 0))).T)[1]
        # gtsam wants a diagonal without negative terms.
        return gtsam.noiseModel.Gaussian.SqrtInformation(root * np.where(np.diag(root) < 0, -1, 1)[:, None])


def _from_noise(noise: Any, freedom: int, index: int) -> NDArray[np.float64]:
    import gtsam
    import numpy as np

    if isinstance(noise, gtsam.noiseModel.Robust):
        noise = noise.noise()
    if noise is None:
        return np.eye(freedom)
    if not isinstance(noise, gtsam.noiseModel.Gaussian) or isinstance(noise, gtsam.noiseModel.Constrained):
        raise Error(f"factor {index}: its noise model {type(noise).__name__} has no information matrix; give it a Gaussian one")
    root = np.asarray(noise.R())
    return root.T @ root


def _session(key: int, session: str) -> tuple[str, int]:
    """The session and frame of a key: those of a symbol, or this session."""
    letter = chr(key >> 56)
    return (letter, key & ((1 << 56) - 1)) if letter.isascii() and letter.isalpha() else (session, key)


def _name(key: int) -> str:
    letter, frame = _session(key, "")
    return f"{letter}{frame}"
