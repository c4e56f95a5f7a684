#!/usr/bin/env python3
"""Baseline pendulum fit with scipy: the floor `aibo-fit` is judged against. Shares no code with it.

Model of one joint (docs: section "Baseline joint" of the formats):

    I* q'' + mu_c sign(q') + mu_v q' + g M* sin(q - rest) = tau,   stuck while |net torque| <= mu_c

`tau` is 0 (drive "off"), the column `tau` held from its sample to the next ("torque"), or the PD law
kp (q_ref - q) - kd q' acting continuously ("position"). An extra mass is a hollow cylinder: I* gains
1/2 M R^2 + 1/12 M L^2 + M D^2, M* gains M D. All fit logs share one parameter set; every log has its own
start: held logs a free angle and a free release instant, other logs a free angle and speed.

    python3 benches/scipy_fit.py STUDY.toml [--free-moment | --hold-moment] [--until SECONDS] [--json OUT] [--time]
    python3 benches/scipy_fit.py --log FILE.csv [FILE.csv ...]      # reads the sidecar FILE.toml of each
    python3 benches/scipy_fit.py --log FILE.csv --ratio             # times aibo-fit on it too

Residuals are unweighted, at every sample after release. The integrator is RK4 with the zero crossings of q'
and the break-away instants located inside the step; the finite-difference columns, the logs and the several
starts of `scipy.optimize.least_squares` are integrated together as one numpy batch (`scipy_joint.py`).
"""
import argparse
import itertools
import json
import math
import os
import subprocess
import sys
import threading
import time
import tomllib

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the matrices are thin; BLAS threads only spin
os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.dont_write_bytecode = True  # no __pycache__ in the source tree

try:
    import numpy as np
    from scipy.optimize import least_squares
except ImportError as missing:
    print(f"skipped: scipy not installed (numpy and scipy are needed: {missing})")
    sys.exit(0)

from scipy_joint import DIVERGED, BadData, Batch, Log, Sidecars, Study, hollow_cylinder  # numpy may be missing: after the above


class Problem:
    """Parameter vector: inertia, [moment], coulomb, viscous, [rest...], then two start values per log."""

    def __init__(self, study, logs, free_moment, rest_per_load, refine=1, frozen=None):
        self.study, self.logs, self.frozen = study, logs, frozen
        j = study.joint
        self.free_moment, self.free_rest = free_moment, "rest" not in j
        self.batch = Batch(logs, j, refine)
        extras = [hollow_cylinder(log.extra) for log in logs]
        self.extra_i = np.array([e[0] for e in extras])
        self.extra_m = np.array([e[1] for e in extras])
        loads = sorted({e for e in extras})
        self.rest_of = np.array([loads.index(e) if rest_per_load else 0 for e in extras])
        self.rests = (max(self.rest_of) + 1) if self.free_rest else 0
        self.names = ["inertia"] + (["moment"] if free_moment else []) + ["coulomb", "viscous"]
        self.names += ["rest" if self.rests == 1 else f"rest[{k}]" for k in range(self.rests)]
        self.shared = len(self.names) if frozen is None else 0
        self.size = self.shared + 2 * len(logs)
        inertia, moment = j["inertia"] + self.extra_i.mean(), j["moment"] + self.extra_m.mean()
        torque = j["gravity"] * moment
        scale = [inertia] + ([moment] if free_moment else [])
        low, high = [0.02 * inertia - self.extra_i.min()], [50 * inertia]
        if free_moment:
            low, high = low + [0.02 * moment - self.extra_m.min()], high + [50 * moment]
        scale += [0.1 * torque, 0.1 * math.sqrt(torque * inertia)]
        low, high = low + [0.0, 0.0], high + [20 * torque, 50 * math.sqrt(torque * inertia)]
        scale, low, high = scale + [0.1] * self.rests, low + [-3.2] * self.rests, high + [3.2] * self.rests
        if frozen is not None:
            scale, low, high = [], [], []
        for log in logs:
            if log.held:
                scale += [0.01, 0.5 * (log.held[1] - log.held[0])]
                low, high = low + [-20.0, log.held[0]], high + [20.0, log.held[1]]
            else:
                scale, low, high = scale + [0.01, 0.1], low + [-50.0, -200.0], high + [50.0, 200.0]
        self.scale, self.low, self.high = map(np.array, (scale, low, high))
        # rows of one evaluation: per log the centre, then +- every column that touches it
        self.columns = [list(range(self.shared)) + [self.shared + 2 * k, self.shared + 2 * k + 1] for k in range(len(logs))]
        self.offset = np.concatenate([[0], np.cumsum([log.n for log in logs])])
        self.samples = int(self.offset[-1])
        self.delta = 1e-6 * self.scale

    def start_vector(self, shared):
        return np.concatenate([np.asarray(shared, float)] + [np.array(log.start) for log in self.logs])

    def unpack(self, x, log):
        """x: [row, size]; log: [row]. Inertia, g M, mu_c, mu_v, rest, q, v, first step of each row."""
        j, k = self.study.joint, 0
        s = x if self.frozen is None else np.broadcast_to(self.frozen, (len(x), len(self.names)))
        inertia = s[:, 0] + self.extra_i[log]
        moment = s[:, 1] if self.free_moment else np.full(len(x), j["moment"])
        k = 2 if self.free_moment else 1
        rest = s[np.arange(len(x)), k + 2 + self.rest_of[log]] if self.free_rest else np.full(len(x), j["rest"])
        rows = np.arange(len(x))
        a, b = x[rows, self.shared + 2 * log], x[rows, self.shared + 2 * log + 1]
        held = np.array([self.logs[i].held is not None for i in range(len(self.logs))])[log]
        t_first = np.array([one.t[0] for one in self.logs])[log]
        speed, first = np.where(held, 0.0, b), np.where(held, t_first - b, 0.0)
        return inertia, j["gravity"] * (moment + self.extra_m[log]), s[:, k], s[:, k + 1], rest, a, speed, first

    def evaluate(self, points, jacobian=True):
        """Residuals (and Jacobians by central differences) at several points, in one batch."""
        xs, logs = [], []
        for x in points:
            for k, columns in enumerate(self.columns):
                xs.append(x[None, :])
                logs.append([k])
                if jacobian:
                    moved = np.repeat(x[None, :], 2 * len(columns), axis=0)
                    for i, c in enumerate(columns):
                        moved[2 * i, c] += self.delta[c]
                        moved[2 * i + 1, c] -= self.delta[c]
                    xs.append(moved)
                    logs.append([k] * len(moved))
        with np.errstate(all="ignore"):
            log = np.array(list(itertools.chain(*logs)))
            angle = self.batch.run(log, *self.unpack(np.concatenate(xs), log))
        results, row = [], 0
        for x in points:
            r, jac = np.empty(self.samples), np.zeros((self.samples, self.size)) if jacobian else None
            for k, columns in enumerate(self.columns):
                at = slice(self.offset[k], self.offset[k + 1])
                end = self.batch.ends[k]
                one = angle[end, row] - self.logs[k].q
                r[at] = np.clip(np.nan_to_num(one, nan=DIVERGED, posinf=DIVERGED, neginf=-DIVERGED), -DIVERGED, DIVERGED)
                row += 1
                if jacobian:
                    for i, c in enumerate(columns):
                        d = (angle[end, row + 2 * i] - angle[end, row + 2 * i + 1]) / (2 * self.delta[c])
                        jac[at, c] = np.where(np.isfinite(d) & (np.abs(one) < DIVERGED), d, 0.0)
                    row += 2 * len(columns)
            results.append((r, jac))
        return results

    def rms(self, x):
        r = self.evaluate([x], False)[0][0]
        logs = [float(np.sqrt(np.mean(r[a:b] ** 2))) for a, b in zip(self.offset[:-1], self.offset[1:])]
        return float(np.sqrt(np.mean(r ** 2))), logs, r


class Pool:
    """Runs several least_squares at once, one thread each, and evaluates their points in one numpy batch."""

    def __init__(self, problem, budget):
        self.problem, self.budget = problem, budget
        self.lock = threading.Condition()
        self.waiting, self.answers, self.running, self.calls = {}, {}, 0, 0

    def ask(self, key, x):
        with self.lock:
            self.waiting[key] = x.copy()
            self.lock.notify_all()
            while key not in self.answers:
                self.lock.wait()
            return self.answers.pop(key)

    def worker(self, key, x0, results):
        cache = {}

        def both(x):
            tag = x.tobytes()
            if cache.get("tag") != tag:
                cache["tag"], cache["value"] = tag, self.ask(key, x)
            return cache["value"]
        p = self.problem
        try:
            margin = 1e-9 * p.scale
            fit = least_squares(lambda x: both(x)[0], np.clip(x0, p.low + margin, p.high - margin), jac=lambda x: both(x)[1],
                                bounds=(p.low, p.high), x_scale=p.scale, method="trf",
                                ftol=1e-9, xtol=1e-9, gtol=1e-12, max_nfev=self.budget)
            results[key] = (math.sqrt(2 * fit.cost / p.samples), fit.x, fit.status, fit.nfev)
        except (ValueError, np.linalg.LinAlgError) as error:
            results[key] = (math.inf, x0, -9, str(error))
        with self.lock:
            self.running -= 1
            self.lock.notify_all()

    def fit(self, starts):
        results = {}
        self.running = len(starts)
        threads = [threading.Thread(target=self.worker, args=(k, x, results), daemon=True) for k, x in enumerate(starts)]
        for thread in threads:
            thread.start()
        while True:
            with self.lock:
                while self.running and len(self.waiting) < self.running:
                    self.lock.wait()
                if not self.running:
                    break
                keys = sorted(self.waiting)
                points = [self.waiting.pop(k) for k in keys]
            answers = self.problem.evaluate(points)
            self.calls += 1
            with self.lock:
                self.answers.update(zip(keys, answers))
                self.lock.notify_all()
        for thread in threads:
            thread.join()
        return [results[k] for k in range(len(starts))]


def regression(problem):
    """Shared parameters by linear regression on smoothed derivatives: one more start."""
    study, lines, right = problem.study, [], []
    for log, ei, em in zip(problem.logs, problem.extra_i, problem.extra_m):
        half = max(3, int(0.04 / np.median(np.diff(log.t))))
        for k in range(half, log.n - half, max(1, half // 3)):
            s = slice(k - half, k + half + 1)
            c = np.polyfit(log.t[s] - log.t[k], log.q[s], 3)
            a, v, q = 2 * c[1], c[2], c[3]
            if abs(v) < 0.3:
                continue
            g = study.joint["gravity"]
            tau = 0.0
            if log.tau is not None:
                tau = float(np.mean(log.tau[s]))
            elif log.ref is not None and log.on[k]:
                tau = log.motor.get("kp", 0) * (log.ref[k] - q) - log.motor.get("kd", 0) * v
            known = tau - ei * a - g * em * math.sin(q)
            row = [a, np.sign(v), v]
            if problem.free_moment:
                row.insert(1, g * math.sin(q))
            else:
                known -= g * study.joint["moment"] * math.sin(q)
            if problem.free_rest:
                row.append(-g * study.joint["moment"] * math.cos(q))
            lines.append(row)
            right.append(known)
    if len(lines) < 20:
        return None
    x = np.linalg.lstsq(np.array(lines), np.array(right), rcond=None)[0]
    n = 4 if problem.free_moment else 3
    rest = [float(np.clip(x[n], -1, 1))] * problem.rests if problem.free_rest else []
    return np.concatenate([x[:n], rest])


def smooth_speed(log):
    """Speed by straight lines through 60 ms of samples."""
    half = max(2, int(0.03 / np.median(np.diff(log.t))))
    before, after = np.maximum(np.arange(log.n) - half, 0), np.minimum(np.arange(log.n) + half, log.n - 1)
    return (log.q[after] - log.q[before]) / (log.t[after] - log.t[before])


def shortened(logs, part):
    """The same logs, their first part only."""
    short = []
    for log in logs:
        one = object.__new__(Log)
        one.__dict__.update(log.__dict__)
        keep = int(np.searchsorted(log.t, log.t[0] + part * (log.t[-1] - log.t[0]), side="right"))
        keep = max(8, keep)
        one.t, one.q, one.on, one.n = log.t[:keep], log.q[:keep], log.on[:keep], keep
        one.tau = None if log.tau is None else log.tau[:keep]
        one.ref = None if log.ref is None else log.ref[:keep]
        short.append(one)
    return short


def make_starts(problem):
    """Nominal, inertia x2 and /2, friction x10 and /10, regression, and the best of a grid."""
    j = problem.study.joint
    rests = [0.0]
    tails = [float(np.median(log.q[-max(3, log.n // 20):])) for log in problem.logs if log.drive == "off"]
    if problem.free_rest and tails and abs(np.mean(tails)) < 1.0:
        rests = [float(np.mean(tails)), 0.0]

    # bare values are varied through the loaded joint's, so that a heavy extra mass does not hide the variation
    mean_i, mean_m = problem.extra_i.mean(), problem.extra_m.mean()

    def point(fi, fm, fc, fv, rest):
        s = [(j["inertia"] + mean_i) * fi - mean_i]
        if problem.free_moment:
            s.append((j["moment"] + mean_m) * fm - mean_m)
        s += [j["coulomb"] * fc, j["viscous"] * fv] + [rest] * problem.rests
        return np.array(s)
    named = [("nominal", point(1, 1, 1, 1, rests[0])), ("inertia x2", point(2, 1, 1, 1, rests[0])),
             ("inertia /2", point(0.5, 1, 1, 1, rests[0])), ("friction x10", point(1, 1, 10, 10, rests[0])),
             ("friction /10", point(1, 1, 0.1, 0.1, rests[0]))]
    guess = regression(problem)
    if guess is not None:
        named.append(("regression", guess))
    moments = (0.5, 1, 2) if problem.free_moment else (1,)
    grid = [point(fi, fm, fc, fv, rest) for fi in (0.5, 1, 2) for fm in moments for fc in (0.1, 0.5, 1, 3, 10)
            for fv in (0.1, 1, 3, 10) for rest in rests]
    grid = [problem.start_vector(s) for s in grid]
    cost = []
    for k in range(0, len(grid), 60):
        cost += [float(np.sum(np.minimum(r * r, 1.0))) for r, _ in problem.evaluate(grid[k:k + 60], False)]
    best = np.argsort(cost, kind="stable")[:3]
    return [(name, problem.start_vector(s)) for name, s in named] + [(f"grid {k + 1}", grid[i]) for k, i in enumerate(best)]


def fit(study, free_moment, rest_per_load=False, budget=60, extra_starts=0, progress=lambda text: None):
    logs = [log for log in study.logs if log.role == "fit"]
    if not logs:
        raise BadData(f"{study.name}: no log with role fit")
    began = time.perf_counter()
    problem = Problem(study, logs, free_moment, rest_per_load)
    starts = make_starts(problem)
    rng = np.random.default_rng(1)
    for k in range(extra_starts):  # inertia and moment within x2, friction within x10 of the regression's or nominal start
        base = starts[k % min(len(starts), 6)][1].copy()
        width = np.array([math.log(2)] * problem.names.index("coulomb") + [math.log(10)] * 2)
        mean = np.array([problem.extra_i.mean(), problem.extra_m.mean(), 0, 0])[:len(width)] if free_moment else \
            np.array([problem.extra_i.mean(), 0, 0])
        base[:len(width)] = (np.maximum(base[:len(width)], 0) + mean) * np.exp(width * rng.uniform(-1, 1, len(width))) - mean
        base[len(width):problem.shared] += rng.uniform(-0.1, 0.1, problem.shared - len(width))
        starts.append((f"random {k + 1}", base))
    calls = 0
    # first the early part of the logs only, from every start: open-loop errors grow with time, and so do false minima
    early = Problem(study, shortened(logs, 0.3), free_moment, rest_per_load)
    pool = Pool(early, 25)
    results = pool.fit([x for _, x in starts])
    calls += pool.calls
    kept = []
    for k in np.argsort([r[0] for r in results], kind="stable"):
        if math.isfinite(results[k][0]) and all(np.max(np.abs((results[k][1] - x) / early.scale)) > 1e-2 for _, x in kept):
            kept.append((f"early part from {starts[k][0]}", results[k][1]))
    starts += kept[:4]
    progress(f"{len(starts)} starts, {problem.samples} samples, {problem.batch.count} steps")
    pool = Pool(problem, budget)
    results = pool.fit([x for _, x in starts])
    calls += pool.calls
    table = [{"start": name, "rms": r[0], "evaluations": r[3], "status": r[2],
              "parameters": dict(zip(problem.names, map(float, r[1][:problem.shared])))}
             for (name, _), r in zip(starts, results)]
    best = int(np.argmin([r[0] for r in results]))
    # neighbours: the number of half swings before the joint sticks is a whole number, so a minimum lies on every one.
    # Walk along the valley in which Coulomb and viscous friction take the same energy, and shift the rest angle.
    score, x, _, _ = results[best]
    origin = starts[best][0]
    lost_linear = sum(np.sum(np.abs(np.diff(log.q))) for log in logs)
    lost_square = sum(np.sum(smooth_speed(log)[:-1] * np.diff(log.q)) for log in logs)
    speed = max(lost_square / lost_linear, 1e-9)
    c = problem.names.index("coulomb")
    for round_number in range(4):
        around = [x]
        mean = x[c] + x[c + 1] * speed
        for factor in (0.0, 0.4, 0.6, 0.75, 0.88, 1.12, 1.3, 1.6, 2.2):
            y = x.copy()
            y[c] = factor * x[c] if factor else 1e-3 * mean
            y[c + 1] = max((mean - y[c]) / speed, 1e-3 * mean / speed)
            around.append(y)
        y = x.copy()
        y[c], y[c + 1] = 0.97 * mean, 0.03 * mean / speed
        around.append(y)
        for shift in (-0.05, 0.05) if problem.rests else ():
            y = x.copy()
            y[c + 2:c + 2 + problem.rests] += shift
            around.append(y)
        pool = Pool(problem, budget)
        found = pool.fit(around)
        calls += pool.calls
        k = int(np.argmin([r[0] for r in found]))
        gain = score - found[k][0]
        if gain > 0:
            score, x = found[k][0], found[k][1]
        if gain < 1e-4 * score:
            break
        origin += f", neighbour {round_number + 1}"
    rms, per_log, residual = problem.rms(x)
    return {"problem": problem, "x": x, "rms": rms, "per_log": per_log, "starts": table,
            "best_start": origin, "calls": calls, "seconds": time.perf_counter() - began, "residual": residual}


def predict(study, problem, x, logs):
    """RMS of logs that were not fitted: shared parameters frozen, only their starts fitted."""
    if not logs:
        return None
    shared = x[:problem.shared]
    if problem.rests > 1:
        return None
    frozen = Problem(study, logs, problem.free_moment, False, frozen=shared)
    result = Pool(frozen, 40).fit([frozen.start_vector([])])[0]
    return frozen.rms(result[1])


# ------------------------------------------------------------------ command line

def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", nargs="?", help="joint study, TOML")
    parser.add_argument("--log", nargs="+", metavar="FILE.csv", help="logs with their sidecars instead of a study")
    parser.add_argument("--nominal", metavar="STUDY.toml", help="nominal model for --log (default: the ERS-7's joint of that name)")
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--free-moment", action="store_true", help="fit M* too")
    moment.add_argument("--hold-moment", action="store_true", help="keep M* at its nominal value")
    parser.add_argument("--until", type=float, metavar="SECONDS", help="use each log's first seconds after its start (or release) only")
    parser.add_argument("--all", action="store_true", help="fit the validate logs as well")
    parser.add_argument("--only", nargs="+", metavar="FILE", help="use these logs of the study only")
    parser.add_argument("--rest-per-load", action="store_true", help="one free rest angle for each extra mass")
    parser.add_argument("--fix-rest", type=float, metavar="RAD", help="rest angle known")
    parser.add_argument("--torque-limit", type=float, metavar="NM", help="add a motor torque limit to position-driven logs")
    parser.add_argument("--budget", type=int, default=60, help="evaluations per start (default 60)")
    parser.add_argument("--random", type=int, default=0, metavar="N", help="N further starts drawn at random (seeded)")
    parser.add_argument("--json", metavar="OUT", help="write the result as JSON")
    parser.add_argument("--time", action="store_true", help="also time a single rollout and a fit from the nominal start alone")
    parser.add_argument("--ratio", action="store_true", help="with --log of one file: also time aibo-fit on it and print the ratio")
    parser.add_argument("--starts", action="store_true", help="print where every start ended")
    args = parser.parse_args()
    if bool(args.study) == bool(args.log):
        parser.error("give one STUDY.toml or --log FILE.csv")
    if args.ratio and (args.study or len(args.log) > 1 or args.until or args.free_moment or args.fix_rest is not None):
        parser.error("--ratio compares fits of one whole log with the rest angle free: give --log FILE.csv alone")
    try:
        study = Study(args.study, args.until) if args.study else Sidecars(args.log, args.until, args.nominal)
    except (BadData, OSError, KeyError, tomllib.TOMLDecodeError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    if args.only:
        study.logs = [log for log in study.logs if log.file in args.only]
        for log in study.logs:
            log.role = "fit"
    for log in study.logs:
        if args.all:
            log.role = "fit"
        if args.torque_limit:
            log.motor["torque_limit"] = args.torque_limit
    if args.fix_rest is not None:
        study.joint["rest"] = args.fix_rest
    fitted = [log for log in study.logs if log.role == "fit"]
    loads = {hollow_cylinder(log.extra) for log in fitted}
    free = any(log.drive != "off" for log in fitted) or len(loads) > 1
    free = args.free_moment or (free and not args.hold_moment)
    say = (lambda text: print(text, file=sys.stderr)) if sys.stderr.isatty() else (lambda text: None)
    try:
        done = fit(study, free, args.rest_per_load, args.budget, args.random, say)
    except BadData as error:
        print(f"error: {error}", file=sys.stderr)
        return 3
    problem, x = done["problem"], done["x"]
    finer = Problem(study, fitted, free, args.rest_per_load, refine=2).rms(x)[0]
    held_out = predict(study, problem, x, [log for log in study.logs if log.role != "fit"])

    units = {"inertia": "kg m^2", "moment": "kg m", "coulomb": "N m", "viscous": "N m s/rad"}
    print(f"{study.name}")
    print(f"  {'log':34s} {'role':9s} {'drive':9s} {'samples':>8s} {'RMS [rad]':>10s} {'worst':>8s}")
    result = {"study": os.path.basename(os.path.dirname(study.name)) or study.name, "until": args.until,
              "moment": "free" if free else "held", "rms": done["rms"], "samples": problem.samples, "logs": [], "parameters": {}}

    def show(log, rms, residual, role, start):
        print(f"  {log.file:34s} {role:9s} {log.drive:9s} {log.n:8d} {rms:10.5f} {np.max(np.abs(residual)):8.4f}")
        result["logs"].append({"file": log.file, "role": role, "drive": log.drive, "samples": log.n, "rms": rms,
                               "worst": float(np.max(np.abs(residual))), **start})
    for k, log in enumerate(fitted):
        a, b = x[problem.shared + 2 * k:problem.shared + 2 * k + 2]
        start = {"start_angle": float(a), ("release" if log.held else "start_speed"): float(b)}
        show(log, done["per_log"][k], done["residual"][problem.offset[k]:problem.offset[k + 1]], "fit", start)
    print(f"  {'all fit logs':34s} {'':9s} {'':9s} {problem.samples:8d} {done['rms']:10.5f}")
    if held_out:
        rest, at = [log for log in study.logs if log.role != "fit"], 0
        for log, rms in zip(rest, held_out[1]):
            show(log, rms, held_out[2][at:at + log.n], "validate", {})
            at += log.n
    for k, name in enumerate(problem.names):
        result["parameters"][name] = float(x[k])
        edge = " (on its bound)" if min(x[k] - problem.low[k], problem.high[k] - x[k]) < 1e-6 * problem.scale[k] else ""
        nominal = study.joint.get(name)
        print(f"  {name:10s} {x[k]:12.6g} {units.get(name, 'rad'):10s}" + (f" nominal {nominal:g}" if nominal is not None else "") + edge)
    if not free:
        result["parameters"]["moment"] = study.joint["moment"]
        print(f"  {'moment':10s} {study.joint['moment']:12.6g} {'kg m':10s} held at its nominal value")
    if not problem.free_rest:
        result["parameters"]["rest"] = study.joint["rest"]
    spread = sorted(s["rms"] for s in done["starts"])
    near = sum(s < done["rms"] * 1.001 + 1e-9 for s in spread)
    print(f"  starts: {near} of {len(spread)} ended within 0.1 % of the best (from: {done['best_start']}); worst {spread[-1]:.5f} rad")
    if args.starts:
        for s in sorted(done["starts"], key=lambda s: s["rms"]):
            print(f"    {s['rms']:10.6f} {s['evaluations']!s:>4} {s['start']:32s} " +
                  " ".join(f"{k} {v:.4g}" for k, v in s["parameters"].items()))
    print(f"  integrator: RMS changes by {abs(finer - done['rms']):.1e} rad at half the step")
    print(f"  wall time of the whole fit: {done['seconds']:.2f} s, {done['calls']} batched evaluations")
    result.update(seconds=done["seconds"], evaluations=done["calls"], starts=done["starts"], step_check=abs(finer - done["rms"]))
    if args.time or args.ratio:
        x0 = problem.start_vector(x[:problem.shared])
        one = min(timed(lambda: problem.evaluate([x0], False)) for _ in range(3))
        both = min(timed(lambda: problem.evaluate([x0], True)) for _ in range(3))
        j = study.joint
        nominal = [j["inertia"]] + ([j["moment"]] if free else []) + [j["coulomb"], j["viscous"]] + [0.0] * problem.rests
        single = []
        alone = timed(lambda: single.append(Pool(problem, args.budget).fit([problem.start_vector(nominal)])[0]))
        print(f"  all logs once: {one:.3f} s; with the Jacobian: {both:.3f} s; fit from the nominal start alone: "
              f"{alone:.2f} s, RMS {single[0][0]:.5f} rad, {single[0][3]} evaluations")
        result["timing"] = {"rollout_s": one, "jacobian_s": both, "single_start_s": alone, "single_start_rms": single[0][0]}
    if args.ratio:
        result["ratio"] = print_ratio(args.log[0], study.joint, alone, single[0][0], done["seconds"], done["rms"])
    if args.json:
        with open(args.json, "w", encoding="utf-8") as handle:
            json.dump(result, handle, indent=1)
    return 0


def print_ratio(log, joint, alone_s, alone_rms, whole_s, whole_rms):
    """Times aibo-fit on the same log, and prints how many times as long scipy took. None where it cannot be run."""
    numbers = [repr(float(joint[key])) for key in ("inertia", "moment", "coulomb", "viscous")]
    command = ["cargo", "bench", "--quiet", "--bench", "fit", "--", "--estimate", os.path.abspath(log), *numbers]
    try:
        run = subprocess.run(command, cwd=os.path.dirname(os.path.abspath(__file__)), capture_output=True, text=True)
        ours = json.loads(run.stdout.strip().splitlines()[-1])
    except FileNotFoundError:
        print("  ratio skipped: cargo is not installed")
        return None
    except (IndexError, ValueError):
        reason = [line for line in run.stderr.splitlines() if "error" in line or "panicked" in line]
        print(f"  ratio skipped: the bench of aibo-fit did not run: {reason[0] if reason else f'exit code {run.returncode}'}")
        return None
    estimate_s, search_s = ours["estimate_ms"] / 1e3, ours["search_ms"] / 1e3
    print(f"  on one thread each        {'scipy':>10s} {'aibo-fit':>10s}  ratio")
    print(f"  from the nominal start    {alone_s:8.3f} s {ours['estimate_ms']:7.2f} ms  {alone_s / estimate_s:.0f}"
          f"   (RMS {alone_rms:.5f} and {ours['rms_rad']:.5f} rad)")
    print(f"  all starts                {whole_s:8.3f} s {ours['search_ms']:7.2f} ms  {whole_s / search_s:.0f}"
          f"   (RMS {whole_rms:.5f} and {ours['search_rms_rad']:.5f} rad)")
    return {**ours, "single_start_ratio": alone_s / estimate_s, "all_starts_ratio": whole_s / search_s}


def timed(call):
    began = time.perf_counter()
    call()
    return time.perf_counter() - began


if __name__ == "__main__":
    sys.exit(main())
