#!/usr/bin/env python3
"""Checks what the cannon demo writes with `--table1` and `--soak`: `check_table1.py TABLE1.json [SOAK.json]`."""

import json
import pathlib
import sys

from checks import check, status

METHOD_FIELDS = "name ms_per_shot ratio_to_ours queries missed false_contacts".split()
# GJK's distances are rough: contacts that it may get wrong, as a fraction.
FAULTS_BELOW = 0.01


def check_curtain(name, curtain):
    methods = curtain["methods"]
    check(len(methods) == 5, f"{name}: {len(methods)} methods")
    for method in methods:
        missing = [field for field in METHOD_FIELDS if field not in method]
        if missing:
            check(False, f"{name}: a method lacks {', '.join(missing)}")
            return
    ours = methods[0]
    check(ours["name"] == "ours", f"{name}: the first is {ours['name']}")
    check(curtain["contacts"] > 0, f"{name}: {curtain['contacts']} contacts")
    check(ours["missed"] == 0, f"{name}: ours misses {ours['missed']}")
    for method in methods:
        wrong = method["missed"] + method["false_contacts"]
        few = wrong <= FAULTS_BELOW * curtain["contacts"]
        check(few, f"{name}: {method['name']} gets {wrong} wrong, takes {method['ratio_to_ours']:.2f} of our time")
        check(all(ms > 0.0 for ms in method["ms_per_shot"]), f"{name}: {method['name']} takes time for every shot")


def main(table1, *soaks):
    print(f"{table1}:")
    report = json.loads(pathlib.Path(table1).read_text())
    check_curtain("curtain", report)
    check_curtain("fine", report["fine"])
    for soak in soaks:
        print(f"{soak}:")
        report = json.loads(pathlib.Path(soak).read_text())
        check(report["any_nan"] is False, "all is finite")
        check(report["steps"] > 0 and report["shots"] > 0, f"{report['steps']} steps, {report['shots']} shots")
        entities = [minute["entities"] for minute in report["minutes"]]
        check(max(entities) <= entities[0] + 1, f"entities at the end of each minute: {entities}")
    return status()


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
