#!/usr/bin/env python3
"""Checks the dependency tree against deny.toml: licences, sources, and crates that may be there only once.

Reads `cargo metadata --all-features --format-version 1` from standard input. What cargo-deny would check, less its
advisories, without the ten minutes it takes to compile cargo-deny. With a file that `cargo tree --prefix none --format '{p}'` wrote, checks
instead that no package in it asks for a newer Rust than ours: the README's commands run without a flag.
"""

import json
import pathlib
import re
import sys
import tomllib

RULES = tomllib.loads(pathlib.Path(__file__).parent.parent.joinpath("deny.toml").read_text())
CRATES_IO = "registry+https://github.com/rust-lang/crates.io-index"


def licence_allowed(expression, allowed):
    """Evaluates an SPDX expression, `AND` binding tighter than `OR`; the old `MIT/Apache-2.0` means `OR`."""
    tokens = re.findall(r"\(|\)|[^\s()]+", expression.replace("/", " OR "))
    tokens.append(None)
    at = 0

    def take():
        nonlocal at
        at += 1
        return tokens[at - 1]

    def either():
        value = both()
        while tokens[at] == "OR":
            take()
            value = both() or value
        return value

    def both():
        value = one()
        while tokens[at] == "AND":
            take()
            value = one() and value
        return value

    def one():
        token = take()
        if token == "(":
            value = either()
            take()
            return value
        if tokens[at] == "WITH":
            take()
            token = f"{token} WITH {take()}"
        return token in allowed

    return either()


def version(text):
    """`1.95` and `1.95.0` as equal tuples."""
    return (*(int(number) for number in text.split(".")), 0, 0)[:3]


def too_new(metadata, tree):
    """A fault for each package in the tree that asks for a newer Rust than the members of the workspace."""
    # Metadata themselves count what weak features name as built.
    built = {tuple(line.split()[:2]) for line in tree.splitlines() if line}
    members = set(metadata["workspace_members"])
    packages = [
        package
        for package in metadata["packages"]
        if package["rust_version"] and (package["name"], f"v{package['version']}") in built
    ]
    ours = min(version(package["rust_version"]) for package in packages if package["id"] in members)
    print(f"{len(packages)} packages name a Rust version, ours is {'.'.join(map(str, ours))}")
    return [
        f"{package['name']} {package['version']} asks for Rust {package['rust_version']}"
        for package in packages
        if version(package["rust_version"]) > ours
    ]


def main():
    metadata = json.load(sys.stdin)
    if sys.argv[1:]:
        return finish(too_new(metadata, pathlib.Path(sys.argv[1]).read_text()))
    packages = metadata["packages"]
    allowed = set(RULES["licenses"]["allow"])
    faults = []
    versions = {}
    for package in packages:
        name = f"{package['name']} {package['version']}"
        versions.setdefault(package["name"], set()).add(package["version"])
        if package["license"] is None:
            faults.append(f"{name}: names no licence")
        elif not licence_allowed(package["license"], allowed):
            faults.append(f"{name}: licence {package['license']} is not in deny.toml")
        # A path dependency has no source.
        if package["source"] not in (CRATES_IO, None):
            faults.append(f"{name}: comes from {package['source']}")
    for ban in RULES["bans"]["deny"]:
        found = versions.get(ban["crate"], set())
        if len(found) > 1:
            faults.append(f"{ban['crate']}: {len(found)} versions in the tree: {', '.join(sorted(found))}")
        print(f"{ban['crate']}: {', '.join(sorted(found)) or 'not in the tree'}")
    print(f"{len(packages)} packages, {len(faults)} faults")
    return finish(faults)


def finish(faults):
    """Prints the faults; 1 if there are any, as exit status."""
    for fault in faults:
        print(f"error: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
