"""Ten seconds of the reference walk: MuJoCo with its own contact beside `cargo bench --bench walk`, one core each.

MuJoCo gets the same robot (`ers7/ers7.xml` in the folder that AIBO_FIT_SHARED names), a plane under its lower legs with the
walk's sliding friction, gains of Table B.2 as position actuators (derivative on the measurement, no integral), friction of
Table 3.4, and the same setpoints at every step; all steps are one call into its C code (`mujoco.rollout`). Its contact model
is another one, so it goes elsewhere: displacements stand beside the times.
"""
import csv
import os
import pathlib
import re
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DURATION_S = 10.0
STEP_S = 1e-3
FRICTION = {"1": (0.001, 0.017), "2": (0.007, 0.019), "3": (0.010, 0.010)}  # N m, N m s/rad
GAINS = {"1": (5.0, 0.5), "2": (7.0, 0.5), "3": (7.0, 0.5), "neck_tilt1": (2.5, 1.0), "neck_pan": (2.0, 2.0),
         "neck_tilt2": (2.0, 1.0), "tail_tilt": (2.5, 2.0), "tail_pan": (2.5, 2.0), "mouth": (2.0, 2.0)}  # N m/rad, N m s/rad
SPRINGS = (0.01, 1e-4)  # the ears'
REST = {"mouth": -0.0524}
LEGS = [leg + number for leg in ("lf", "rf", "lr", "rr") for number in "123"]
SLIDING = 0.6
GOES = 5


def kind(name):
    return name[2] if name in LEGS else name


def model_of(mujoco, path):
    spec = mujoco.MjSpec.from_file(str(path))
    spec.option.timestep = STEP_S
    spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    spec.option.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    spec.worldbody.add_geom(name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[5, 5, 0.1], friction=[SLIDING, 0.005, 0.0001],
                            quat=[0.5 ** 0.5, -(0.5 ** 0.5), 0, 0], contype=2, conaffinity=1)
    for geom in spec.geoms:
        if geom.name.endswith("_lower"):
            geom.contype, geom.conaffinity, geom.friction = 1, 2, [SLIDING, 0.005, 0.0001]
    names = []
    for joint in spec.joints:
        if joint.name == "base":
            continue
        if joint.name in LEGS:
            joint.frictionloss, joint.damping = FRICTION[kind(joint.name)][0], [FRICTION[kind(joint.name)][1], 0, 0]
        kp, kd = GAINS.get(kind(joint.name), SPRINGS)
        actuator = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.gaintype, actuator.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
        actuator.gainprm[0] = kp
        actuator.biasprm[:3] = [0, -kp, -kd]
        names.append(joint.name)
    return spec.compile(), names


def by_mujoco():
    """Times real time (the best of some goes), displacement [m], version."""
    import mujoco
    import numpy as np
    from mujoco import rollout
    folder = pathlib.Path(os.environ["AIBO_FIT_SHARED"]) / "ers7"
    model, names = model_of(mujoco, folder / "ers7.xml")
    with open(folder / "trot-setpoints.csv", encoding="utf-8") as handle:
        rows = list(csv.DictReader(handle))
    t = np.array([float(row["t"]) for row in rows])
    steps = round(DURATION_S / STEP_S)
    at = np.arange(steps) * STEP_S
    asked = lambda name: np.interp(at, t, [float(row[name]) for row in rows]) if name in rows[0] else np.full(steps, REST.get(name, 0.0))
    control = np.stack([asked(name) for name in names], axis=1)
    data = mujoco.MjData(model)
    for name, angle in zip(names, control[0]):
        data.joint(name).qpos[0] = angle
    mujoco.mj_kinematics(model, data)
    data.qpos[1] = 0.02 - lowest(mujoco, model, data)
    start = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    best, state = float("inf"), None
    for _ in range(GOES):
        clock = time.perf_counter()
        state, _ = rollout.rollout(model, data, start, control)
        best = min(best, time.perf_counter() - clock)
    z = state[0, :, 1 + 2]
    return DURATION_S / best, z[round(2.0 / STEP_S)] - z[-1], mujoco.__version__


def lowest(mujoco, model, data):
    """Height of the lowest point of the feet [m]: of an ellipsoid the centre less its reach downwards."""
    import numpy as np
    lowest_m = float("inf")
    for k in range(model.ngeom):
        if mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_GEOM, k).endswith("_lower"):
            up = data.geom_xmat[k].reshape(3, 3)[1]
            lowest_m = min(lowest_m, data.geom_xpos[k][1] - np.linalg.norm(up * model.geom_size[k]))
    return lowest_m


def ours():
    """Rows of step [s], displacement [m], times real time, as the bench prints them."""
    command = ["cargo", "bench", "--quiet", "--bench", "walk", "--", "nothing-but-the-table"]
    told = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    rows = re.findall(r"^(\d\S*e-\d+)\s+(\S+)\s+\d+\s+(\S+)\s+\S+\s*$", told, re.MULTILINE)
    return [(float(step), float(displacement), float(times)) for step, displacement, times in rows]


if __name__ == "__main__":
    times, displacement, version = by_mujoco()
    print(f"MuJoCo {version}, steps of {STEP_S:g} s: {times:.0f} times real time, {displacement:.3f} m forward")
    for step, displacement, times in ours():
        print(f"aibo-fit, steps of {step:g} s: {times:.0f} times real time, {displacement:.3f} m forward")
