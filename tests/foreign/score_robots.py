#!/usr/bin/env python3
"""Scores `aibo-fit gap` on what `robots.py` made (see README.md beside this file).

    python3 score_robots.py DIR BINARY [--threads N] [--only N,N...]
"""
import argparse
import json
from pathlib import Path

from score import ask, named

FRICTION = ("coulomb", "viscous")


def judge(truth, answer):
    """(right, why) of a study."""
    verdict = answer["verdict"]
    if not truth["causes"]:
        return verdict in ("none", "calibration"), "nothing missing"
    ids = named(answer) + ([answer["effect"]] if verdict == "calibration" and answer.get("effect") else [])
    tied = set(answer.get("equivalent") or [])
    wants = "calibration" if set(truth["causes"]) <= set(FRICTION) else "effect"
    # Friction that is off beside an effect is a number of the repaired robot, and no cause of its own.
    causes = [cause for cause in truth["causes"] if wants == "calibration" or cause not in FRICTION]
    hits = sum(cause in ids or cause in tied for cause in causes)
    joints, found = set(truth["joints"][0]), set((answer.get("where") or {}).get("joints") or [])
    place = "there" if joints == found else f"on {len(joints & found)} of {len(joints)} and {len(found - joints)} others"
    return verdict == wants and hits == len(causes) and joints == found, f"{hits} of {len(causes)}, {place}"


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("folder", type=Path)
    ap.add_argument("binary")
    ap.add_argument("--threads", type=int, default=2)
    ap.add_argument("--only", default="", help="numbers of studies, separated by commas")
    a = ap.parse_args()
    chosen = [int(k) for k in a.only.split(",")] if a.only else None
    tally, alarms, seconds = {}, 0, []
    for key, truth in json.loads((a.folder / "truth.json").read_text()).items():
        if chosen and int(key[1:]) not in chosen or not (a.folder / key / "study.toml").is_file():
            continue
        answer = ask(a.binary, a.folder / key / "study.toml", a.threads)
        right, why = judge(truth, answer)
        counts = tally.setdefault(truth["scenario"], [0, 0])
        counts[0] += right
        counts[1] += 1
        alarms += not truth["causes"] and answer["verdict"] == "effect"
        seconds.append(answer["seconds"])
        gap = answer.get("gap") or {}
        sizes = " > ".join(f"{1e3 * gap[k]:.2f}" for k in ("before", "calibrated", "after", "floor")) if gap else answer["sentence"]
        said = f"{answer['verdict']} {'+'.join(filter(None, [answer.get('effect'), answer.get('second')]))}"
        label = f"{truth['scenario']} {'+'.join(truth['causes']) or 'nothing'}"
        print(f"{key} {label:28} {'ok' if right else '--'} {said:36} {sizes} mrad; {why}; {answer['seconds']:.0f} s", flush=True)
    for scenario, (right, count) in tally.items():
        print(f"{scenario}: {right} of {count}")
    print(f"all: {sum(r for r, _ in tally.values())} of {sum(n for _, n in tally.values())}, false alarms {alarms}; longest {max(seconds):.0f} s")


if __name__ == "__main__":
    main()
