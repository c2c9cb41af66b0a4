"""Conversion from and to gtsam: the same cost of the same poses."""

import numpy as np
import posecut
import pytest
from conftest import drive

pytestmark = pytest.mark.filterwarnings("ignore::posecut.Doubt")
gtsam = pytest.importorskip("gtsam")
from posecut.gtsam import from_gtsam, to_gtsam  # noqa: E402


def graphs():
    return [drive(260, 40, dimension).verify() for dimension in (2, 3)]


@pytest.mark.parametrize("graph", graphs(), ids=["plane", "space"])
def test_gtsam_finds_the_same_cost(graph):
    for estimate in (graph, graph.optimize()):
        factors, values = to_gtsam(estimate)
        assert 0 < graph.rejected.sum() and factors.size() == 1 + (~graph.rejected).sum()
        chi_square = estimate.optimize(initialisation="given", max_iterations=0).statistics["chi_square_initial"]
        assert 2 * factors.error(values) == pytest.approx(chi_square, rel=1e-9)


@pytest.mark.parametrize("graph", graphs(), ids=["plane", "space"])
def test_gtsam_finds_the_same_optimum(graph):
    factors, values = to_gtsam(graph)
    optimum = gtsam.LevenbergMarquardtOptimizer(factors, values).optimize()
    theirs = from_gtsam(factors, optimum).poses
    ours = graph.optimize().poses
    # gtsam holds the first node, posecut wherever it began.
    apart = np.linalg.norm(theirs[:, :2] - theirs[0, :2], axis=1) - np.linalg.norm(ours[:, :2] - ours[0, :2], axis=1)
    assert abs(apart).max() < 1e-3


def unique(poses):
    """Poses whose angles or quaternions have one form."""
    position, turn = (poses[:, :2], poses[:, 2:]) if poses.shape[1] == 3 else (poses[:, :3], poses[:, 3:])
    products = [np.cos(turn), np.sin(turn)] if turn.shape[1] == 1 else [(turn[:, :, None] * turn[:, None]).reshape(-1, 16)]
    return np.hstack([position, *products])


@pytest.mark.parametrize("graph", graphs(), ids=["plane", "space"])
def test_graphs_come_back(graph):
    used = graph.without_rejected()
    again = from_gtsam(*to_gtsam(graph, anchor=False))
    assert np.allclose(unique(again.poses), unique(used.poses), atol=1e-12)
    assert (again.ends == used.ends).all() and (again.landmark == used.landmark).all()
    assert np.allclose(unique(again.measurements), unique(used.measurements), atol=1e-12)
    assert np.allclose(again.information, used.information, rtol=1e-9, atol=1e-9)
    assert not again.fixed.any() and from_gtsam(*to_gtsam(graph)).fixed.tolist() == [True] + [False] * (len(used.poses) - 1)


def factor_graph():
    """Two robots with symbols, a robust closure and one prior."""
    factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    a, b = (lambda frame: gtsam.symbol("a", frame)), (lambda frame: gtsam.symbol("b", frame))
    noise = gtsam.noiseModel.Diagonal.Sigmas(np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6]))
    robust = gtsam.noiseModel.Robust.Create(gtsam.noiseModel.mEstimator.Huber.Create(1.3), noise)
    step = gtsam.Pose3(gtsam.Rot3.RzRyRx(0.1, 0.2, 0.3), np.array([1.0, 2, 3]))
    for key in (a(0), a(1), b(0), b(1)):
        values.insert(key, gtsam.Pose3())
    factors.add(gtsam.BetweenFactorPose3(a(0), a(1), step, noise))
    factors.add(gtsam.BetweenFactorPose3(b(0), b(1), step, noise))
    factors.add(gtsam.BetweenFactorPose3(a(0), b(1), step, robust))
    factors.add(gtsam.PriorFactorPose3(a(0), step, noise))
    return factors, values, noise


def test_symbols_noise_and_priors_are_understood():
    factors, values, noise = factor_graph()
    graph = from_gtsam(factors, values)
    assert graph.nodes["session"] == ["a", "a", "b", "b"] and graph.nodes["frame"].tolist() == [0, 1, 0, 1]
    assert graph.landmark.tolist() == [False, False, True]
    # gtsam has rotations first.
    assert np.allclose(np.diag(graph.information[2]), 1 / np.square([0.4, 0.5, 0.6, 0.1, 0.2, 0.3]))
    assert graph.fixed.tolist() == [True, False, False, False] and np.allclose(graph.poses[0, :3], [1, 2, 3])
    assert from_gtsam(factors, values, landmark=lambda first, second: True).landmark.all()
    factors.add(gtsam.PriorFactorPose3(gtsam.symbol("b", 0), gtsam.Pose3(), noise))
    with pytest.raises(posecut.Error, match="priors on 2 poses"):
        from_gtsam(factors, values)
    assert from_gtsam(factors, values, priors="fix").fixed.sum() == 2
    assert from_gtsam(factors, values, priors="ignore").fixed.sum() == 0


def test_what_posecut_does_not_know_is_refused():
    factors, values, noise = factor_graph()
    factors.add(gtsam.BearingRangeFactor3D(gtsam.symbol("a", 0), gtsam.symbol("a", 1), gtsam.Unit3(), 1.0, noise))
    with pytest.raises(posecut.Error, match="factor 4: .* on a0, a1 is not a relative pose"):
        from_gtsam(factors, values)
    assert len(from_gtsam(factors, values, skip_unknown=True).ends) == 3
    lost, some = gtsam.NonlinearFactorGraph(), gtsam.Values()
    some.insert(0, gtsam.Pose2())
    lost.add(gtsam.BetweenFactorPose2(0, 1, gtsam.Pose2(), gtsam.noiseModel.Unit.Create(3)))
    with pytest.raises(posecut.Error, match="no value for key 1"):
        from_gtsam(lost, some)
    some.insert(1, gtsam.Point2(0, 0))
    with pytest.raises(posecut.Error, match="key 1 is no pose"):
        from_gtsam(lost, some)
    graph = drive(250, 2)
    poses = graph.poses.copy()
    poses[17] = np.nan
    with pytest.raises(posecut.Error, match="node 17 has no pose"):
        to_gtsam(graph.with_poses(poses))
    singular = posecut.Graph.from_arrays(np.zeros((2, 3)), [[0, 1]], [[1, 2, 0.5]], np.diag([4.0, 0, 9]))
    factors, values = to_gtsam(singular)
    chi_square = singular.optimize(initialisation="given", max_iterations=0).statistics["chi_square_initial"]
    assert 2 * factors.error(values) == pytest.approx(chi_square)
