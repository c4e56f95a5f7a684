#!/usr/bin/env python3
"""Makes walks of dog.xml with a fault of your choice, by MuJoCo (pip install mujoco numpy): python3 make.py delay FOLDER,
or of every fault, each a study in a folder of its own: python3 make.py all FOLDER. MuJoCo's contact and friction are not this
program's: soft, and without sticking."""

import math
import shutil
import sys
from pathlib import Path

import mujoco
import numpy as np

HERE = Path(__file__).parent
PERIOD, STEP, NOISE, RESOLUTION = 0.01, 2e-4, 3e-4, 2 * math.pi / 4096
LEGS = {"fl": 0.0, "fr": 0.5, "rl": 0.5, "rr": 0.0}
STAND_S, RAMP_S = 1.0, 0.8
# Seconds, period of a step, amplitudes of hips and knees; the second is held out.
WALKS = [(5.0, 0.4, 0.1, 0.3), (5.0, 0.35, 0.12, 0.3)]
FAULTS = ["none", "delay", "weak", "limit", "slip", "payload", "zero", "friction"]
KNEES = ["fl_knee", "fr_knee", "rl_knee", "rr_knee"]


def smooth(x):
    x = min(1.0, max(0.0, x))
    return x * x * (3.0 - 2.0 * x)


def setpoint(joint, t, period, hip, knee):
    """As trot.toml has it."""
    s = t - STAND_S
    grown = smooth(s / RAMP_S) if s > 0.0 else 0.0
    phase = (s / period + LEGS[joint[:2]]) % 1.0
    if joint.endswith("hip"):
        return 0.6 + grown * hip * math.sin(2.0 * math.pi * phase)
    at = (phase - 0.25) % 1.0
    bent = smooth(at / 0.25) if at < 0.25 else smooth((0.5 - at) / 0.25)
    return -1.2 - grown * knee * bent


def walk(fault, robot, seconds, period, hip, knee, rng):
    spec = mujoco.MjSpec.from_file(str(robot))
    spec.option.timestep = STEP
    if fault == "payload":
        trunk = spec.body("trunk")
        trunk.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.05, 0, 0], pos=[-0.1, 0, 0.1], mass=1.0, contype=0, conaffinity=0)
    model = spec.compile()
    if fault == "slip":
        model.geom_friction[:, 0] = 0.25
    data = mujoco.MjData(model)
    joints = [model.joint(j).name for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
    angle = {j: model.jnt_qposadr[model.joint(j).id] for j in joints}
    motor = {j: int(np.flatnonzero(model.actuator_trnid[:, 0] == model.joint(j).id)[0]) for j in joints}
    delay = 0.02 if fault == "delay" else 0.0
    zero = {"fl_hip": 0.06} if fault == "zero" else {}
    for j in joints:
        if fault == "weak" and j in KNEES[:2]:
            model.actuator_gainprm[motor[j], 0] *= 0.6
            model.actuator_biasprm[motor[j], :3] *= 0.6
        if fault == "limit" and j in KNEES:
            model.actuator_forcerange[motor[j]] = [-4.0, 4.0]
        if fault == "friction" and j == "rr_knee":
            model.dof_frictionloss[model.jnt_dofadr[model.joint(j).id]] += 0.8
    for j in joints:
        data.qpos[angle[j]] = setpoint(j, 0.0, period, hip, knee) + zero.get(j, 0.0)
    mujoco.mj_forward(model, data)
    balls = [g for g in range(model.ngeom) if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_SPHERE and model.geom_contype[g]]
    data.qpos[2] += 0.02 - min(data.geom_xpos[g][2] - model.geom_size[g][0] for g in balls)
    rows = []
    for k in range(round(seconds / PERIOD) + 1):
        t = k * PERIOD
        row = [t]
        for j in joints:
            reading = data.qpos[angle[j]] - zero.get(j, 0.0) + rng.normal(0.0, NOISE)
            row += [round(reading / RESOLUTION) * RESOLUTION, setpoint(j, t, period, hip, knee)]
        rows.append(row)
        for n in range(round(PERIOD / STEP)):
            # A setpoint is held until the next one comes, and comes late.
            asked = math.floor((t + n * STEP - delay) / PERIOD + 1e-9) * PERIOD
            for j in joints:
                data.ctrl[motor[j]] = setpoint(j, max(0.0, asked), period, hip, knee) + zero.get(j, 0.0)
            mujoco.mj_step(model, data)
    return joints, rows


def write(fault, folder):
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(7)
    for n, walked in enumerate(WALKS):
        joints, rows = walk(fault, HERE / "dog.xml", *walked, rng)
        names = ",".join(f"{j}.q,{j}.q_ref" for j in joints)
        lines = [",".join([f"{row[0]:.2f}", *(f"{value:.5f}" for value in row[1:])]) for row in rows]
        (folder / f"walk-{n}.csv").write_text("\n".join([f"t,{names}", *lines]) + "\n")


def main():
    fault, folder = sys.argv[1], Path(sys.argv[2])
    if fault != "all":
        write(fault, folder)
        return
    for fault in FAULTS:
        write(fault, folder / fault)
        for file in ["dog.xml", "study.toml"]:
            shutil.copy(HERE / file, folder / fault / file)


if __name__ == "__main__":
    main()
