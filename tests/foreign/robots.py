#!/usr/bin/env python3
"""Studies of an ERS-7 that MuJoCo moves (pip install numpy mujoco): 22 of them, in the air, walking on a floor, and with a leg
that is let go. See README.md beside this file.

    python3 robots.py ERS7.XML DIR [--seed S] [--only N,N...]
"""
import argparse
import json
import math
import re
from pathlib import Path

import mujoco
import numpy as np

LEGS = ("lf", "rf", "lr", "rr")
KNEES, SHOULDERS = [leg + "3" for leg in LEGS], [leg + "1" for leg in LEGS]
JOINTS = [leg + n for leg in LEGS for n in "123"]
# Controllers of the other joints, which stand still, and the springs of the ears.
HELD = {"neck_tilt1": (2.5, 1.0), "neck_pan": (2.0, 2.0), "neck_tilt2": (2.0, 1.0), "mouth": (2.0, 2.0), "tail_tilt": (2.5, 2.0),
        "tail_pan": (2.5, 2.0), **dict.fromkeys(("ear_l_tilt", "ear_l_pan", "ear_r_tilt", "ear_r_pan"), (0.01, 1e-4))}
MOUTH_RAD = -0.0524
PERIOD_S, RESOLUTION_RAD = 0.008, 0.006
# A joint that friction holds creeps at this speed [rad/s].
CREEP = 2e-4
BELIEVED = {"1": (0.001, 0.017), "2": (0.007, 0.019), "3": (0.010, 0.010)}
GAINS = {"1": (5.0, 0.5), "2": (7.0, 0.5), "3": (7.0, 0.5)}
FLOOR = {"static": 0.7, "coulomb": 0.6, "slope": 0.0, "stiffness": 2e4}

# Scenario, causes as the program calls them with their joints ("" for what is on no joint), and what is done to the robot.
PLAN = [
    ("air", [], {}),
    ("air", [], {"correlated": 0.0015}),
    ("air", [("delay", JOINTS)], {"delay": (JOINTS, 0.014)}),
    ("air", [("backlash", ["rr1"])], {"play": ("rr1", 0.06)}),
    ("air", [("torque_limit", KNEES)], {"limit": (KNEES, 0.03)}),
    ("air", [("viscous", ["rf3"])], {"viscous": (["rf3"], 0.20)}),
    ("air", [("angle_offset", ["lf1"])], {"zero": ("lf1", 0.15)}),
    ("air", [("motor_gain", SHOULDERS)], {"gain": (SHOULDERS, 0.3)}),
    ("air", [("stribeck", ["lr2"])], {"static": (["lr2"], 0.12, 0.15)}),
    ("air", [("delay", JOINTS), ("coulomb", ["lf3"])], {"delay": (JOINTS, 0.012), "coulomb": (["lf3"], 0.2)}),
    ("drop", [], {"released": "lf1"}),
    ("drop", [("coulomb", ["rf1"])], {"released": "rf1", "coulomb": (["rf1"], 0.006)}),
    ("drop", [("stribeck", ["lr1"])], {"released": "lr1", "static": (["lr1"], 0.012, 0.25)}),
    ("drop", [("joint_spring", ["lf1"])], {"released": "lf1", "cable": ("lf1", 0.03)}),
    ("floor", [], {}),
    ("floor", [("payload", "")], {"payload": (0.3, (0.0, 0.06, 0.05))}),
    ("floor", [("floor_friction", "")], {"floor": {"static": 0.3, "coulomb": 0.22}}),
    ("floor", [("floor_slope", "")], {"floor": {"slope": 0.06}}),
    ("floor", [("delay", JOINTS)], {"delay": (JOINTS, 0.016)}),
    ("floor", [("motor_gain", ["lf3", "rf3"])], {"gain": (["lf3", "rf3"], 0.65)}),
    ("floor", [("angle_offset", ["rr1"])], {"zero": ("rr1", 0.06)}),
    ("floor", [("torque_limit", KNEES)], {"limit": (KNEES, 0.35)}),
]


def smooth(x):
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def walk(seconds, stand_s, period_s, a1, a2, a3):
    """Setpoints of the twelve joints at the period of the controller: the reference walk of the conventions."""
    t = PERIOD_S * np.arange(round(seconds / PERIOD_S) + 1)
    s = t - stand_s
    grown = smooth(s / 0.5)
    columns = []
    for leg in LEGS:
        phi = 2.0 * math.pi * s / period_s + (0.0 if leg in ("lf", "rr") else math.pi)
        forward = 1.0 if leg[1] == "f" else -1.0
        columns += [-0.30 + forward * grown * a1 * np.sin(phi), 0.10 + grown * a2 * np.cos(phi), 0.10 + grown * a3 * np.cos(phi)]
    return t, np.array(columns).T


def raised(seconds, released, angle):
    t = PERIOD_S * np.arange(round(seconds / PERIOD_S) + 1)
    asked = np.zeros((len(t), len(JOINTS)))
    asked[:, JOINTS.index(released)] = angle
    return t, asked


class Robot:
    """One robot with its faults; masses and friction are off by what its owner cannot know."""

    def __init__(self, xml, scenario, fault, rng):
        text = xml if scenario == "floor" else xml.replace('<freejoint name="base"/>', "")
        if "payload" in fault:
            mass, (x, y, z) = fault["payload"]
            load = f'<body pos="{x} {y} {z}"><inertial pos="0 0 0" mass="{mass}" diaginertia="1e-4 1e-4 1e-4"/></body>'
            text = re.sub(r'(<body name="lf_shoulder")', load + r"\1", text, count=1)
        self.model = model = mujoco.MjModel.from_xml_string(text)
        model.opt.timestep = self.step = 5e-5 if scenario == "floor" else 1e-4
        model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        off = 1.0 + 0.03 * rng.standard_normal(model.nbody)
        model.body_mass *= off
        model.body_inertia *= off[:, None]
        self.floor = {**FLOOR, **fault.get("floor", {})}
        slope = self.floor["slope"]
        model.opt.gravity[:] = [0.0, -9.81 * math.cos(slope), 9.81 * math.sin(slope)]
        self.data = mujoco.MjData(model)
        self.dof = np.array([model.jnt_dofadr[model.joint(j).id] for j in JOINTS])
        self.pos = np.array([model.jnt_qposadr[model.joint(j).id] for j in JOINTS])
        self.feet = [model.body(leg + "_lower").id for leg in LEGS]
        self.radii = [model.geom_size[model.geom(leg + "_lower").id].copy() for leg in LEGS]
        n = len(JOINTS)
        at = JOINTS.index
        friction = np.array([BELIEVED[j[2]] for j in JOINTS]) * rng.uniform(0.8, 1.25, (n, 2))
        self.coulomb, self.viscous = friction[:, 0], friction[:, 1]
        self.static, self.stribeck = np.zeros(n), np.ones(n)
        self.kp, self.kd = np.array([GAINS[j[2]] for j in JOINTS]).T.copy()
        self.limit, self.zero, self.delay, self.cable = np.full(n, np.inf), np.zeros(n), np.zeros(n), np.zeros(n)
        for joint in fault.get("coulomb", ([], 0))[0]:
            self.coulomb[at(joint)] = fault["coulomb"][1]
        for joint in fault.get("viscous", ([], 0))[0]:
            self.viscous[at(joint)] = fault["viscous"][1]
        for joint in fault.get("static", ([], 0))[0]:
            self.static[at(joint)], self.stribeck[at(joint)] = fault["static"][1:]
        for joint in fault.get("limit", ([], 0))[0]:
            self.limit[at(joint)] = fault["limit"][1]
        for joint in fault.get("delay", ([], 0))[0]:
            self.delay[at(joint)] = fault["delay"][1]
        for joint in fault.get("gain", ([], 0))[0]:
            self.kp[at(joint)] *= fault["gain"][1]
            self.kd[at(joint)] *= fault["gain"][1]
        if "zero" in fault:
            self.zero[at(fault["zero"][0])] = fault["zero"][1]
        if "cable" in fault:
            self.cable[at(fault["cable"][0])] = fault["cable"][1]
        self.play = (at(fault["play"][0]), fault["play"][1]) if "play" in fault else None
        self.released = at(fault["released"]) if "released" in fault else None
        for name, (stiffness, damping) in HELD.items():
            joint = model.joint(name).id
            model.jnt_stiffness[joint], model.dof_damping[model.jnt_dofadr[joint]] = stiffness, damping
        model.qpos_spring[model.jnt_qposadr[model.joint("mouth").id]] = MOUTH_RAD

    def lowest(self, foot, radii):
        turn = self.data.xmat[foot].reshape(3, 3)
        down = radii * radii * -turn[1]
        return turn @ (down / math.sqrt(-(down @ turn[1]))) + self.data.xpos[foot]

    def touch(self):
        """Eqs 2.3 to 2.5 on the lowest point of every lower leg."""
        velocity = np.zeros(6)
        for foot, radii in zip(self.feet, self.radii):
            self.data.xfrc_applied[foot] = 0.0
            if self.data.xpos[foot][1] > radii[1]:
                continue
            point = self.lowest(foot, radii)
            deep = -point[1]
            if deep <= 0.0:
                continue
            arm = point - self.data.xpos[foot]
            mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_BODY, foot, velocity, 0)
            moves = velocity[3:] + np.cross(velocity[:3], arm)
            normal = max(0.0, self.floor["stiffness"] * deep - 4e5 * deep * moves[1])
            slides = math.hypot(moves[0], moves[2])
            static, coulomb = self.floor["static"], self.floor["coulomb"]
            friction = coulomb + (static * math.tanh(300.0 * slides) - coulomb) * math.exp(-((slides / 0.05) ** 2))
            along = -normal * friction / max(slides, 1e-9)
            force = np.array([along * moves[0], normal, along * moves[2]])
            self.data.xfrc_applied[foot, :3] = force
            self.data.xfrc_applied[foot, 3:] = np.cross(arm, force)

    def start(self, asked, drop_m):
        data = self.data
        mujoco.mj_resetData(self.model, data)
        data.qpos[self.pos] = asked + self.zero
        data.qpos[self.model.jnt_qposadr[self.model.joint("mouth").id]] = MOUTH_RAD
        mujoco.mj_forward(self.model, data)
        if drop_m is not None:
            data.qpos[1] += drop_m - min(self.lowest(foot, radii)[1] for foot, radii in zip(self.feet, self.radii))

    def run(self, t, asked, drop_m, release_s, correlated, rng):
        """Readings of the twelve joints at the stamps."""
        self.start(asked[0], drop_m)
        model, data, h = self.model, self.data, self.step
        per = round(PERIOD_S / h)
        kp, kd = self.kp.copy(), self.kd.copy()
        rotor = {"at": 0.0, "speed": 0.0, "inertia": 3e-4}
        if self.play:
            rotor["at"] = data.qpos[self.pos[self.play[0]]]
        ahead = np.vstack([asked, asked[-1:]])
        columns, late = np.arange(len(JOINTS)), self.delay.any()
        readings, drift = [], np.zeros(len(JOINTS))
        keeps = math.exp(-PERIOD_S / 0.06)
        for k, stamp in enumerate(t):
            drift = keeps * drift + math.sqrt(1.0 - keeps**2) * correlated * rng.standard_normal(len(JOINTS))
            reading = data.qpos[self.pos] - self.zero + drift + 0.001 * rng.standard_normal(len(JOINTS))
            readings.append(np.round(reading / RESOLUTION_RAD) * RESOLUTION_RAD)
            if release_s is not None and stamp >= release_s - 1e-9:
                kp[self.released] = kd[self.released] = 0.0
            for n in range(per):
                if n == 0 or late:
                    place = np.clip(k + n / per - self.delay / PERIOD_S, 0.0, len(t) - 1.0)
                    left = place.astype(int)
                    here, there = ahead[left, columns], ahead[left + 1, columns]
                    want, rate = here + (place - left) * (there - here), (there - here) / PERIOD_S
                else:
                    want = want + h * rate
                angle, speed = data.qpos[self.pos], data.qvel[self.dof]
                spring = kp * (want - angle + self.zero) + kd * rate
                torque = spring - kd * speed
                held = np.abs(torque) > self.limit
                size = self.coulomb + self.static * np.exp(-((speed / self.stribeck) ** 2))
                damping = self.viscous + size / np.sqrt(speed**2 + CREEP**2)
                applied = np.where(held, np.clip(torque, -self.limit, self.limit), spring) - self.cable * (angle - 0.6)
                implicit = damping + np.where(held, 0.0, kd)
                if self.play:
                    # The motor's side of a joint with play, which carries its friction.
                    j, width = self.play
                    apart = rotor["at"] - angle[j]
                    over = apart - math.copysign(min(abs(apart), width / 2), apart)
                    push = 300.0 * over + (0.3 * (rotor["speed"] - speed[j]) if over else 0.0)
                    push = push if push * over > 0.0 else 0.0
                    rotor["speed"] = (rotor["inertia"] * rotor["speed"] + h * (torque[j] - push)) / (rotor["inertia"] + h * damping[j])
                    rotor["at"] += h * rotor["speed"]
                    applied[j], implicit[j] = push, 0.1 * self.viscous[j]
                data.qfrc_applied[self.dof] = applied
                model.dof_damping[self.dof] = implicit
                mujoco.mj_step1(model, data)
                if drop_m is not None:
                    self.touch()
                mujoco.mj_step2(model, data)
        return np.array(readings)


def study(folder, xml, scenario, fault, rng):
    folder.mkdir(parents=True, exist_ok=True)
    robot = Robot(xml, scenario, fault, rng)
    text = f'schema = 1\n\n[robot]\nmodel = "ers7"\nscenario = "{scenario}"\n'
    if scenario == "floor":
        text += "drop_height = 0.02\n\n[floor]\nstiffness = 2.0e4\ndamping = 4.0e5\nexponent = 1.0\nstatic = 0.7\ncoulomb = 0.6\n"
        text += "viscous = 0.0\nsteepness = 300.0\nstribeck_speed = 0.05\n"
    text += f"\n[sensor]\nresolution = {RESOLUTION_RAD}\nperiod = {PERIOD_S}\nnoise = 0.001\n"
    swing = {"floor": (0.115, 0.05, 0.15), "air": (0.35, 0.2, 0.4)}.get(scenario)
    for k, (role, period_s, more) in enumerate([("fit", 1.0, 1.0), ("validate", 0.8, 0.8)]):
        release_s = None
        if scenario == "drop":
            release_s = 0.5
            t, asked = raised(4.0, fault["released"], 1.0 * more)
        else:
            t, asked = walk(6.0, 1.5 if scenario == "floor" else 0.5, period_s, *(more * a for a in swing))
        q = robot.run(t, asked, 0.02 if scenario == "floor" else None, release_s, fault.get("correlated", 0.0), rng)
        head = ["t"] + [f"{j}.{c}" for j in JOINTS for c in ("q", "q_ref")]
        rows = np.column_stack([t] + [c[:, j] for j in range(len(JOINTS)) for c in (q, asked)])
        lines = [",".join(head)] + [",".join(f"{value:.6f}" for value in row) for row in rows]
        (folder / f"log-{k}.csv").write_text("\n".join(lines) + "\n")
        text += f'\n[[log]]\nfile = "log-{k}.csv"\nrole = "{role}"\n'
        if scenario == "drop":
            text += f'released = "{fault["released"]}"\nrelease_time = {release_s}\n'
    (folder / "study.toml").write_text(text)


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("robot", type=Path, help="ers7.xml")
    ap.add_argument("folder", type=Path)
    ap.add_argument("--seed", type=int, default=20000)
    ap.add_argument("--only", default="", help="numbers of studies, separated by commas")
    a = ap.parse_args()
    chosen = a.only.split(",") if a.only else None
    truth = {}
    for k, (scenario, causes, fault) in enumerate(PLAN):
        key = f"r{k:02}"
        truth[key] = {"scenario": scenario, "causes": [cause for cause, _ in causes], "joints": [list(on) for _, on in causes]}
        if chosen and str(k) not in chosen:
            continue
        study(a.folder / key, a.robot.read_text(), scenario, fault, np.random.default_rng(a.seed + k))
        print(key, scenario, fault, flush=True)
    (a.folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")


if __name__ == "__main__":
    main()
