#!/usr/bin/env python3
"""Scores `aibo-fit gap` on what `make.py` made (see README.md beside this file).

    python3 score.py DIR BINARY [--threads N] [--only N,N...]
"""
import argparse
import json
import re
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path

STRONG = 2.5  # a cause that changes the motion less, in units of the floor, is reported and not counted
NUMBERS = ("inertia", "moment", "coulomb", "viscous")


def ask(binary, study, threads):
    """The answer as JSON, with `seconds`; a binary without beliefs is asked without them."""
    with tempfile.TemporaryDirectory(prefix="foreign-") as own:
        out = Path(own) / "gap.json"
        for text in (study.read_text(), re.sub(r"\[uncertain\]\n([a-z]+ = .*\n)+", "", study.read_text())):
            plain = study if text == study.read_text() else study.with_name("study-plain.toml")
            plain.write_text(text)
            began = time.monotonic()
            run = subprocess.run([binary, "gap", plain, "--json", out, "--out", Path(own) / "out", "--threads", str(threads), "--quiet"],
                                 capture_output=True, text=True)
            if plain != study:
                plain.unlink()
            if run.returncode == 0:
                return {**json.loads(out.read_text()), "seconds": time.monotonic() - began}
    return {"verdict": "error", "sentence": run.stderr.strip()[:160], "seconds": time.monotonic() - began}


def named(answer):
    """Ids that the answer names as causes, in its order. Where all stays unexplained they are the nearest only."""
    ids = [answer.get("effect"), answer.get("second")] + [e["id"] for e in answer.get("effects") or []]
    return [i for i in dict.fromkeys(ids) if i and i not in NUMBERS]


def judge(truth, answer):
    """(right, why) of a study."""
    verdict, ids, tied = answer["verdict"], named(answer), set(answer.get("equivalent") or [])
    law = answer.get("law") or {}
    if truth["kind"] == "nothing":
        return verdict in ("none", "calibration"), "alarm" if verdict == "effect" else verdict
    if truth["kind"] == "outside":
        stage = law.get("stage") or (answer.get("where") or {}).get("stage")
        seen = verdict == "unexplained" or bool(law)
        return seen and stage in truth["stages"], "accused" if not seen and verdict == "effect" else f"{verdict} at {stage}"
    hits = sum(c in ids or c in tied for c in truth["causes"])
    if hits == len(truth["causes"]) and verdict == "effect":
        return True, "first" if ids[:1] == truth["causes"][:1] or len(truth["causes"]) > 1 else "tied"
    return False, f"{hits} of {len(truth['causes'])}, {verdict}" + (" (nearest)" if hits and verdict == "unexplained" else "")


def covered(truth, answer):
    """Of each number or parameter with an interval: whether that holds the truth."""
    joint, scale, out = answer.get("joint") or {}, 1.0, []
    moment = joint.get("moment") or {}
    if truth["drive"] == "one load" and not moment.get("interval"):  # only ratios to the moment are asked then
        scale = moment["value"] / truth["numbers"]["moment"]
    for name in NUMBERS:
        interval = (joint.get(name) or {}).get("interval")
        if interval:
            out.append((name, interval[0] <= scale * truth["numbers"][name] <= interval[1]))
    listed = {e["id"]: e.get("parameters") or {} for e in answer.get("effects") or []}
    for cause, values in zip(truth["causes"], truth["values"]):
        for name, value in values.items():
            interval = ((listed.get(cause) or {}).get(name) or {}).get("interval")
            if interval:
                out.append((f"{cause}.{name}", interval[0] <= value <= interval[1]))
    return out


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("folder", type=Path)
    ap.add_argument("binary")
    ap.add_argument("--threads", type=int, default=1)
    ap.add_argument("--only", default="", help="numbers of studies, separated by commas")
    a = ap.parse_args()
    chosen = a.only.split(",") if a.only else None
    tally, cover, trusted, extra, seconds = {}, Counter(), Counter(), 0, []
    print(f"{'':3} {'truth':36}{'x floor':10}{'':6}{'answer':70} gap [mrad] before > after / floor")
    for key, truth in json.loads((a.folder / "truth.json").read_text()).items():
        if chosen and key not in chosen:
            continue
        answer = ask(a.binary, a.folder / key / "study.toml", a.threads)
        right, why = judge(truth, answer)
        weak = bool(truth["causes"]) and min(truth["strength"]) < STRONG
        kind = "weak" if weak else "new family" if set(truth["causes"]) & NEW else truth["kind"]
        counts = tally.setdefault(kind, Counter())
        counts.update(["all", "right"] if right else ["all"])
        counts.update([why.split(" at ")[0]])
        seconds.append(answer["seconds"])
        if right and truth["kind"] != "outside":
            extra += truth["kind"] != "nothing" and len(set(named(answer)) - set(truth["causes"])) > 0
            for name, inside in covered(truth, answer):
                cover.update(["all", "in"] if inside else ["all"])
                if answer.get("intervals_trusted", True):
                    trusted.update(["all", "in"] if inside else ["all"])
        gap = answer.get("gap") or {}
        said = f"{answer['verdict']} {'+'.join(named(answer))}" + (f" = {','.join(sorted(set(answer.get('equivalent') or []) - set(named(answer))))}" if answer.get("equivalent") else "")
        sizes = " ".join(f"{1e3 * gap[k]:.2f}" for k in ("before", "after", "floor")) if gap else answer["sentence"]
        label = truth["kind"] + " " + "+".join(truth["causes"]) + (" (mujoco)" if truth["engine"] == "mujoco" else "") + f" {truth['drive']}"
        print(f"{key:3} {label[:44]:45}{'/'.join(map(str, truth['strength'])):10}{'ok' if right else '--':4}{said[:70]:71}{sizes}  {why}; {answer['seconds']:.0f} s", flush=True)
    rate = lambda c: f"{c['in']} of {c['all']} ({100 * c['in'] / max(c['all'], 1):.0f} %)"
    for kind, c in tally.items():
        print(f"{kind}: {c['right']} of {c['all']} right; " + ", ".join(f"{k} {n}" for k, n in c.items() if k not in ("all", "right")))
    print(f"95 % intervals of right answers hold the truth: {rate(cover)}; where the program trusts them: {rate(trusted)}")
    print(f"right answers that name a cause too many: {extra}; seconds: median {sorted(seconds)[len(seconds) // 2]:.1f}, longest {max(seconds):.0f}, all {sum(seconds):.0f}")


NEW = {"dead_band", "sensor_delay", "setpoint_profile", "compliance"}

if __name__ == "__main__":
    main()
