"""The joint that `scipy_fit.py` fits: reading logs and studies, and integrating many of them as one numpy batch."""
import csv
import math
import os
import tomllib

import numpy as np

# Nominal models for sidecars, which carry none: right front leg of the ERS-7 with the masses and inertias of the
# thesis's Tables 3.2 and A.2 and the geometry of A.1 (knee at -0.4363 rad), friction of Table 3.3.
ERS7 = {
    "q1": {"inertia": 5.974e-4, "moment": 5.972e-3, "coulomb": 0.001, "viscous": 0.017},
    "q2": {"inertia": 5.732e-4, "moment": 5.956e-3, "coulomb": 0.007, "viscous": 0.019},
    "q3": {"inertia": 9.11e-5, "moment": 1.62e-3, "coulomb": 0.020, "viscous": 0.010},
}
DIVERGED = 1e3      # residual [rad] given to a trial that is not finite
MAX_STEP_S = 0.010  # no integration step is longer
STEP_RATE = 0.30    # step times the fastest rate of the nominal joint: RK4 errors stay below 1e-6 rad


class BadData(Exception):
    pass


# ------------------------------------------------------------------ reading

def read_csv(path):
    try:
        with open(path, encoding="utf-8-sig", newline="") as handle:
            rows = list(csv.reader(handle))
    except OSError as error:
        raise BadData(f"{path}: {error.strerror}")
    if len(rows) < 3:
        raise BadData(f"{path}: fewer than two samples")
    header = [name.strip() for name in rows[0]]
    columns = {}
    for k, name in enumerate(header):
        if name not in ("t", "q", "dq", "tau", "q_ref", "drive"):
            continue
        try:
            columns[name] = np.array([float(row[k]) for row in rows[1:] if row])
        except (ValueError, IndexError) as error:
            raise BadData(f"{path}: column {name}: {error}")
    for name in ("t", "q"):
        if name not in columns:
            raise BadData(f"{path}: no column {name}")
    if not np.all(np.diff(columns["t"]) > 0):
        raise BadData(f"{path}: t is not strictly increasing")
    return columns


def hollow_cylinder(extra):
    """(inertia, moment) about the joint axis that an extra mass adds."""
    if not extra:
        return 0.0, 0.0
    m, d = extra["mass"], extra["distance"]
    r, length = extra.get("radius", 0.0), extra.get("length", 0.0)
    return 0.5 * m * r * r + m * length * length / 12 + m * d * d, m * d


class Log:
    """One log: samples after release and the input of every integration step."""

    def __init__(self, folder, entry, motor, until):
        self.file, self.role = entry["file"], entry.get("role", "fit")
        self.drive, self.extra = entry.get("drive", "off"), entry.get("extra")
        path = os.path.join(folder, self.file)
        c = read_csv(path)
        t, q = c["t"], c["q"]
        n = len(t)
        on = c.get("drive", np.ones(n)) > 0.5
        first, self.held = 0, None
        if self.drive == "off" and "drive" in c and on[0]:
            first = int(np.argmin(on))
            if on[first]:
                raise BadData(f"{path}: held all the time")
            if on[first:].any():
                raise BadData(f"{path}: held again after the release")
            self.held = (t[first - 1], t[first], float(np.mean(q[max(0, first - 40):first])))
        self.t0 = t[first]
        last = n if until is None else int(np.searchsorted(t, t[first] + until, side="right"))
        keep = slice(first, last)
        self.t, self.q, self.on = t[keep], q[keep], on[keep]
        self.n = len(self.t)
        if self.n < 8:
            raise BadData(f"{path}: fewer than 8 samples to fit")
        self.motor = {**motor, **entry.get("motor", {})}
        self.tau = self.ref = None
        if self.drive == "torque":
            if "tau" not in c:
                raise BadData(f"{path}: drive is torque, but there is no column tau")
            self.tau = np.where(self.on, c["tau"][keep], 0.0)
        elif self.drive == "position":
            if "q_ref" not in c:
                raise BadData(f"{path}: drive is position, but there is no column q_ref")
            self.ref = c["q_ref"][keep]
            if self.motor.get("ki") or self.motor.get("sample_period"):
                raise BadData(f"{path}: ki and sample_period are not supported by this baseline")
        elif self.drive != "off":
            raise BadData(f"{path}: unknown drive {self.drive}")
        k = min(self.n, 9)  # speed of the first samples, a start only
        self.start = (float(self.q[0]), float(np.polyfit(self.t[:k] - self.t[0], self.q[:k], 1)[0]))
        if self.held:
            self.start = (self.held[2], 0.5 * (self.held[0] + self.held[1]))

    def steps(self, joint, refine):
        """Input of each integration step: rows h, u0, u1, kp, kd, limit, speed limit; and the sample each ends."""
        extra_i, extra_m = hollow_cylinder(self.extra)
        inertia, moment = joint["inertia"] + extra_i, joint["moment"] + extra_m
        kp = self.motor.get("kp", 0.0) if self.ref is not None else 0.0
        kd = self.motor.get("kd", 0.0) if self.ref is not None else 0.0
        rate = max(math.sqrt((kp + joint["gravity"] * moment) / inertia), (kd + joint["viscous"]) / inertia)
        longest = min(MAX_STEP_S, STEP_RATE / rate)
        linear = self.motor.get("hold", "step") == "linear"
        on_error = self.motor.get("derivative", "measurement") == "error"
        limit = self.motor.get("torque_limit", math.inf) if self.ref is not None else math.inf
        speed = self.motor.get("speed_limit", math.inf) if self.ref is not None else math.inf
        rows, end = [[0.0, 0, 0, 0, 0, math.inf, math.inf]], [0]  # step 0: release to first sample, motor off
        for k in range(self.n - 1):
            span = self.t[k + 1] - self.t[k]
            m = refine * max(1, math.ceil(span / longest - 1e-9))
            for j in range(m):
                u0 = u1 = 0.0
                p = d = 0.0
                if self.tau is not None:
                    u0 = self.tau[k]
                elif self.ref is not None and self.on[k]:
                    p, d = kp, kd
                    slope = (self.ref[k + 1] - self.ref[k]) / span if linear else 0.0
                    u0, u1 = kp * (self.ref[k] + slope * span * j / m), kp * slope
                    if on_error:
                        u0 += kd * slope
                rows.append([span / m, u0, u1, p, d, limit, speed])
            end.append(len(rows) - 1)
        return np.array(rows).T, np.array(end)


class Study:
    def __init__(self, path, until):
        with open(path, "rb") as handle:
            text = tomllib.load(handle)
        self.name = path
        self.joint = dict(text["joint"])
        self.sensor = text.get("sensor", {})
        folder = os.path.dirname(path)
        self.logs = [Log(folder, entry, text.get("motor", {}), until) for entry in text["log"]]


class Sidecars(Study):
    """Single logs with their sidecars, taken as one study; the nominal model is the ERS-7's."""

    def __init__(self, paths, until, nominal):
        self.name, self.logs, self.sensor, self.joint = " ".join(paths), [], {}, None
        for path in paths:
            sidecar = os.path.splitext(path)[0] + ".toml"
            try:
                with open(sidecar, "rb") as handle:
                    text = tomllib.load(handle)
            except OSError:
                text = {"joint": {}, "log": [{"drive": "off"}]}
            entry = dict(text["log"][0])
            entry["file"], entry["role"] = os.path.basename(path), "fit"
            self.logs.append(Log(os.path.dirname(path), entry, text.get("motor", {}), until))
            self.sensor = text.get("sensor", self.sensor)
            if self.joint is None:
                self.joint = dict(text.get("joint", {}))
        self.joint.setdefault("gravity", 9.81)
        base = ERS7.get(self.joint.get("name"))
        if nominal:
            with open(nominal, "rb") as handle:
                base = tomllib.load(handle)["joint"]
        if base is None:
            raise BadData(f"joint {self.joint.get('name')!r} has no nominal model here: give --nominal STUDY.toml")
        for key in ("inertia", "moment", "coulomb", "viscous"):
            self.joint.setdefault(key, base[key])


# ------------------------------------------------------------------ the joint

class Batch:
    """Integrates many (log, parameters) rows at once. A row is one column of a finite-difference Jacobian."""

    def __init__(self, logs, joint, refine=1):
        inputs, self.ends = zip(*[log.steps(joint, refine) for log in logs])
        self.count = max(x.shape[1] for x in inputs)
        self.input = np.zeros((self.count, 7, len(logs)))
        self.input[:, 5:, :] = math.inf
        for k, x in enumerate(inputs):
            self.input[:x.shape[1], :, k] = x.T
        self.driven = bool(np.any(self.input[:, 3, :] != 0))
        self.limited = bool(np.any(np.isfinite(self.input[:, 5, :])))
        self.varying = bool(np.any(self.input[:, 2, :] != 0))
        self.lengths = np.array([x.shape[1] for x in inputs])

    def run(self, which, inertia, gm, mu_c, mu_v, rest, q, v, first):
        """Angle after each step, [step, row]. `which`: log of each row; `first`: length of step 0."""
        order = np.argsort(-self.lengths[which], kind="stable")  # long logs first: finished rows are cut off
        which = which[order]
        p = np.stack([1 / inertia, gm / inertia, mu_c / inertia, mu_v / inertia, rest])[:, order]
        q, v, first = q[order].copy(), v[order].copy(), first[order]
        side = np.sign(v)
        out = np.empty((self.count, len(q)))
        alive = len(q)
        length = self.lengths[which]
        for k in range(self.count):
            if length[alive - 1] <= k:
                alive = int(np.searchsorted(-length, -k, side="left"))
                p, which = p[:, :alive], which[:alive]
                q, v, side = q[:alive], v[:alive], side[:alive]
            u = self.input[k][:, which]
            if k == 0:
                u[0] = first
            q, v, side = self.step(p, u, q, v, side)
            out[k, :alive] = q
        back = np.empty_like(order)
        back[order] = np.arange(len(order))
        return out[:, back]

    def torque(self, p, u, q, v, t):
        """Everything but Coulomb friction, over the inertia."""
        inv, gmi, _, mvi, rest = p
        if self.driven:
            drive = u[1] + u[2] * t - u[3] * q - u[4] * v
            if self.limited:
                cap = np.where(drive * v > 0, u[5] * np.clip(1 - np.abs(v) / u[6], 0, 1), u[5])
                drive = np.clip(drive, -cap, cap)
        else:
            drive = u[1]
        return drive * inv - gmi * np.sin(q - rest) - mvi * v

    def rk4(self, p, u, q, v, side, t, h):
        f = side * p[2]
        half = 0.5 * h
        a1 = self.torque(p, u, q, v, t) - f
        v2 = v + half * a1
        a2 = self.torque(p, u, q + half * v, v2, t + half) - f
        v3 = v + half * a2
        a3 = self.torque(p, u, q + half * v2, v3, t + half) - f
        v4 = v + h * a3
        a4 = self.torque(p, u, q + h * v3, v4, t + h) - f
        return q + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)

    def step(self, p, u, q, v, side):
        """One step. `side` is the sign of the speed, 0 while stuck. Events inside the step restart the row."""
        h = u[0]
        idle = side == 0
        if not idle.any():
            q1, v1 = self.rk4(p, u, q, v, side, 0.0, h)
            flip = side * v1 < 0
            if not flip.any():
                return q1, v1, side
            rows, at = np.flatnonzero(flip), None
            side = side.copy()
        else:
            side = side.copy()
            net = self.torque(p, u, q, 0.0, 0.0)
            go = idle & (np.abs(net) > p[2])
            if self.varying:
                later = self.torque(p, u, q, 0.0, h)
                go |= idle & (np.abs(later) > p[2])
            move = ~idle
            q1, v1 = q.copy(), v.copy()
            if move.any():
                qm, vm = self.rk4(p, u, q, v, side, 0.0, h)
                q1[move], v1[move] = qm[move], vm[move]
            flip = move & (side * v1 < 0)
            rows = np.flatnonzero(flip | go)
            if not len(rows):
                return q1, v1, side
            at = np.where(idle[rows], 0.0, -1.0)
        # rows in which something happens: follow each from event to event
        pr, ur, hr = p[:, rows], u[:, rows], h[rows]
        qr, vr, sr = q[rows], v[rows], side[rows]
        tr = np.zeros(len(rows))
        qe, ve = q1[rows], v1[rows]
        pending = np.ones(len(rows), bool)
        for _ in range(8):
            w = np.flatnonzero(pending)
            if not len(w):
                break
            pw, uw, hw = pr[:, w], ur[:, w], hr[w]
            stuck = sr[w] == 0
            if stuck.any():
                net = self.torque(pw, uw, qr[w], 0.0, tr[w])
                later = self.torque(pw, uw, qr[w], 0.0, hw) if self.varying else net
                now = stuck & (np.abs(net) > pw[2])
                soon = stuck & ~now & (np.abs(later) > pw[2])
                stay = stuck & ~now & ~soon
                sr[w[now]] = np.sign(net[now])
                if soon.any():  # the input is linear in time: break-away instant in closed form
                    sign = np.sign(later[soon])
                    part = (sign * pw[2][soon] - net[soon]) / (later[soon] - net[soon])
                    tr[w[soon]] += part * (hw[soon] - tr[w[soon]])
                    sr[w[soon]] = sign
                done = w[stay]
                qe[done], ve[done], pending[done] = qr[done], 0.0, False
                w = w[~stay]
                if not len(w):
                    continue
                pw, uw, hw = pr[:, w], ur[:, w], hr[w]
            left = hw - tr[w]
            q2, v2 = self.rk4(pw, uw, qr[w], vr[w], sr[w], tr[w], left)
            back = sr[w] * v2 < 0
            fine = w[~back]
            qe[fine], ve[fine], pending[fine] = q2[~back], v2[~back], False
            if back.any():
                b = w[back]
                x, q3 = self.turn(pr[:, b], ur[:, b], qr[b], vr[b], sr[b], tr[b], left[back], v2[back])
                qr[b], vr[b], sr[b] = q3, 0.0, 0.0
                tr[b] += x
                qe[b], ve[b] = q3, 0.0
        q1[rows], v1[rows], side[rows] = qe, ve, sr
        return q1, v1, side

    def turn(self, p, u, q, v, side, t, span, v_end):
        """Instant in (0, span) at which the speed is zero: Newton on v with bisection as a guard."""
        low, high = np.zeros_like(span), span.copy()
        x = span * np.clip(np.abs(v) / np.maximum(np.abs(v) + np.abs(v_end), 1e-300), 0.0, 1.0)
        x = np.where(v == 0, 0.5 * span, x)
        for _ in range(12):
            qx, vx = self.rk4(p, u, q, v, side, t, x)
            past = side * vx < 0
            high = np.where(past, x, high)
            low = np.where(past, low, x)
            acc = self.torque(p, u, qx, vx, t + x) - side * p[2]
            with np.errstate(divide="ignore", invalid="ignore"):
                new = x - vx / acc
            new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
            moved = np.abs(new - x)
            x = new
            if np.all(moved <= 1e-15 + 1e-13 * span):
                break
        qx, _ = self.rk4(p, u, q, v, side, t, x)
        return x, qx
