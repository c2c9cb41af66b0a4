"""What the tests share: the test graph, and the programs that the wheel installed."""

import json
import os
import subprocess
import sysconfig
from pathlib import Path

import numpy as np
import posecut
import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="session")
def path():
    """The test graph: two sessions in the plane, with labels."""
    return ROOT / "testdata" / "graph.jsonl"


@pytest.fixture(scope="session")
def graph(path):
    return posecut.read(path)


@pytest.fixture(scope="session")
def program():
    """Runs an installed program on bytes: program("verify", "--undecided=keep", input=...)."""

    def run(name, *arguments, **options):
        command = [Path(sysconfig.get_path("scripts"), f"posecut-{name}"), *arguments]
        return subprocess.run(command, capture_output=True, check=False, **options)

    return run


@pytest.fixture(scope="session")
def shared():
    """A file of the data outside the repository; without it the test is skipped."""

    def find(name):
        found = Path(os.environ.get("POSECUT_SHARED_DATA", ROOT.parent / "shared" / "data"), name)
        if not found.exists():
            print(f"skipped: no data: {name}")
            pytest.skip(f"no data: {name}")
        return found

    return find


def drive(nodes, landmarks, dimension=2, seed=0):
    """Rounds on a circle, with landmark edges between rounds. The last third of them is wrong."""
    random = np.random.default_rng(seed)
    angle = np.arange(nodes) * (2 * np.pi / 200)
    poses = np.stack([30 * np.cos(angle), 30 * np.sin(angle), angle + np.pi / 2], axis=1)
    first = random.integers(0, nodes - 203, landmarks)
    steps = np.stack([np.arange(nodes - 1), np.arange(1, nodes)], axis=1)
    ends = np.concatenate([steps, np.stack([first, first + 200 + random.integers(-3, 4, landmarks)], axis=1)])
    start, end = poses[ends[:, 0]], poses[ends[:, 1]]
    apart, cosine, sine = end - start, np.cos(start[:, 2]), np.sin(start[:, 2])
    x, y = cosine * apart[:, 0] + sine * apart[:, 1], cosine * apart[:, 1] - sine * apart[:, 0]
    measured = np.stack([x, y, apart[:, 2]], axis=1) + random.normal(0, 0.02, (len(ends), 3))
    measured[len(ends) - landmarks // 3 :, :2] += random.normal(0, 5, (landmarks // 3, 2))
    measured[:, 2] = (measured[:, 2] + np.pi) % (2 * np.pi) - np.pi
    if dimension == 2:
        return posecut.Graph.from_arrays(poses, ends, measured, np.eye(3) * 2500)
    tilt, height = random.normal(0, 0.02, (2, len(ends)))
    information = np.diag([2500.0, 2400, 2300, 2200, 2100, 2000])
    return posecut.Graph.from_arrays(_lifted(poses, 0, 0), ends, _lifted(measured, tilt, height), information)


def _lifted(poses, tilt, height):
    """Poses in space: turned about z, then about x."""
    x, y, angle = poses.T
    sine, cosine = np.sin(angle / 2), np.cos(angle / 2)
    tilt_sine, tilt_cosine = np.sin(tilt / 2), np.cos(tilt / 2)
    turn = [tilt_sine * cosine, tilt_sine * sine, tilt_cosine * sine, tilt_cosine * cosine]
    return np.stack([x, y, height + 0 * x, *turn], axis=1)


def records(content):
    """The records of JSON Lines."""
    return [json.loads(line) for line in content.splitlines()]
