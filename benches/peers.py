#!/usr/bin/env python3
"""The same fit by four programs: how long each takes to predict a swing that none of them was fitted to.

    python3 benches/peers.py [--repeat N]

Three swings of q1 with 0.402 kg (`data/thesis-robot/q1-402g-{0,1,2}.csv`, made by MuJoCo) are fitted, the fourth is held out.
Sought are inertia, Coulomb friction, viscous friction and the rest angle, the moment is held; all begin at 1.5 times the inertia,
three times the friction and no rest angle. Every peer runs on one thread and is told when each swing was released and from where,
which `aibo-fit drop` finds out by itself.

- aibo-fit: the whole command `drop`, from CSV to report and figures, without beliefs.
- scipy: `least_squares` over central differences in one numpy batch (`scipy_joint.py`).
- CMA-ES (`pip install cma`), as toolkits for servos use it, its population in one numpy batch of the same integrator.
- MuJoCo's `mujoco.sysid.optimize` (`pip install mujoco[sysid]`) over `mujoco.rollout` with steps of 1 ms.

Each program's trials are kept with their times; afterwards the best so far predicts the held-out swing from the stated release, MuJoCo's
in MuJoCo and the others' in the numpy integrator. "Time" is when that first came within 2 % of where the program ends, the median of the
runs. What is not installed is left out, by name.
"""
import argparse
import contextlib
import io
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
import warnings

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(name, "1")
sys.dont_write_bytecode = True

try:
    import numpy as np
    from scipy.optimize import least_squares
except ImportError as missing:
    print(f"skipped: numpy and scipy are needed: {missing}")
    sys.exit(0)

from scipy_joint import Batch, Sidecars, hollow_cylinder

ROOT = pathlib.Path(__file__).resolve().parent.parent
SWINGS = [ROOT / f"data/thesis-robot/q1-402g-{k}.csv" for k in range(4)]
HELD_OUT = 3
NAMES = ("inertia", "coulomb", "viscous", "rest")
WRONG = {"inertia": 1.5, "coulomb": 3.0, "viscous": 3.0}
NEAR = 1.02  # of the held-out error at the end: there


class Swings:
    """The logs from their release on, and the joint's numbers as the peers begin with them."""

    def __init__(self):
        self.study = Sidecars([str(path) for path in SWINGS], None, None)
        joint = self.study.joint
        self.extra = [hollow_cylinder(log.extra) for log in self.study.logs]
        self.moment, self.gravity = joint["moment"], joint["gravity"]
        self.begin = np.array([joint[name] * WRONG[name] for name in NAMES[:3]] + [0.0])
        self.scale = np.array([*self.begin[:3], 0.1])
        self.low, self.high = np.append(0.02 * self.begin[:3], -0.5), np.append(50.0 * self.begin[:3], 0.5)
        self.released = [tomllib.loads(path.with_suffix(".toml").read_text())["release"] for path in SWINGS]
        self.batch = Batch(self.study.logs, joint)

    def residuals(self, points, which):
        """Model less reading of swings `which`, one row for each point, by the numpy integrator."""
        points = np.atleast_2d(points)
        log = np.tile(which, len(points))
        inertia, coulomb, viscous, rest = np.repeat(points, len(which), axis=0).T
        extra = np.array([self.extra[k] for k in log])
        start = np.array([self.released[k]["angle"] for k in log])
        first = np.array([self.study.logs[k].t[0] - self.released[k]["time"] for k in log])
        with np.errstate(all="ignore"):
            angle = self.batch.run(log, inertia + extra[:, 0], self.gravity * (self.moment + extra[:, 1]), coulomb, viscous,
                                   rest, start, np.zeros(len(log)), first)
        rows = []
        for row in range(0, len(log), len(which)):
            one = [angle[self.batch.ends[k], row + i] - self.study.logs[k].q for i, k in enumerate(which)]
            rows.append(np.nan_to_num(np.clip(np.concatenate(one), -1e3, 1e3), nan=1e3))
        return np.array(rows)


class Trials:
    """What a peer tried, when, and how well it fitted."""

    def __init__(self):
        self.began, self.kept = time.perf_counter(), []

    def add(self, x, residual):
        loss = float(residual @ residual)
        if not self.kept or loss < self.kept[-1][2]:
            self.kept.append((time.perf_counter() - self.began, np.array(x, float), loss))


FITTED = [k for k in range(len(SWINGS)) if k != HELD_OUT]


def rms_mrad(residual):
    return 1e3 * math.sqrt(float(np.mean(residual ** 2)))


def by_scipy(swings, _seed):
    trials = Trials()

    def residual(x):
        r = swings.residuals(x, FITTED)[0]
        trials.add(x, r)
        return r

    def jacobian(x):
        delta = 1e-6 * swings.scale
        moved = np.concatenate([x + np.diag(delta), x - np.diag(delta)])
        both = swings.residuals(moved, FITTED)
        return ((both[:4] - both[4:]) / (2 * delta[:, None])).T

    least_squares(residual, swings.begin, jac=jacobian, bounds=(swings.low, swings.high), x_scale=swings.scale)
    return trials, lambda x: swings.residuals(x, [HELD_OUT])[0]


def by_cma(swings, seed):
    with warnings.catch_warnings(action="ignore"):
        import cma
    trials = Trials()
    search = cma.CMAEvolutionStrategy(np.zeros(4), 0.3, {"seed": seed, "verbose": -9, "maxfevals": 4000})
    while not search.stop():
        asked = search.ask()
        # Friction and inertia by their logarithms.
        points = np.array([np.append(swings.begin[:3] * np.exp(a[:3]), 0.1 * a[3]) for a in asked])
        found = swings.residuals(np.clip(points, swings.low, swings.high), FITTED)
        for point, r in zip(points, found):
            trials.add(point, r)
        search.tell(asked, [float(r @ r) for r in found])
    return trials, lambda x: swings.residuals(np.clip(x, swings.low, swings.high), [HELD_OUT])[0]


def by_mujoco(swings, _seed):
    import mujoco
    from mujoco import rollout, sysid
    step_s = 0.001
    models = []
    for inertia, moment in swings.extra:
        # One unit mass on a massless rod: inertia comes in as armature.
        distance = swings.moment + moment
        model = mujoco.MjModel.from_xml_string(f"""
            <mujoco><option timestep="{step_s}" gravity="0 0 -{swings.gravity}" integrator="implicitfast"/>
            <worldbody><body><joint name="q" type="hinge" axis="0 1 0" armature="1e-6" frictionloss="1e-6" damping="1e-6"/>
            <inertial pos="0 0 -{distance}" mass="1" diaginertia="1e-6 1e-6 1e-6"/></body></worldbody></mujoco>""")
        models.append((model, mujoco.MjData(model)))
    trials = Trials()

    def residual(x, which):
        inertia, coulomb, viscous, rest = x
        parts = []
        for k in which:
            (model, data), log, released = models[k], swings.study.logs[k], swings.released[k]
            distance = swings.moment + swings.extra[k][1]
            model.dof_armature[0] = inertia + swings.extra[k][0] - distance ** 2 - 1e-6
            model.dof_frictionloss[0], model.dof_damping[0] = coulomb, viscous
            mujoco.mj_setConst(model, data)
            # Time, angle and speed; what comes back begins one step later.
            begin = np.array([[0.0, released["angle"] - rest, 0.0]])
            steps = np.round((log.t - released["time"]) / step_s).astype(int)
            states, _ = rollout.rollout(model, data, begin, nstep=steps[-1] + 1)
            angles = np.concatenate([begin[:, 1], states[0, :, 1]])
            parts.append(angles[steps] + rest - log.q)
        return np.nan_to_num(np.clip(np.concatenate(parts), -1e3, 1e3), nan=1e3)

    parameters = sysid.ParameterDict()
    for name, begin, low, high in zip(NAMES, swings.begin, swings.low, swings.high):
        parameters.add(sysid.Parameter(name, begin, low, high))

    def asked(x, _):
        found = residual(x, FITTED)
        trials.add(x, found)
        return [found], None, None

    with contextlib.redirect_stdout(io.StringIO()):
        sysid.optimize(parameters, asked, optimizer="scipy", verbose=False, x_scale=swings.scale)
    return trials, lambda x: residual(x, [HELD_OUT])


def by_aibo_fit(swings, program):
    logs = "".join(
        f'[[log]]\nfile = "{path}"\nrole = "{"validate" if k == HELD_OUT else "fit"}"\ndrive = "off"\n'
        f"[log.extra]\n" + "".join(f"{key} = {value}\n" for key, value in swings.study.logs[k].extra.items())
        for k, path in enumerate(SWINGS))
    begin = dict(zip(NAMES, swings.begin))
    with tempfile.TemporaryDirectory() as folder:
        study, found = pathlib.Path(folder, "study.toml"), pathlib.Path(folder, "drop.json")
        study.write_text(
            f'schema = 1\n[joint]\nname = "link"\ninertia = {begin["inertia"]}\nmoment = {swings.moment}\n'
            f'coulomb = {begin["coulomb"]}\nviscous = {begin["viscous"]}\ngravity = {swings.gravity}\n'
            f"[sensor]\nresolution = 0.006\nperiod = 0.008\n{logs}")
        free = [word for name in NAMES for word in ("--free", name)]
        command = [program, "drop", "--study", study, *free, "--fix", "moment", "--threads", "1", "--quiet", "--json", found,
                   "--out", pathlib.Path(folder, "out")]
        began = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True)
        took = time.perf_counter() - began
        if done.returncode:
            raise RuntimeError(done.stderr.strip())
        found = json.loads(found.read_text())["models"]["extensive"]["parameters"]
        return [(took, np.array([found[name]["value"] for name in NAMES]))]


def time_to(trace):
    """When a run's best so far first predicts the held-out swing nearly as well as at its end [s]; and how that is [mrad]."""
    end = trace[-1][1]
    return next(at_s for at_s, rms in trace if rms <= NEAR * end), end


def at_least_one(text):
    count = int(text)
    if count < 1:
        raise argparse.ArgumentTypeError("at least 1 was expected")
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=at_least_one, default=5, metavar="N", help="runs of each, whose median counts (default 5)")
    parser.add_argument("--program", default=str(ROOT / "target/release/aibo-fit"), help="the program (default: the release build)")
    options = parser.parse_args()
    swings = Swings()
    held_out = lambda x: swings.residuals(x, [HELD_OUT])[0]
    rows = []
    if os.access(options.program, os.X_OK):
        rows.append(("aibo-fit drop", [(by_aibo_fit(swings, options.program), held_out) for _ in range(options.repeat)]))
    else:
        print(f"left out: {options.program} is not there (cargo build --release)")
    for name, peer in [("scipy least_squares", by_scipy), ("CMA-ES", by_cma), ("mujoco.sysid", by_mujoco)]:
        try:
            runs = [peer(swings, seed) for seed in range(1, options.repeat + 1)]
        except ImportError as missing:
            print(f"left out: {name}: {missing}")
            continue
        rows.append((name, [([(at_s, x) for at_s, x, _ in trials.kept], predict) for trials, predict in runs]))
    print("| program | held-out RMS [mrad] | time [s] | times the first |")
    print("|---|---|---|---|")
    first_s = None
    for name, runs in rows:
        found = [time_to([(at_s, rms_mrad(predict(x))) for at_s, x in trials]) for trials, predict in runs]
        time_s, end = statistics.median(at_s for at_s, _ in found), statistics.median(end for _, end in found)
        first_s = first_s or time_s
        print(f"| {name} | {end:.3f} | {time_s:.3f} | {time_s / first_s:.1f} |")


if __name__ == "__main__":
    main()
