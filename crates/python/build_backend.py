"""Builds the wheel: the programs of the workspace, then the module, by maturin."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import maturin

ROOT = Path(__file__).resolve().parent.parent.parent
DATA = ROOT / "target" / "wheel" / "posecut.data"
# What maintainers run.
EXCLUDED = {"xtask"}
# Build with the features of the whole workspace, so that the wheel shares its build with the tests and with make.
SHARED = "POSECUT_SHARED_BUILD" in os.environ
if SHARED:
    os.environ["MATURIN_PEP517_ARGS"] = "--features shared-build " + os.environ.get("MATURIN_PEP517_ARGS", "")

get_requires_for_build_wheel = maturin.get_requires_for_build_wheel
get_requires_for_build_editable = maturin.get_requires_for_build_editable
# Without a hook for the metadata alone: maturin wants the programs for it too, so pip takes it from the wheel.


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    stage_programs()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    stage_programs()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def build_sdist(sdist_directory, config_settings=None):
    raise RuntimeError("there is no source distribution, because the wheel needs the whole workspace; run pip install . in a clone")


def stage_programs():
    """Builds the programs and copies them to the folder that maturin puts into the wheel."""
    packages = [
        (package["name"], target["name"])
        for package in json.loads(cargo("metadata", "--no-deps", "--format-version", "1"))["packages"]
        for target in package["targets"]
        if "bin" in target["kind"] and package["name"] not in EXCLUDED
    ]
    environment = {"CARGO_PROFILE_RELEASE_STRIP": "true"} if shutil.which("strip") is None else {}
    # The module's package has no program, but its features are those with which maturin builds.
    names = [*(package for package, _ in packages), "posecut-python"]
    arguments = ["--workspace"] if SHARED else [word for name in names for word in ("--package", name)]
    output = cargo("build", "--release", "--bins", "--message-format", "json-render-diagnostics", *arguments, **environment)
    messages = [json.loads(line) for line in output.splitlines()]
    built = {message["target"]["name"]: message.get("executable") for message in messages if message["reason"] == "compiler-artifact"}
    scripts = DATA / "scripts"
    shutil.rmtree(DATA, ignore_errors=True)
    scripts.mkdir(parents=True)
    for _, program in packages:
        staged = shutil.copy2(built[program], scripts)
        if not environment:
            subprocess.run(["strip", staged], check=True)


def cargo(*arguments, **environment):
    """Runs cargo with the locked versions and returns its standard output."""
    command = [os.environ.get("CARGO", "cargo"), *arguments, "--locked"]
    return subprocess.run(command, cwd=ROOT, env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True, check=True).stdout
