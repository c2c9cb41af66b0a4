"""Long calls: Ctrl-C, threads, processes."""

import multiprocessing
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import posecut
import pytest
from conftest import drive

LONG = """
import signal, sys
# A shell that starts the tests in the background ignores the signal, and Python inherits that.
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.path.insert(0, sys.argv[1])
from conftest import drive
graph = drive(40_000, 120_000)
print("begins", flush=True)
try:
    graph.verify()
except KeyboardInterrupt:
    print("interrupted", flush=True)
else:
    print("done", flush=True)
"""


def test_ctrl_c_interrupts_a_long_verification():
    command = [sys.executable, "-c", LONG, str(Path(__file__).parent)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "begins\n"
        time.sleep(0.3)
        began = time.monotonic()
        child.send_signal(signal.SIGINT)
        assert child.stdout.readline() == "interrupted\n"
        seconds = time.monotonic() - began
        assert child.wait(timeout=60) == 0
    assert seconds < 1, f"{seconds:.2f} s"


def test_other_threads_run_while_a_stage_does():
    graph = drive(10_000, 30_000)
    done, ticks = threading.Event(), 0

    def work():
        graph.verify()
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(0.01)
    thread.join()
    assert ticks > 3


def test_threads_get_the_same_result_as_one(graph):
    expected = graph.verify().optimize().to_bytes()
    results = []
    threads = [threading.Thread(target=lambda: results.append(graph.verify().optimize().to_bytes())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [expected] * 4


def in_use(graph):
    """Reads in a process, which always works, then runs a stage."""
    return int((~graph.verify().rejected).sum())


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="the system has no fork")
@pytest.mark.filterwarnings("ignore:This process .* is multi-threaded:DeprecationWarning")
def test_processes_work_if_they_are_spawned_and_say_so_if_not(graph):
    expected = in_use(graph)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply_async(in_use, [graph]).get(60) == expected
    with multiprocessing.get_context("fork").Pool(1) as pool, pytest.raises(posecut.Error, match="spawn or forkserver"):
        pool.apply_async(in_use, [graph]).get(60)
