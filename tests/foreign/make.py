#!/usr/bin/env python3
"""Makes joint studies with other programs' simulators, for `score.py` (see README.md beside this file).

    python3 make.py DIR [--only N,N...] [--sizes]   # DIR/00 ... and DIR/truth.json, which gap never reads

How large each effect is, so that it changes the motion by what was drawn, is looked up in sizes.json; `--sizes` seeks it anew.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.dont_write_bytecode = True  # no __pycache__ in the source tree

import joints
from plan import PLAN, SEED, draw

SECONDS = 7.0
COARSE_S = 2e-4  # step while sizes are sought
TRIES = 6
SIZES = Path(__file__).with_name("sizes.json")
SHARED = ("inertia", "moment", "coulomb", "viscous")


def run(lanes, step_s=1e-4):
    """Paths of all lanes, own engine in one batch, MuJoCo's one by one."""
    out = [None] * len(lanes)
    own = [i for i, lane in enumerate(lanes) if lane.get("engine") != "mujoco"]
    if own:
        paths, torques, speeds = joints.simulate([{k: v for k, v in lanes[i].items() if k != "engine"} for i in own], SECONDS, step_s)
        for place, i in enumerate(own):
            out[i] = (paths[:, place], torques[place], speeds[place])
    for i, lane in enumerate(lanes):
        if out[i] is None:
            import mujoco_joints
            out[i] = mujoco_joints.simulate(lane, SECONDS)
    return out


def sensitivities(study):
    """Lanes with one number or start a little off; the program can take such differences up."""
    lanes = []
    for log in study.lanes:
        plain = {**log, "engine": "own"}
        lanes.append(plain)
        lanes += [{**plain, name: plain[name] * 1.02} for name in SHARED]
        lanes += [{**plain, "angle": plain["angle"] + 0.002}, {**plain, "speed": plain["speed"] + 0.02}]
    return lanes


def strength(study, before, after, columns):
    """RMS of what an effect changes beyond any change of numbers and starts, in units of the floor."""
    change = np.concatenate([joints.read(b, l, t) - joints.read(a, p, t) for (a, p), (b, l), t in zip(before, after, study.times)])
    left = change - columns @ np.linalg.lstsq(columns, change, rcond=1e-8)[0]
    return float(np.sqrt(np.mean(left**2)) / study.floor)


def columns_of(study, found):
    """Sensitivities as columns: the four numbers shared by all logs, two starts for each log."""
    blocks, per = [], 1 + len(SHARED) + 2
    for k, (log, t) in enumerate(zip(study.lanes, study.times)):
        at = [joints.read(found[k * per + j][0], log, t) for j in range(per)]
        block = np.zeros((len(t), len(SHARED) + 2 * len(study.lanes)))
        for j in range(len(SHARED)):
            block[:, j] = at[1 + j] - at[0]
        block[:, len(SHARED) + 2 * k:len(SHARED) + 2 * k + 2] = np.stack([at[-2] - at[0], at[-1] - at[0]], axis=1)
        blocks.append(block)
    return np.concatenate(blocks)


def scale(studies):
    """Sizes of all effects so that each changes the motion by what was drawn, or by what its range allows."""
    jobs = [(s, c) for s in studies for c in s.causes]
    if not jobs:
        return
    of = {id(s): s for s, _ in jobs}.values()
    flat, spans = [], {}
    for s in of:
        spans[id(s)] = len(flat)
        flat += sensitivities(s)
    found = run(flat, COARSE_S)
    plain = [dict(log, engine=s.engine) for s in of for log in s.lanes]
    bare, k = run(plain, COARSE_S), 0
    for s in of:
        s.bare, k = bare[k:k + len(s.lanes)], k + len(s.lanes)
        s.columns = columns_of(s, found[spans[id(s)]:spans[id(s)] + len(s.lanes) * 7])
        s.most = max(b[1] for b in s.bare), max(b[2] for b in s.bare), max(float(b[0].max()) for b in s.bare)
    for n in range(TRIES):
        lanes = [dict(c.on(log, s.most), engine=s.engine) for s, c in jobs for log in s.lanes]
        found, k = run(lanes, COARSE_S), 0
        for s, c in jobs:
            after = [(found[k + i][0], lanes[k + i]) for i in range(len(s.lanes))]
            c.strength, k = strength(s, [(b[0], p) for b, p in zip(s.bare, s.lanes)], after, s.columns), k + len(s.lanes)
            if n + 1 < TRIES:
                c.try_next()


def readings(study, k, path, lane):
    """Log `k` as the encoder shows it: noise, rounding, stamps that jitter, samples that are lost."""
    dice, t = study.dice, study.times[k]
    noise = dice.normal(size=len(t))
    if study.noise_s > 0:
        keep = np.exp(-np.diff(t) / study.noise_s)
        for i in range(1, len(t)):
            noise[i] = keep[i - 1] * noise[i - 1] + np.sqrt(1 - keep[i - 1] ** 2) * noise[i]
    return np.round((joints.read(path, lane, t) + study.noise * noise) / study.step) * study.step


def write(folder, study, found, lanes):
    folder.mkdir(parents=True, exist_ok=True)
    stated = study.nominal
    text = ["schema = 1", "[joint]", f'name = "j{study.number:02}"'] + [f"{k} = {stated[k]:.5g}" for k in SHARED]
    text += ["gravity = 9.81", "rest = 0.0" if study.rest_stated else "", "[sensor]", f"resolution = {study.step:.6g}", f"period = {study.period:.5g}"]
    if study.kp:
        text += ["[motor]", f"kp = {study.kp:.6g}", f"kd = {study.kd:.6g}"]
    if study.uncertain:
        text += ["[uncertain]"] + [f"{k} = {v}" for k, v in study.uncertain.items()]
    for k, t in enumerate(study.times):
        q, setpoints = readings(study, k, found[k][0], lanes[k]), study.lanes[k].get("setpoints")
        header = "t,q,q_ref" if setpoints is not None else "t,q"
        rows = [f"{a:.6f},{b:.6f}" + (f",{study.commands[k][i]:.6f}" if setpoints is not None else "") for i, (a, b) in enumerate(zip(t, q))]
        (folder / f"{k}.csv").write_text("\n".join([header, *rows]) + "\n")
        text += ["[[log]]", f'file = "{k}.csv"', f'role = "{"validate" if k == len(study.times) - 1 else "fit"}"',
                 f'drive = "{"position" if setpoints is not None else "off"}"']
        if study.extras[k]:
            text += ["[log.extra]"] + [f"{a} = {b:.6g}" for a, b in study.extras[k].items()]
    (folder / "study.toml").write_text("\n".join(line for line in text if line) + "\n")


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("folder", type=Path)
    ap.add_argument("--only", default="", help="numbers of studies, separated by commas")
    ap.add_argument("--seed", type=int, default=SEED, help="other studies of the same plan; their sizes are sought anew (minutes)")
    ap.add_argument("--sizes", action="store_true", help="seek the sizes of all effects anew (minutes) and write sizes.json")
    a = ap.parse_args()
    chosen = [int(n) for n in a.only.split(",") if n] or range(len(PLAN))
    studies = [draw(n, SECONDS, a.seed) for n in chosen]
    known = json.loads(SIZES.read_text()) if SIZES.exists() else {}
    if a.sizes or a.seed != SEED:
        scale(studies)
        known.update({str(s.number): dict(most=s.most, causes=[[c.size, c.strength] for c in s.causes]) for s in studies if s.causes})
    if a.sizes and a.seed == SEED:
        SIZES.write_text("{\n" + ",\n".join(f'"{k}": {json.dumps(known[k])}' for k in sorted(known, key=int)) + "\n}\n")
    for s in studies:
        if s.causes:
            s.most = known[str(s.number)]["most"]
            for c, found in zip(s.causes, known[str(s.number)]["causes"]):
                c.size, c.strength = found
    lanes = []
    for s in studies:
        for log in s.lanes:
            log = dict(log)
            for c in s.causes:
                log = c.on(log, s.most)
            lanes.append(dict(log, engine=s.engine))
    found, k, truth = run(lanes), 0, {}
    for s in studies:
        n = len(s.lanes)
        write(a.folder / f"{s.number:02}", s, found[k:k + n], lanes[k:k + n])
        truth[f"{s.number:02}"] = s.truth()
        k += n
    (a.folder / "truth.json").write_text(json.dumps(truth, indent=1))
    print(f"{len(studies)} studies in {a.folder}")


if __name__ == "__main__":
    main()
