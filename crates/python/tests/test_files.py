"""Reading and writing: the same bytes and the same sentences as the programs."""

import gzip
import pickle

import posecut
import pytest
from conftest import drive, records


def test_json_lines_come_back_byte_by_byte(path, graph, tmp_path):
    assert graph.to_bytes() == path.read_bytes()
    graph.write(tmp_path / "copy.jsonl")
    assert (tmp_path / "copy.jsonl").read_bytes() == path.read_bytes()
    graph.write(str(tmp_path / "copy.jsonl.gz"))
    assert gzip.decompress((tmp_path / "copy.jsonl.gz").read_bytes()) == path.read_bytes()
    assert posecut.read(tmp_path / "copy.jsonl.gz").to_bytes() == path.read_bytes()
    assert posecut.Graph.from_bytes(path.read_bytes()).to_bytes() == path.read_bytes()
    assert pickle.loads(pickle.dumps(graph)).to_bytes() == path.read_bytes()


@pytest.mark.parametrize("form", ["g2o", "toro", "tum", "kitti", "jrl"])
def test_other_formats_are_those_of_the_program(form, path, graph, program, tmp_path):
    theirs, ours = tmp_path / f"theirs.{form}", tmp_path / f"ours.{form}"
    assert program("convert", "-q", path, "-o", theirs).returncode == 0
    graph.write(ours)
    assert ours.read_bytes() == theirs.read_bytes()
    assert graph.to_bytes(to=form) == theirs.read_bytes()
    read = program("convert", "-q", theirs, "--to", "jsonl")
    assert posecut.read(theirs).to_bytes() == read.stdout


def test_options_of_reading_are_those_of_the_program(path, program, tmp_path):
    file = tmp_path / "poses.tum"
    assert program("convert", "-q", path, "-o", file).returncode == 0
    flags = ["--session=a", "--odometry-from-poses", "--sigma-translation=0.5", "--sigma-rotation=0.1"]
    theirs = program("convert", "-q", "--from=tum", *flags, file)
    assert theirs.returncode == 0, theirs.stderr
    ours = posecut.read(file, from_="tum", session="a", odometry_from_poses=True, sigma_translation=0.5, sigma_rotation=0.1)
    assert ours.to_bytes() == theirs.stdout
    assert not ours.landmark.any() and set(ours.nodes["session"]) == {"a"}


def test_several_files_become_one_graph(tmp_path):
    text = "VERTEX_SE2 {0} 0 0 0\nVERTEX_SE2 {1} 1 0 0\nEDGE_SE2 {0} {1} 1 0 0 1 0 0 1 0 1\n"
    files = [tmp_path / "a.g2o", tmp_path / "b.g2o"]
    for file in files:
        file.write_text(text.format(0, 1))
    joined = posecut.read(files, renumber=True)
    assert len(joined.poses) == 4 and joined.nodes["session"] == ["a", "a", "b", "b"]


HOSTILE = [
    b"",
    b"\x00\xff" * 100,
    b"{}",
    b'{"kind":"header","format":"posecut","version":2,"dimension":2}\n',
    b'{"kind":"header","format":"posecut","version":1,"dimension":2}\n{"kind":"node","id":0,"pose":[1,2]}\n',
    b'{"kind":"header","format":"posecut","version":1,"dimension":2}\n{"kind":"landmark","id":0,"from":0,"to":1}\n',
    b"\x1f\x8b\x08\x00 broken",
    b"VERTEX_SE2 0 0 0\n",
    b"EDGE_SE2 0 0 nan 0 0 1 0 0 1 0 1\n",
]


@pytest.mark.parametrize("content", HOSTILE)
@pytest.mark.parametrize("suffix", ["jsonl", "g2o"])
def test_hostile_files_are_refused_in_the_words_of_the_program(content, suffix, program, tmp_path):
    file = tmp_path / f"hostile.{suffix}"
    file.write_bytes(content)
    theirs = program("convert", "-q", file)
    assert theirs.returncode == 2
    with pytest.raises(posecut.Error) as ours:
        posecut.read(file)
    assert f"posecut-convert: error: {ours.value}\n" == theirs.stderr.decode()


def test_missing_files_and_folders_are_errors(graph, tmp_path, program):
    missing = tmp_path / "none" / "graph.jsonl"
    with pytest.raises(posecut.Error, match="cannot be opened") as ours:
        posecut.read(missing)
    assert program("convert", missing).stderr.decode() == f"posecut-convert: error: {ours.value}\n"
    with pytest.raises(posecut.Error, match="is a directory"):
        posecut.read(tmp_path)
    with pytest.raises(posecut.Error, match="the folder .* does not exist"):
        graph.write(missing)
    with pytest.raises(posecut.Error, match="the name does not determine the format"):
        graph.write(tmp_path / "graph.txt")
    with pytest.raises(posecut.Error, match="no input is named"):
        posecut.read([])
    assert list(tmp_path.iterdir()) == []


def test_a_graph_of_arrays_is_read_by_the_programs(program):
    content = drive(300, 30).to_bytes()
    checked = program("inspect", "validate", input=content)
    assert checked.returncode == 0, checked.stderr
    assert sum(record["kind"] == "landmark" for record in records(content)) == 30
