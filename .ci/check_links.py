#!/usr/bin/env python3
"""Checks the links of all Markdown files: `check_links.py target/doc`, after `cargo doc`.

A file that is linked exists. A page of docs.rs about a crate of ours is one that `cargo doc` has written, with the item
linked on it. READMEs of crates are read on crates.io, too, where neither a file of the repository nor a Rust path leads anywhere.
"""

import re
import subprocess
import sys
from pathlib import Path

from checks import check, status

ROOT = Path(__file__).resolve().parent.parent
DOCS = Path(sys.argv[1])
# READMEs in folders of these are those of crates.
CRATES = [ROOT / "crates", ROOT / "bridges"]
OURS = re.compile(r"https://docs\.rs/(?:bevy_drape|bevy_drape_script|drape_gpu|drape_solver)/latest/([^#]*)(?:#(.*))?")
FENCE = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)
TARGET = re.compile(r"\]\(([^()\s]+)\)|^\[[^\]]+\]: (\S+)|(?:href|src)=\"([^\"]+)\"", re.MULTILINE)
# A label in code, unless it is the text of a link or its definition.
LABEL = re.compile(r"\[(`[^`\]]+`)\](?!\(|\[|: http)")


def fault(file, target):
    """What is wrong with a link; None if nothing is."""
    if page := OURS.fullmatch(target):
        path, item = DOCS / page[1], page[2]
        path = path / "index.html" if path.suffix != ".html" else path
        if not path.is_file():
            return "cargo doc wrote no such page"
        return None if item is None or f'id="{item}"' in path.read_text() else "the page has no such item"
    if re.match(r"https?://|mailto:|#", target):
        return None
    if file.parent.parent in CRATES:
        return "leads nowhere on crates.io"
    return None if (file.parent / target.split("#")[0]).exists() else "no such file"


def main():
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, check=True, capture_output=True, text=True)
    count = 0
    for file in (ROOT / name for name in listed.stdout.splitlines()):
        text = FENCE.sub("", file.read_text(encoding="utf-8"))
        targets = ["".join(found) for found in TARGET.findall(text)]
        count += len(targets)
        faults = [f"{target}: {wrong}" for target in targets if (wrong := fault(file, target))]
        if file.parent.parent in CRATES:
            faults += [f"{label}: no target" for label in LABEL.findall(text) if f"\n[{label}]: " not in text]
        for wrong in faults:
            check(False, f"{file.relative_to(ROOT)}: {wrong}")
    check(count > 100, f"{count} links looked at")
    return status()


if __name__ == "__main__":
    sys.exit(main())
