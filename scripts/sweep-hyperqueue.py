#!/usr/bin/env python3
"""Runs a task list with HyperQueue, on this machine or on as many as a running server has workers.

    posecut-experiment plan pipelines/regimes.toml -o plan.jsonl
    scripts/sweep-hyperqueue.py plan.jsonl --workers 2                # workers of its own, on this machine
    scripts/sweep-hyperqueue.py plan.jsonl --server-dir ~/.hq-server  # a running server and its workers

What several runs share is made first, then the other runs in shares, each one HyperQueue task. A share that fails does
not stop the others. Whatever has been finished, here or by `posecut-experiment run`, does not run again, so a sweep that
was broken off is resumed by the same command. All machines need the same folder at the same place, and this working
directory.

Needs the hyperqueue package from PyPI, of the server's version.
"""

import argparse
import json
import sys
from pathlib import Path

import hyperqueue
from hyperqueue.cluster import LocalCluster, WorkerConfig


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan", type=Path, help="task list (JSON Lines)")
    parser.add_argument("--program", type=Path, default=Path("target/release/posecut-experiment"))
    parser.add_argument("--shares", type=int, default=0, help="shares of the runs; 0: about 20 runs each, at least 4")
    parser.add_argument("--logs", type=Path, default=Path("results/hyperqueue"), help="where messages of the shares go")
    parser.add_argument("--results", default="results", help="where results go, as it was planned")
    parser.add_argument("--simulated", default="data/simulated", help="where simulated sessions go, as it was planned")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, default=2, help="workers to start on this machine, one core each")
    where.add_argument("--server-dir", type=Path, help="directory of a running server")
    arguments = parser.parse_args()

    groups = {json.loads(line)["group"] for line in arguments.plan.open()}
    shares = arguments.shares or max(4, len(groups) // 20)
    arguments.logs.mkdir(parents=True, exist_ok=True)

    def call(job, name, options, dependencies=()):
        command = [str(arguments.program.resolve()), "run", str(arguments.plan), "--threads", "1",
                   "--results", arguments.results, "--simulated", arguments.simulated, *options]
        output = arguments.logs / f"{name}.log"
        return job.program(command, cwd=Path.cwd(), stdout=None, stderr=output.resolve(), deps=dependencies, name=name,
                           env={"RAYON_NUM_THREADS": "1"})

    job = hyperqueue.Job(max_fails=None, name=arguments.plan.stem)
    shared = call(job, "shared", ["--shared"])
    for share in range(1, shares + 1):
        call(job, f"share-{share}", ["--shard", f"{share}/{shares}"], [shared])

    if arguments.server_dir:
        return wait(hyperqueue.Client(arguments.server_dir), job, arguments.logs)
    with LocalCluster() as cluster:
        for _ in range(arguments.workers):
            cluster.start_worker(WorkerConfig(cores=1))
        return wait(cluster.client(), job, arguments.logs)


def wait(client, job, logs):
    submitted = client.submit(job)
    if client.wait_for_jobs([submitted], raise_on_error=False):
        return 0
    for number, context in sorted(client.get_failed_tasks(submitted).items()):
        name = job.task_by_id(number).label
        print(f"{name} failed: {context.error}; what it said: {logs}/{name}.log", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
