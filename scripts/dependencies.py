#!/usr/bin/env python3
"""Writes docs/dependencies.md: every crate that the programs are built from, with its version and licence.

With --check, writes nothing and fails if the page is out of date. Either way it fails if a licence is not among those
that may be linked into a program under MIT or Apache 2.0, or if a crate does not come from the registry.
"""

import json
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "dependencies.md"

# The list that cargo-deny goes by too. No TOML reader: before 3.11 Python has none.
ALLOWED = set(re.findall('"([^"]*)"', re.search(r"^allow = \[(.*?)\]", (ROOT / "deny.toml").read_text(), re.M | re.S)[1]))


def allowed(expression):
    """Whether an SPDX expression can be met: any of an OR, all of an AND."""
    tokens = re.findall(r"\(|\)|[^\s()/]+|/", expression)

    def alternatives(position):
        value, position = conjunction(position)
        while position < len(tokens) and tokens[position] in ("OR", "/"):
            other, position = conjunction(position + 1)
            value = value or other
        return value, position

    def conjunction(position):
        value, position = licence(position)
        while position < len(tokens) and tokens[position] == "AND":
            other, position = licence(position + 1)
            value = value and other
        return value, position

    def licence(position):
        if tokens[position] == "(":
            value, position = alternatives(position + 1)
            return value, position + 1
        name = tokens[position]
        position += 1
        if position < len(tokens) and tokens[position] == "WITH":
            name = f"{name} WITH {tokens[position + 1]}"
            position += 2
        return name in ALLOWED, position

    return alternatives(0)[0]


def metadata():
    command = ["cargo", "metadata", "--format-version", "1", "--locked"]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)


def linked(data):
    """The packages that programs are built from: reached without development dependencies."""
    nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
    ours = set(data["workspace_members"])
    # Crates that are not published hold tests.
    published = [package["id"] for package in data["packages"] if package["id"] in ours and package["publish"] != []]
    open_ids, seen = published, set()
    while open_ids:
        identity = open_ids.pop()
        if identity in seen:
            continue
        seen.add(identity)
        for dependency in nodes[identity]["deps"]:
            if any(kind["kind"] != "dev" for kind in dependency["dep_kinds"]):
                open_ids.append(dependency["pkg"])
    return seen


def main():
    data = metadata()
    ours = set(data["workspace_members"])
    programs = linked(data)
    problems, rows = [], []
    for package in sorted(data["packages"], key=lambda package: (package["name"], package["version"])):
        if package["id"] in ours:
            continue
        name, version, expression = package["name"], package["version"], package["license"] or ""
        if not expression or not allowed(expression):
            problems.append(f"{name} {version}: its licence \"{expression}\" is not among those allowed")
        if not (package["source"] or "").startswith("registry+"):
            problems.append(f"{name} {version}: comes from {package['source']}, not from the registry")
        use = "programs" if package["id"] in programs else "tests"
        rows.append(f"| {name} | {version} | {expression} | {use} |")
    text = (
        "# Dependencies and their licences\n\n"
        "Made by `scripts/dependencies.py` from Cargo.lock, for all platforms. The script fails if a licence is not allowed.\n"
        "*programs*: the programs contain this crate. *tests*: only tests and benches do. `deny.toml` lists the allowed\n"
        "licences, so that `cargo deny check` (cargo-deny 0.20) agrees. `scripts/check-advisories.sh` checks Cargo.lock against\n"
        "security advisories if cargo-deny or cargo-audit is installed, and reports if it cannot.\n\n"
        f"{len(rows)} crates.\n\n| crate | version | licence | used by |\n|---|---|---|---|\n" + "\n".join(rows) + "\n"
    )
    if "--check" not in sys.argv[1:]:
        PAGE.write_text(text, encoding="utf-8")
    elif not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
        problems.append("docs/dependencies.md is out of date; run scripts/dependencies.py and commit the result")
    for problem in problems:
        print(f"dependencies: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
