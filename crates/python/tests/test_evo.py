"""Conversion from and to evo: what the files of TUM hold."""

import numpy as np
import posecut
import pytest

pytest.importorskip("evo")
from evo.core.trajectory import PosePath3D  # noqa: E402
from evo.tools import file_interface  # noqa: E402
from posecut.evo import from_evo, to_evo  # noqa: E402


@pytest.mark.parametrize("poses", ["estimate", "truth"])
def test_a_trajectory_is_that_of_the_tum_file(poses, graph, tmp_path):
    for session in (None, graph.nodes["session"][0]):
        file = tmp_path / "poses.tum"
        graph.write(file, poses=poses, **({} if session is None else {"only_session": session}))
        theirs, ours = file_interface.read_tum_trajectory_file(file), to_evo(graph, session=session, poses=poses)
        assert np.allclose(ours.timestamps, theirs.timestamps, rtol=0, atol=1e-6)
        assert np.allclose(ours.positions_xyz, theirs.positions_xyz, rtol=0, atol=1e-9)
        assert np.allclose(ours.orientations_quat_wxyz, theirs.orientations_quat_wxyz, rtol=0, atol=1e-9)
    with pytest.raises(posecut.Error, match="no node of session 'none'"):
        to_evo(graph, session="none")


def test_trajectories_come_back(graph):
    trajectory = to_evo(graph)
    again = from_evo(trajectory, session="a")
    assert again.dimension == 3 and set(again.nodes["session"]) == {"a"}
    assert np.allclose(again.poses[:, :3], trajectory.positions_xyz) and to_evo(again) == trajectory
    assert again.nodes["utime"].tolist() == sorted(graph.nodes["utime"].tolist())
    path = PosePath3D(trajectory.positions_xyz, trajectory.orientations_quat_wxyz)
    assert to_evo(from_evo(path)) == path
