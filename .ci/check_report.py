#!/usr/bin/env python3
"""Checks the reports of the cannon demo: `check_report.py REPORT.json [OTHER.json ...]`.

The first report is checked against what the demo promises. The others are runs of the same scene with another number
of threads or another build profile: they must end in the same state, bit for bit.
"""

import json
import math
import pathlib
import sys

from checks import check, faults, status

SHOTS = 5
SCENE = {"particles": 64 * 48, "dt": 1.0 / 60.0}
# Fractions of the rest length, at rest.
RMS_STRETCH_BELOW = 0.01
MAX_STRETCH_BELOW = 0.05
# Seconds from the last hit.
REST_TIME_BELOW = 30.0
# Metres, in the ground or in a ball, at the end of any step.
PENETRATION_BELOW = 0.005
# Metres, at one shot or more.
DEFLECTION_ABOVE = 0.2
# The curtain still moves a little when the next ball arrives: a fraction of the predicted time.
HIT_TIME_WITHIN = 0.03

SHOT_FIELDS = (
    "index time_s elevation_deg azimuth_deg speed_m_s hit hit_time_s predicted_hit_time_s curtain_max_deflection_m"
    " ball_speed_before_m_s ball_speed_after_m_s ball_final_state collision_ms"
).split()
FIELDS = {
    "scene": "particles sticks substeps iterations dt".split(),
    "curtain": "max_stretch rms_stretch peak_stretch rest_time_s max_penetration_m".split(),
    "timing": "steps wall_ms_median wall_ms_p99 realtime_factor threads".split(),
}


def below(value, limit):
    """True for a number from 0 up to, but not including, the limit; false for null."""
    return isinstance(value, (int, float)) and 0.0 <= value < limit


def read(path):
    """Reads a report. NaN and infinity are no JSON, though Python would take them."""

    def refuse(word):
        raise ValueError(f"{path}: {word} in the report")

    return json.loads(pathlib.Path(path).read_text(), parse_constant=refuse)


def check_fields(report):
    check("version" in report, "has a version")
    check(bool(report.get("state_hash")), f"has a state_hash: {report.get('state_hash')}")
    for group, names in FIELDS.items():
        missing = [name for name in names if name not in report.get(group, {})]
        check(not missing, f"{group} is complete" + (f", but for {', '.join(missing)}" if missing else ""))
    for shot in report.get("shots", []):
        missing = [name for name in SHOT_FIELDS if name not in shot]
        if missing:
            check(False, f"shot {shot.get('index')} is complete, but for {', '.join(missing)}")
    samples = report.get("activity", [])
    counted = all({"time_s", "active", "resting", "culled"} <= set(sample) for sample in samples)
    check(bool(samples) and counted, f"activity counts bodies at {len(samples)} times")


def check_scene(scene):
    check(scene["particles"] == SCENE["particles"], f"scene: {scene['particles']} particles")
    check(math.isclose(scene["dt"], SCENE["dt"], rel_tol=1e-6), f"scene: a step of {scene['dt']} s")


def check_shots(shots):
    check(len(shots) == SHOTS, f"{len(shots)} of {SHOTS} shots fired")
    hits = sum(shot["hit"] is True for shot in shots)
    check(hits == SHOTS, f"{hits} of {SHOTS} shots hit")
    for shot in shots:
        name = f"shot {shot['index']}"
        hit, predicted = shot["hit_time_s"], shot["predicted_hit_time_s"]
        near = hit is not None and predicted and abs(hit - predicted) <= HIT_TIME_WITHIN * predicted
        check(bool(near), f"{name}: hits after {hit} s, predicted {predicted} s")
        before, after = shot["ball_speed_before_m_s"], shot["ball_speed_after_m_s"]
        check(below(after, before or 0.0), f"{name}: the curtain slows the ball from {before} to {after} m/s")
        check(shot["ball_final_state"] in ("resting", "culled"), f"{name}: the ball ends {shot['ball_final_state']}")
    deflection = max((shot["curtain_max_deflection_m"] or 0.0 for shot in shots), default=0.0)
    check(deflection > DEFLECTION_ABOVE, f"the curtain deflects by {deflection} m")


def check_curtain(curtain):
    check(below(curtain["rms_stretch"], RMS_STRETCH_BELOW), f"rms_stretch {curtain['rms_stretch']}")
    check(below(curtain["max_stretch"], MAX_STRETCH_BELOW), f"max_stretch {curtain['max_stretch']}")
    check(below(curtain["rest_time_s"], REST_TIME_BELOW), f"rest_time_s {curtain['rest_time_s']}")
    check(below(curtain["max_penetration_m"], PENETRATION_BELOW), f"max_penetration_m {curtain['max_penetration_m']}")


def check_plot(directory):
    plots = [path for path in (directory / "plot.svg", directory / "plot.png") if path.is_file()]
    check(any(path.stat().st_size > 1000 for path in plots), "a plot lies beside the report")


def main(paths):
    if not paths:
        sys.exit(__doc__)
    first, *others = paths
    print(f"{first}:")
    report = read(first)
    check_fields(report)
    # The rest reads the fields.
    if not faults:
        check_scene(report["scene"])
        check_shots(report["shots"])
        check_curtain(report["curtain"])
        check_plot(pathlib.Path(first).parent)
        timing = report["timing"]
        print(f"  {timing['realtime_factor']} times real time, {timing['wall_ms_median']} ms a step (median)")
    for path in others:
        other = read(path).get("state_hash")
        check(other == report.get("state_hash"), f"{path}: ends in the same state ({other})")
    return status()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
