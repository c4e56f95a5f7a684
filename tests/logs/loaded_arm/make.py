"""Makes the arm and the logs of this folder: pip install mujoco numpy; python make.py

MuJoCo simulates the arm with a payload that `arm.xml` does not have, by steps of 0.05 ms and with friction that hardly creeps;
`arm.xml` has masses that are off by 2 % and friction by 10 % (standard deviations).
"""

import mujoco
import numpy as np

PAYLOAD_KG, PAYLOAD_X_M = 0.3, 0.012
PERIOD_S, LENGTH_S, NOISE_RAD, STEP_RAD = 0.02, 8, 4e-4, 2 * np.pi / 4096
STIFF = 'solreffriction="0.0004 1" solimpfriction="0.999 0.9999 0.0001" '


def links(rng):
    """Two links on their servos."""
    arm = []
    for k in range(2):
        length, mass = rng.uniform(0.15, 0.35), rng.uniform(0.3, 1.2) * 0.7**k
        centre, beside = length * rng.uniform(0.35, 0.6), rng.uniform(-0.02, 0.02)
        coulomb, viscous = rng.uniform(0.02, 0.06) * (2 - k), rng.uniform(0.05, 0.15) * (2 - k)
        armature = rng.uniform(0.004, 0.012) * (2 - k)
        arm.append(dict(length=length, mass=mass, centre=centre, beside=beside, coulomb=coulomb, viscous=viscous, armature=armature))
    for k, link in enumerate(arm):
        beyond = 0.6 * sum(other["length"] for other in arm[k:])
        mass = sum(other["mass"] for other in arm[k:])
        link["kp"] = mass * 9.81 * beyond / rng.uniform(0.08, 0.25)
        link["kv"] = 2 * rng.uniform(0.5, 1.0) * np.sqrt(link["kp"] * (mass * beyond**2 + link["armature"])) * 0.5
    return arm


def mjcf(arm, step_s=0.0005, payload=None):
    """The arm as MuJoCo has it."""
    text = f'<mujoco model="arm"><option timestep="{step_s}" integrator="implicitfast"/><worldbody>'
    text += '<body name="base"><geom type="box" size=".05 .05 .05" mass="1"/>'
    at = 0.1
    for k, link in enumerate(arm):
        inertia = link["mass"] * link["length"] ** 2 / 12
        text += f'<body name="link{k}" pos="0 0 {at:.4f}"><joint name="j{k}" type="hinge" axis="0 1 0" damping="{link["viscous"]:.4f}" '
        text += f'{STIFF if step_s < 1e-4 else ""}frictionloss="{link["coulomb"]:.4f}" armature="{link["armature"]:.5f}"/>'
        text += f'<inertial pos="{link["beside"]:.4f} 0 {link["centre"]:.4f}" mass="{link["mass"]:.4f}" '
        text += f'diaginertia="{inertia:.6f} {inertia:.6f} {inertia / 10:.6f}"/>'
        at = link["length"]
    if payload:
        text += f'<body pos="{payload[1]:.4f} 0.0000 {payload[2]:.4f}"><inertial pos="0 0 0" mass="{payload[0]:.4f}" diaginertia="1e-5 1e-5 1e-5"/></body>'
    text += "</body>" * len(arm) + "</body></worldbody><actuator>"
    for k, link in enumerate(arm):
        text += f'<position name="a{k}" joint="j{k}" kp="{link["kp"]:.4f}" kv="{link["kv"]:.4f}"/>'
    return text + "</actuator></mujoco>"


def log(xml, motion, rng):
    """Time, readings and setpoints of a motion."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    far, slow, at, fast = rng.uniform(0.4, 0.9, 2), rng.uniform(0.1, 0.25, 2), rng.uniform(0, 6.28, 2), rng.uniform(0.4, 0.8, 2)
    held, asked, rows = np.zeros(2), [], []
    times = np.arange(0, LENGTH_S, PERIOD_S)
    for k, t in enumerate(times):
        if motion == "chirp":
            asked.append(far * (np.sin(2 * np.pi * (slow * t + fast * t * t / LENGTH_S) + at) - np.sin(at)))
        elif motion == "steps":
            held = rng.uniform(-0.8, 0.8, 2) if k % int(0.9 / PERIOD_S) == 0 else held
            asked.append(held)
        else:
            asked.append(1.2 * far * (np.sin(2 * np.pi * slow * t + at) - np.sin(at)) + 0.3 * np.sin(2 * np.pi * 3.1 * slow * t))
    for t, setpoint in zip(times, asked):
        read = np.round((data.qpos + rng.normal(0, NOISE_RAD, 2)) / STEP_RAD) * STEP_RAD
        rows.append([t, *read, *setpoint])
        data.ctrl[:] = setpoint
        for _ in range(round(PERIOD_S / model.opt.timestep)):
            mujoco.mj_step(model, data)
    return rows


def main():
    rng = np.random.default_rng(7)
    arm = links(rng)
    believed = [dict(link) for link in arm]
    for link in believed:
        link["mass"] *= 1 + rng.normal(0, 0.02)
        link["coulomb"] *= 1 + rng.normal(0, 0.1)
        link["viscous"] *= 1 + rng.normal(0, 0.1)
    with open("arm.xml", "w") as file:
        file.write(mjcf(believed))
    true = mjcf(arm, 0.00005, (PAYLOAD_KG, PAYLOAD_X_M, 1.05 * arm[-1]["length"]))
    for name, motion in [("chirp", "chirp"), ("steps", "steps"), ("held", "slow")]:
        with open(f"{name}.csv", "w") as file:
            file.write("t,j0.q,j1.q,j0.q_ref,j1.q_ref\n")
            for row in log(true, motion, rng):
                file.write(f"{row[0]:.2f}," + ",".join(f"{value:.5f}" for value in row[1:]) + "\n")


main()
