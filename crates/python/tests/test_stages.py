"""Stages: the same bytes, statistics, doubts and sentences as the programs."""

import json
import logging
import warnings

import posecut
import pytest

STAGES = [
    ("verify", {}),
    ("verify", {"undecided": "keep", "without": ["shift", "local"]}),
    ("pcm", {}),
    ("pcm", {"chance": 3}),
    ("multicut", {"delta": "auto"}),
    ("optimize", {"max_iterations": 3, "kernel_landmark": "huber"}),
    ("oracle", {}),
    ("label", {"all_correct": True}),
    ("ransac", {"seed": 4}),
    ("islands", {}),
    ("densest", {}),
    ("voting", {}),
]


def arguments(options):
    """The options as a user of the program would write them."""
    for name, value in options.items():
        for item in value if isinstance(value, list) else [value]:
            yield f"--{name.replace('_', '-')}" + ("" if item is True else f"={item}")


@pytest.mark.parametrize(("stage", "options"), STAGES)
@pytest.mark.filterwarnings("ignore::posecut.Doubt")
def test_each_stage_writes_what_its_program_writes(stage, options, path, graph, program, tmp_path):
    stats = tmp_path / "stats.json"
    theirs = program(stage, *arguments(options), "--stats", stats, path)
    assert theirs.returncode == 0, theirs.stderr
    ours = graph.run(stage, **options)
    assert ours.to_bytes() == theirs.stdout
    expected = json.loads(stats.read_text())
    assert ours.doubts == expected.pop("doubts")
    for name in ("stage", "version", "seconds"):
        del expected[name]
    varying = {name for name in expected if "seconds" in name}
    strip = lambda figures: {name: value for name, value in figures.items() if name not in varying}  # noqa: E731
    assert strip(ours.statistics) == strip(expected)
    # Written by standard error as "posecut-STAGE: …" or "posecut-STAGE: warning: …".
    told = [line.split(": ", 1)[1] for line in theirs.stderr.decode().splitlines()]
    assert [line.removeprefix("warning: ") for line in told] == ours.messages


@pytest.mark.filterwarnings("ignore::posecut.Doubt")
def test_a_chain_of_stages_is_a_pipe(path, graph, program):
    content = path.read_bytes()
    for stage in ("pcm", "multicut", "optimize --marginals=landmark", "readmit"):
        content = program(*stage.split(), "-q", input=content).stdout
    assert len(content) > 10_000
    assert graph.pcm().multicut().optimize(marginals="landmark").readmit().to_bytes() == content
    assert [entry["stage"] for entry in graph.pcm().multicut().provenance][-2:] == ["pcm", "multicut"]


def test_a_stage_leaves_its_graph_alone(path, graph):
    before = graph.rejected.copy()
    judged = graph.verify()
    assert judged.rejected.sum() > before.sum() == graph.rejected.sum()
    assert graph.to_bytes() == path.read_bytes()
    assert judged.without_rejected().edges["id"].tolist() == judged.edges["id"][~judged.rejected].tolist()


@pytest.mark.parametrize(
    ("stage", "options"),
    [
        ("verify", {"undecided": "perhaps"}),
        ("verify", {"hypotesis": 1}),
        ("verify", {"hypothesis": 99}),
        ("verify", {"explain": 10**9}),
        ("pcm", {"chance": -1}),
        ("pcm", {"chance": "many"}),
        ("optimize", {"cost_tolerance": -1.0}),
        ("optimize", {"certify": True, "kernel_landmark": "huber"}),
        ("readmit", {}),
        ("label", {"labels": "missing.csv"}),
    ],
)
def test_errors_are_the_sentences_of_the_programs(stage, options, path, graph, program):
    theirs = program(stage, "-q", *arguments(options), path)
    assert theirs.returncode == 2
    with pytest.raises(posecut.Error) as ours:
        graph.run(stage, **options)
    assert f"posecut-{stage}: error: {ours.value}\n" == theirs.stderr.decode()


def test_what_only_programs_do_is_refused(graph):
    with pytest.raises(posecut.Error, match="run posecut-multicut --certificate FILE"):
        graph.multicut(certificate="file")
    with pytest.raises(posecut.Error, match='there is no stage "solve"; use one of verify, pcm'):
        graph.run("solve")
    with pytest.raises(TypeError):
        posecut.Graph()


def test_doubts_are_warnings_at_the_line_that_calls(graph):
    alone = graph.with_rejected(~graph.landmark & (graph.edges["id"] == graph.edges["id"].max()) | graph.landmark)
    with pytest.warns(posecut.Doubt, match="nothing|no |component") as caught:
        doubtful = alone.optimize()
    assert doubtful.doubts and caught[0].filename == __file__
    assert str(caught[0].message) in doubtful.messages
    with warnings.catch_warnings():
        warnings.simplefilter("error", posecut.Doubt)
        with pytest.raises(posecut.Doubt):
            alone.optimize()


def test_messages_go_to_the_log(graph, caplog):
    edge = int(graph.edges["id"][graph.landmark][0])
    with caplog.at_level(logging.INFO, "posecut"):
        judged = graph.verify(explain=edge)
    assert [record.getMessage() for record in caplog.records] == judged.messages
    assert any(f"landmark {edge}" in message or f"edge {edge}" in message for message in judged.messages)


def test_evaluation_is_that_of_the_program(path, graph, program, tmp_path):
    judged = graph.verify().optimize()
    judged.write(tmp_path / "judged.jsonl")
    theirs = program("evaluate", "-q", "--align=se2", tmp_path / "judged.jsonl")
    assert json.loads(theirs.stdout) == judged.evaluate(align="se2")
    reference = graph.run("oracle").optimize()
    assert judged.evaluate(reference)["rmse"] < 0.5


def test_options_are_listed():
    assert "--undecided <UNDECIDED>" in posecut.options("verify")
    with pytest.raises(posecut.Error, match="there is no stage"):
        posecut.options("nothing")
