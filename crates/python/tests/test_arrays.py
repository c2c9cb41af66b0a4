"""Arrays: what the file says, in rows."""

import numpy as np
import posecut
import pytest
from conftest import drive, records


def test_arrays_are_what_the_file_says(path, graph):
    found = records(path.read_bytes())
    models = {name: model["information"] for name, model in found[0]["noise_models"].items()}
    nodes = [record for record in found if record["kind"] == "node"]
    edges = [record for record in found if record["kind"] in ("odometry", "landmark")]
    assert graph.dimension == 2
    assert graph.poses.tolist() == [node["pose"] for node in nodes]
    assert graph.truth.tolist() == [node["truth"]["pose"] for node in nodes]
    assert graph.nodes["session"] == [node["session"] for node in nodes]
    assert graph.nodes["utime"].tolist() == [node["utime"] for node in nodes]
    assert graph.measurements.tolist() == [edge["measurement"] for edge in edges]
    rows, columns = np.triu_indices(3)
    upper = graph.information[:, rows, columns]
    assert upper.tolist() == [models[edge["noise"]] for edge in edges]
    assert (graph.information == graph.information.transpose(0, 2, 1)).all()
    assert graph.edges["from"].tolist() == [edge["from"] for edge in edges]
    assert graph.nodes["id"][graph.ends[:, 1]].tolist() == [edge["to"] for edge in edges]
    assert graph.landmark.tolist() == [edge["kind"] == "landmark" for edge in edges]
    assert graph.edges["truth.correct"] == [edge.get("truth", {}).get("correct") for edge in edges]
    assert not graph.rejected.any() and not graph.fixed.any()
    judged = graph.verify()
    assert (np.array(judged.edges["rejected_by"]) == "verify").tolist() == judged.rejected.tolist()
    assert (np.isnan(judged.field("verify_probability")) == ~judged.landmark).all()
    assert judged.edges["verify_reason"][0] is None


def test_arrays_are_made_once_and_cannot_be_written_to(graph):
    for name in ("poses", "truth", "measurements", "information", "ends", "landmark", "rejected", "fixed"):
        array = getattr(graph, name)
        assert array is getattr(graph, name)
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_arrays_outlive_their_graph(path):
    poses = posecut.read(path).poses
    assert poses.tolist() == posecut.read(path).poses.tolist()


def test_what_is_absent_is_nan_or_none():
    lines = [
        '{"kind":"header","format":"posecut","version":1,"dimension":3}',
        '{"kind":"node","id":7,"frame":3,"mood":"fine"}',
        '{"kind":"node","id":18446744073709551615,"pose":[1,2,3,0,0,0,1],"fixed":true,"shade":[1,2]}',
        '{"kind":"landmark","id":4,"from":18446744073709551615,"to":7,"score":0.5,"big":9007199254740993}',
        '{"kind":"landmark","id":5,"from":7,"to":18446744073709551615,"rejected_by":"me","score":1,"flag":true}',
    ]
    graph = posecut.Graph.from_bytes("\n".join(lines).encode())
    assert np.isnan(graph.poses[0]).all() and graph.poses[1].tolist() == [1, 2, 3, 0, 0, 0, 1]
    assert graph.poses.shape == (2, 7) and np.isnan(graph.information).all() and graph.information.shape == (2, 6, 6)
    assert graph.ends.tolist() == [[1, 0], [0, 1]] and graph.fixed.tolist() == [False, True]
    assert graph.nodes["id"].dtype == np.uint64 and int(graph.nodes["id"][1]) == 2**64 - 1
    assert graph.nodes["frame"][0] == 3 and np.isnan(graph.nodes["frame"][1])
    assert graph.nodes["mood"] == ["fine", None] and graph.nodes["shade"] == [None, [1, 2]]
    assert graph.edges["big"] == [9007199254740993, None] and graph.edges["flag"] == [None, True]
    assert graph.edges["score"].tolist() == [0.5, 1] and np.isnan(graph.edges["cost"]).all()
    assert list(graph.edges) == ["id", "kind", "from", "to", "rejected_by", "score", "big", "flag"]
    assert set(dict(graph.nodes)) == {"id", "session", "frame", "mood", "fixed", "shade"}
    assert "mood" in graph.nodes and "mood" not in graph.edges
    with pytest.raises(KeyError, match="no edge has the field 'mood'"):
        graph.field("mood")


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_graph_comes_back_from_its_arrays(dimension):
    graph = drive(250, 40, dimension)
    assert graph.landmark.sum() == 40 and graph.nodes["frame"].tolist() == list(range(250))
    again = posecut.Graph.from_arrays(
        graph.poses,
        graph.ends,
        graph.measurements,
        graph.information,
        graph.landmark,
        ids=graph.nodes["id"],
        edge_ids=graph.edges["id"],
        node_fields={name: graph.nodes[name] for name in ("session", "frame")},
    )
    assert again.to_bytes() == graph.to_bytes()


def test_arrays_that_do_not_fit_are_refused(graph):
    given = [graph.poses, graph.ends, graph.measurements, graph.information, graph.landmark]
    nan = graph.poses.copy()
    nan[3, 1] = np.nan
    indefinite = graph.information.copy()
    indefinite[5] = np.diag([1, -1, 1])
    unequal = graph.information.copy()
    unequal[5, 0, 1] = 1
    for position, array, sentence in [
        (0, graph.poses[:, :2], "poses have 2 columns; give"),
        (0, graph.poses[:5], "there is no pose in row"),
        (0, nan, 'node 3, field "pose": the value is NaN'),
        (1, graph.ends[:-1], "measurements has"),
        (1, graph.ends - 1, "ends, row 0: there is no pose in row -1"),
        (2, graph.measurements[:, :2], "measurements have 2 columns, but poses 3"),
        (3, indefinite, "arrays, line .*, field \"information\""),
        (3, unequal, "information, row 5: the matrix is not symmetric"),
        (3, np.ones((len(graph.ends), 2, 2)), "information matrices are 2 by 2"),
        (4, graph.landmark[1:], "landmark has"),
    ]:
        arrays = list(given)
        arrays[position] = array
        with pytest.raises(posecut.Error, match=sentence):
            posecut.Graph.from_arrays(*arrays)
    with pytest.raises(posecut.Error, match="frame has 2 values"):
        posecut.Graph.from_arrays(*given, node_fields={"frame": [1, 2]})
    with pytest.raises(posecut.Error, match="node 0, field \"id\""):
        posecut.Graph.from_arrays(graph.poses, *[array[:0] for array in given[1:]], ids=[0] * len(graph.poses))
    with pytest.raises(TypeError):
        posecut.Graph.from_arrays(np.zeros(3), *given[1:])


def test_poses_and_rejections_can_be_set(graph):
    moved = graph.with_poses(graph.poses + [1, 0, 0])
    assert np.allclose(moved.poses - graph.poses, [1, 0, 0])
    assert moved.with_poses(graph.poses).to_bytes() == graph.to_bytes()
    mask = np.zeros(len(graph.ends), dtype=bool)
    mask[-3:] = True
    marked = graph.with_rejected(mask, by="me").with_rejected(mask | graph.landmark, by="later")
    assert marked.edges["rejected_by"][-3:] == ["me"] * 3 and set(marked.edges["rejected_by"]) == {"me", "later", None}
    assert marked.with_rejected(mask & False).to_bytes() == graph.to_bytes()
    with pytest.raises(posecut.Error, match="poses have the shape"):
        graph.with_poses(graph.poses[1:])
    with pytest.raises(posecut.Error, match="flags for .* edges"):
        graph.with_rejected(mask[1:])
