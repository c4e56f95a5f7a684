"""One hinge of MuJoCo on the grid of `joints`: its friction loss, armature, actuator, limits and springs."""
import numpy as np
import mujoco

from joints import GRID_S, INF, NEUTRAL

XML = """<mujoco><option timestep="{step}" integrator="implicitfast" gravity="0 0 -9.81"/><worldbody><body>
<joint name="j" type="hinge" axis="0 1 0" frictionloss="{coulomb}" damping="{viscous}" armature="{armature}"
 solreffriction="0.001 1" stiffness="{cable}" springref="{spring_deg}" {limit}/>
<inertial pos="{x} 0 {z}" mass="{mass}" diaginertia="{own} {own} {own}"/></body></worldbody>
<actuator><position joint="j" kp="{kp}" kv="{kd}" {force}/></actuator></mujoco>"""


def simulate(lane, seconds):
    """As `joints.simulate` for one lane: angles, largest torque, largest speed."""
    p = {**NEUTRAL, **lane}
    step = GRID_S / 2
    length = 0.5 * p["inertia"] / p["moment"]  # half of the inertia is the point mass's, the rest armature
    mass = p["moment"] / length
    own = 0.1 * mass * length**2
    gain = p["motor_gain"]
    spring = p["stop_stiffness"] / p["inertia"]  # MuJoCo's limits are given per inertia
    limit = f'limited="true" range="-170 {np.degrees(p["stop"])}" solreflimit="{-spring} {-0.6 * np.sqrt(spring)}"' if p["stop"] < INF else ""
    force = f'forcerange="{-p["torque_limit"]} {p["torque_limit"]}"' if p["torque_limit"] < INF else ""
    model = mujoco.MjModel.from_xml_string(XML.format(
        step=step, coulomb=p["coulomb"], viscous=p["viscous"], armature=p["inertia"] - mass * length**2 - own, cable=p["cable"],
        spring_deg=np.degrees(p["cable_from"]), limit=limit, x=-length * np.sin(p["zero"]), z=-length * np.cos(p["zero"]), mass=mass, own=own,
        kp=gain * p["kp"], kd=gain * p["kd"], force=force))
    data = mujoco.MjData(model)
    data.qpos[0], data.qvel[0] = p["angle"], p["speed"]
    stamps, values = (np.asarray(p[k]) if p[k] is not None else np.array([]) for k in ("stamps", "setpoints"))
    times = step * np.arange(int(round(seconds / step)) + 1)
    place = np.searchsorted(stamps, times + 1e-9, side="right") - 1
    commands = np.where(place >= 0, values[np.maximum(place, 0)], 0.0) if len(stamps) else np.zeros(len(times))
    path, most_nm, most_rad_s = np.empty(len(times) // 2 + 1), 0.0, 0.0
    for k, t in enumerate(times):
        if k % 2 == 0:
            path[k // 2] = data.qpos[0]
        if t < p["release"]:
            continue
        data.ctrl[0] = commands[k]
        mujoco.mj_step(model, data)
        most_nm, most_rad_s = max(most_nm, abs(data.actuator_force[0])), max(most_rad_s, abs(data.qvel[0]))
    return path, most_nm, most_rad_s
