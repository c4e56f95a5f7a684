#!/usr/bin/env python3
"""Makes the example studies of docs/diagnosis.md. Its integrator (symplectic Euler, 20 us, friction by a projection of
the speed) has nothing in common with the program's. Run it in this folder: python3 make.py"""

import math
import random
from pathlib import Path

G, DT = 9.81, 2e-5
JOINT = dict(inertia=0.011, moment=0.05, coulomb=0.02, viscous=0.03)
KP, KD = 8.0, 0.15


def swing(seconds, angle, *, mass=None, setpoint=None, delay=0.0, spring=(0.0, 0.0), offset=0.0):
    """Angles of the joint, every 20 us: a free swing from `angle`, or driven along `setpoint(t)`."""
    inertia, moment = JOINT["inertia"], JOINT["moment"]
    if mass:
        kg, distance, radius, length = mass
        # hollow cylinder across its axis, and the parallel axis
        inertia += kg * (radius**2 / 2 + length**2 / 12 + distance**2)
        moment += kg * distance
    q, w, path = angle, 0.0, []
    for n in range(int(seconds / DT) + 1):
        path.append(q)
        t = n * DT
        torque = -G * moment * math.sin(q + offset) + spring[0] * (spring[1] - q)
        if setpoint:
            torque += KP * (setpoint(max(0.0, t - delay)) - q) - KD * w
        free = w + DT * (torque - JOINT["viscous"] * w) / inertia
        stop = DT * JOINT["coulomb"] / inertia
        w = 0.0 if abs(free) <= stop else free - math.copysign(stop, free)
        q += DT * w
    return path


def write(path, angles, period, step, seed, setpoint=None, noise=0.5):
    """Readings: uniform noise of half a step either way, then rounding (the encoder of Appendix B)."""
    dice = random.Random(seed)
    every = round(period / DT)
    with open(path, "w") as out:
        out.write("t,q,q_ref\n" if setpoint else "t,q\n")
        for k, q in enumerate(angles[::every]):
            reading = round((q + dice.uniform(-noise, noise) * step) / step) * step
            row = f"{k * period:.3f},{reading:.4f}"
            out.write(row + (f",{setpoint(k * period):.7f}\n" if setpoint else "\n"))


def study(folder, logs, step, period, motor=False, nominal=JOINT):
    lines = ["schema = 1", "", "[joint]", 'name = "pendulum"']
    lines += [f"{key} = {value}" for key, value in nominal.items()] + [f"gravity = {G}", "rest = 0.0"]
    lines += ["", "[sensor]", f"resolution = {step}", f"period = {period}"]
    if motor:
        lines += ["", "[motor]", f"kp = {KP}", f"kd = {KD}"]
    for file, role, drive, mass in logs:
        lines += ["", "[[log]]", f'file = "{file}"', f'role = "{role}"', f'drive = "{drive}"']
        if mass:
            lines += ["[log.extra]"] + [f"{k} = {v}" for k, v in zip(("mass", "distance", "radius", "length"), mass)]
    (Path(folder) / "study.toml").write_text("\n".join(lines) + "\n")


def held(f, period=0.008):
    """A setpoint as the log has it: held between its samples."""
    return lambda t: f(math.floor(t / period + 1e-9) * period)


def delay():
    """A pendulum on a chirp; a command delay of 16 ms that the study does not know."""
    Path("delay").mkdir(exist_ok=True)
    chirp = held(lambda t: 0.5 * math.sin(2 * math.pi * (0.2 * t + 0.5 * (3.0 - 0.2) / 10 * t * t)))
    angles = swing(10.0, 0.0, setpoint=chirp, delay=0.016)
    for run in range(10):
        write(f"delay/chirp-{run}.csv", angles, 0.008, 0.006, seed=run, setpoint=chirp)
    study("delay", [("chirp-0.csv", "fit", "position", None)], 0.006, 0.008, motor=True)


def ambiguous():
    """Swings of one load; the angle's zero is off by 0.03 rad. One load cannot tell that from a constant torque."""
    for folder in ("ambiguous", "resolved"):
        Path(folder).mkdir(exist_ok=True)
        logs = []
        for k, angle in enumerate((0.5, 0.6, 0.45, 0.55)):
            file = f"swing-{k}.csv"
            write(f"{folder}/{file}", swing(4.0, angle, offset=0.03), 0.008, 0.006, seed=100 + k)
            logs.append((file, "validate" if k == 3 else "fit", "off", None))
        if folder == "resolved":
            mass = (0.333, 0.300, 0.0, 0.0)
            write(f"{folder}/next.csv", swing(6.0, 2.2, mass=mass, offset=0.03), 0.008, 0.006, seed=110)
            logs.append(("next.csv", "fit", "off", mass))
        study(folder, logs, 0.006, 0.008)


delay()
ambiguous()
