#!/usr/bin/env python3
"""Checks the reports of all scenes (JSON, on standard input) against the table of state hashes.

    cargo run --release --features scenes --example scene -- assets/scenes --headless --report json | .ci/check_scenes.py

With `--write` the table becomes what the reports say: after a change that is meant to change what scenes do.
"""

import json
import pathlib
import sys

TABLE = pathlib.Path(__file__).resolve().parent.parent / "tests/golden/scenes.hashes"


def main():
    reports = json.load(sys.stdin)
    found = {report["scene"]: report["state_hash"] for report in reports}
    if "--write" in sys.argv[1:]:
        TABLE.write_text("".join(f"{name} {state}\n" for name, state in sorted(found.items())))
        return 0
    expected = dict(line.split() for line in TABLE.read_text().splitlines())
    faults = [f"{name}: no scene" for name in sorted(expected.keys() - found.keys())]
    for name, state in sorted(found.items()):
        if state != expected.get(name):
            faults.append(f"{name}: {state}, not {expected.get(name, 'in the table')}")
    for fault in faults:
        print(f"error: {fault}", file=sys.stderr)
    print(f"{len(found)} scenes, {len(found) - len(faults)} with the state of the table")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
