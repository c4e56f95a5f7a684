"""What each study is: its kind, cause and drive are listed, all else is drawn from its number."""
from dataclasses import dataclass, field

import numpy as np

G = 9.81
# Engine, drive ("off", "one load", "position", "mixed"), causes.
OWN, MUJOCO = "own", "mujoco"
PLAN = (
    [(OWN, d, ()) for d in ("off", "one load", "position", "mixed") * 3 + ("off", "position")]
    + [(MUJOCO, d, ()) for d in ("off", "one load", "position", "mixed", "position", "off")]
    + [(OWN, d, (c,)) for d, c in (
        ("off", "stribeck"), ("position", "stribeck"), ("off", "load_friction"), ("mixed", "load_friction"), ("position", "gear_friction"),
        ("off", "quadratic_drag"), ("off", "asymmetric_friction"), ("position", "position_friction"), ("off", "friction_drift"),
        ("position", "backlash"), ("off", "backlash"), ("off", "joint_spring"), ("position", "joint_spring"), ("off", "end_stop"),
        ("off", "angle_offset"), ("off", "sensor_gain"), ("position", "delay"), ("mixed", "delay"), ("position", "setpoint_hold"),
        ("position", "torque_limit"), ("position", "speed_limit"), ("mixed", "motor_gain"))]
    + [(MUJOCO, d, (c,)) for d, c in (
        ("position", "torque_limit"), ("mixed", "torque_limit"), ("off", "end_stop"), ("position", "joint_spring"), ("off", "angle_offset"),
        ("position", "delay"), ("mixed", "motor_gain"))]
    + [(OWN, "position", (c,)) for c in ("dead_band", "sensor_delay", "setpoint_profile", "compliance")]
    + [(OWN, d, c) for d, c in (
        ("position", ("stribeck", "torque_limit")), ("mixed", ("delay", "joint_spring")), ("mixed", ("motor_gain", "backlash")),
        ("position", ("gear_friction", "angle_offset")), ("off", ("stribeck", "angle_offset")), ("off", ("end_stop", "load_friction")),
        ("off", ("joint_spring", "quadratic_drag")))]
    + [(OWN, d, (c,)) for d, c in (
        ("off", "cogging"), ("position", "cogging"), ("off", "second_harmonic"), ("position", "second_harmonic"), ("off", "hum"), ("position", "hum"))]
)
OUTSIDE = ("cogging", "second_harmonic", "hum")
STAGES = {"cogging": ["gearing", "link", "motor"], "second_harmonic": ["link", "gearing"], "hum": ["link"]}
# First size and range of each; what a size means is in `Cause.on`.
SIZES = {
    "stribeck": (0.5, 0.1, 4), "load_friction": (0.05, 0.0008, 0.4), "gear_friction": (0.15, 0.02, 0.8), "quadratic_drag": (0.5, 0.02, 20),
    "asymmetric_friction": (0.3, 0.03, 0.9), "position_friction": (0.8, 0.1, 6), "friction_drift": (0.5, 0.05, 3), "backlash": (0.02, 0.002, 0.12),
    "joint_spring": (0.1, 0.005, 1.5), "end_stop": (0.1, 0.01, 0.8), "angle_offset": (0.03, 0.003, 0.25), "sensor_gain": (0.04, 0.005, 0.2),
    "delay": (0.015, 0.002, 0.08), "setpoint_hold": (0.03, 0.004, 0.2), "torque_limit": (0.4, 0.05, 0.75), "speed_limit": (0.8, 0.3, 3),
    "motor_gain": (0.2, 0.03, 0.6), "dead_band": (0.1, 0.01, 0.5), "sensor_delay": (0.01, 0.002, 0.04), "setpoint_profile": (0.4, 0.01, 0.8),
    "compliance": (0.05, 0.005, 0.3), "cogging": (0.05, 0.003, 0.5), "second_harmonic": (0.05, 0.003, 0.6), "hum": (0.05, 0.003, 0.5),
}


@dataclass
class Cause:
    """One effect at one size, and how it changes a lane."""
    name: str
    size: float
    range: tuple
    target: float
    odd: dict
    strength: float = 0.0
    low: float = 0.0   # bracket of the size that changes the motion by `target`
    high: float = 0.0

    def on(self, lane, most):
        s, o, lane = self.size, self.odd, dict(lane)
        gm, (torque, speed, angle) = G * lane["bare_moment"], most
        change = {
            "stribeck": lambda: dict(static=s * lane["coulomb"], stribeck_speed=o["speed"], lorentz=o["which"]),
            "load_friction": lambda: dict(bearing=s) if o["which"] else dict(load_square=s),
            "gear_friction": lambda: dict(gear_loss=s),
            "quadratic_drag": lambda: dict(drag=s * lane["viscous"] / o["speed"]),
            "asymmetric_friction": lambda: dict(lopsided=s * o["sign"]),
            "position_friction": lambda: dict(bump=s, bump_at=o["phase"]),
            "friction_drift": lambda: dict(warming=s, warming_s=o["late"]),
            "backlash": lambda: dict(play=s, rotor=o["rotor"], flank=200 * gm, flank_damping=0.4 * gm),
            "joint_spring": lambda: dict(cable=s * gm, cable_from=o["from"], cubic=0.0 if lane.get("engine") == MUJOCO else 0.5),
            "end_stop": lambda: dict(stop=angle * (1 - s), stop_stiffness=60 * gm),
            "angle_offset": lambda: dict(zero=s * o["sign"]),
            "sensor_gain": lambda: dict(reading_gain=1 + s * o["sign"]),
            "delay": lambda: dict(stamps=[t + s * (1 + 0.3 * j) for t, j in zip(lane["stamps"], o["jitter"])]) if lane.get("stamps") is not None else {},
            "setpoint_hold": lambda: _held(lane, s),
            "torque_limit": lambda: dict(torque_limit=torque * (1 - s)),
            "speed_limit": lambda: dict(stall=1.2 * torque, no_load_speed=speed / s),
            "motor_gain": lambda: dict(motor_gain=1 - s if o["sign"] < 0 else 1 / (1 - s), cooling=0.0 if lane.get("engine") == MUJOCO else 0.02),
            "dead_band": lambda: dict(dead_band=s * gm),
            "sensor_delay": lambda: dict(reading_late=s),
            "setpoint_profile": lambda: dict(slew=max(0.2, (1 - s) * o["slew"]), slew_rate=4 * o["slew"] / s),
            "compliance": lambda: dict(rotor=o["rotor"], flank=gm / s, flank_damping=0.004 * gm / s),
            "cogging": lambda: dict(cogs=s * gm, teeth=o["teeth"]),
            "second_harmonic": lambda: dict(second=s * gm, second_phase=o["phase"]),
            "hum": lambda: dict(hum=s * gm, hum_hz=o["hz"], hum_phase=o["phase"]),
        }[self.name]()
        return {**lane, **change}

    def try_next(self):
        """The next size to try, after `strength` of this one was measured."""
        if self.strength < self.target:
            self.low = self.size
        else:
            self.high = self.size
        step = float(np.clip(self.target / max(self.strength, 1e-3), 0.15, 6))
        size = np.sqrt(self.low * self.high) if self.low and self.high else self.size * step
        self.size = float(np.clip(size, *self.range))

    def values(self):
        """Parameters of the catalogue that mean the same here."""
        s, sign = self.size, self.odd["sign"]
        return {"angle_offset": {"d": s * sign}, "sensor_gain": {"e": s * sign}, "delay": {"T": s}, "setpoint_hold": {"T_h": s}, "backlash": {"b": s},
                "sensor_delay": {"T": s}, "motor_gain": {"c": 1 - s if sign < 0 else 1 / (1 - s)}}.get(self.name, {})


def _held(lane, period):
    """Only every `period` does a setpoint get through."""
    if lane.get("stamps") is None:
        return {}
    stamps, values = [], []
    for t, v in zip(lane["stamps"], lane["setpoints"]):
        if not stamps or t >= stamps[-1] + period - 1e-9:
            stamps.append(t)
            values.append(v)
    return dict(stamps=stamps, setpoints=values)


@dataclass
class Study:
    number: int
    engine: str
    drive: str
    dice: np.random.Generator
    causes: list
    numbers: dict
    nominal: dict
    uncertain: dict
    step: float
    period: float
    noise: float
    noise_s: float
    rest_stated: bool
    kp: float = 0.0
    kd: float = 0.0
    lanes: list = field(default_factory=list)
    times: list = field(default_factory=list)
    commands: list = field(default_factory=list)
    extras: list = field(default_factory=list)
    most: tuple = (0.0, 0.0, 0.0)  # largest motor torque, speed and angle without effects

    @property
    def floor(self):
        return float(np.hypot(self.step / np.sqrt(12), self.noise))

    def truth(self):
        names = [c.name for c in self.causes]
        kind = "nothing" if not names else "outside" if names[0] in OUTSIDE else "pair" if len(names) > 1 else "single"
        return dict(kind=kind, causes=names, engine=self.engine, drive=self.drive, numbers=self.numbers, floor=self.floor, noise_s=self.noise_s,
                    stages=STAGES.get(names[0] if names else "", []), strength=[round(c.strength, 1) for c in self.causes],
                    size=[c.size for c in self.causes], values=[c.values() for c in self.causes])


SEED = 20_000  # of which `sizes.json` is


def draw(number, seconds, seed=SEED):
    """The study of a number, before its effects have their sizes."""
    engine, drive, names = PLAN[number]
    dice = np.random.default_rng(seed + number)
    log_uniform = lambda low, high: float(np.exp(dice.uniform(np.log(low), np.log(high))))
    inertia, omega = log_uniform(5e-4, 2e-2), dice.uniform(5, 10)
    moment = inertia * omega**2 / G
    numbers = dict(inertia=inertia, moment=moment, coulomb=log_uniform(0.01, 0.1) * G * moment, viscous=2 * log_uniform(0.01, 0.08) * omega * inertia)
    off = lambda: 1 + dice.uniform(-0.15, 0.15)
    nominal = {k: v * off() for k, v in numbers.items()}
    uncertain = dict(inertia=0.1, moment=0.1, friction=0.1, gain=0.02) if number % 2 else {}
    step, period = log_uniform(3e-4, 6e-3), dice.uniform(0.004, 0.010)
    study = Study(number, engine, drive, dice, [], numbers, nominal, uncertain, step, period, step * dice.uniform(0.1, 0.45),
                  float(dice.choice([0.0, 0.0, dice.uniform(0.002, 0.02)])), bool(dice.random() < 0.7) and "angle_offset" not in names)
    if drive in ("position", "mixed"):
        study.kp = G * moment * dice.uniform(1.5, 6)
        study.kd = 2 * dice.uniform(0.2, 0.6) * np.sqrt((study.kp + G * moment) * inertia) - 0.5 * numbers["viscous"]
    bristle = 0.2 * step if "stribeck" in names else 1e-6  # presliding is a cause of its own
    for k in range(4):
        add_log(study, k, seconds, bristle, omega)
    if "end_stop" in names:  # no swing may begin beyond the stop
        for lane in study.lanes:
            lane["angle"] = -abs(lane["angle"])
    for name in names:
        first, low, high = SIZES[name]
        odd = dict(sign=dice.choice([-1, 1]), which=int(dice.integers(2)), speed=omega * dice.uniform(0.05, 0.12), phase=dice.uniform(-1, 1),
                   late=dice.uniform(2, 5), rotor=dice.uniform(0.25, 0.5), teeth=float(dice.integers(9, 30)),
                   hz=dice.uniform(1.5, 5), slew=omega, jitter=dice.uniform(-1, 1, 4000), **{"from": dice.uniform(-0.2, 0.2)})
        if name == "quadratic_drag":
            odd["speed"] = omega
        study.causes.append(Cause(name, first, (low, high), float(np.exp(dice.uniform(np.log(4), np.log(30)))), odd))
    return study


def add_log(study, k, seconds, bristle, omega):
    """One log: stamps with jitter, perhaps with a hole or lost samples; a load; a start; a setpoint."""
    dice, bare = study.dice, study.numbers
    free = study.drive in ("off", "one load") or study.drive == "mixed" and k == 1
    jitter = dice.choice([0.0, 0.15])
    t = study.period * np.arange(int((seconds - 0.1) / study.period))
    t = t + np.r_[0.0, dice.uniform(-jitter, jitter, len(t) - 1) * study.period]
    keep = np.ones(len(t), bool)
    if dice.random() < 0.25:
        keep &= dice.random(len(t)) > 0.015
    if dice.random() < 0.2:
        begin = dice.integers(len(t) // 4, len(t) // 2)
        keep[begin:begin + dice.integers(3, 10)] = False
    keep[0] = True
    share = {"off": (0.0, 0.6, 1.2, 0.6)[k], "one load": 0.0}.get(study.drive, 0.8 if k == 1 else 0.0)
    distance = float(np.sqrt(bare["inertia"] / bare["moment"]) * 0.3)
    extra = dict(mass=share * bare["moment"] / distance, distance=distance, radius=0.01, length=0.02) if share else None
    lane = dict(bare, angle=0.0, speed=0.0, bristle=bristle, bare_moment=bare["moment"])
    if extra:
        lane["inertia"] += extra["mass"] * (0.5 * 0.01**2 + 0.02**2 / 12 + distance**2)
        lane["moment"] += extra["mass"] * distance
    commands = None
    if free:
        lane["angle"] = float((0.9, -0.7, 1.3, -1.1)[k] * dice.uniform(0.8, 1.1))
        lane["release"] = float(dice.choice([0.0, dice.uniform(0.2, 0.5)]))
    else:
        commands = setpoint(dice, k, t, omega)
        lane.update(kp=study.kp, kd=study.kd, stamps=list(t), setpoints=list(commands))
        commands = commands[keep]
    study.lanes.append(lane)
    study.times.append(t[keep])
    study.commands.append(commands)
    study.extras.append(extra)


def setpoint(dice, k, t, omega):
    """A chirp, sines or steps, from zero."""
    ramp, size = np.minimum(1.0, t / 0.5), dice.uniform(0.4, 0.9)
    if k == 0:
        top = omega * dice.uniform(1.0, 1.6)
        return ramp * size * np.sin(0.5 * (t / t[-1]) * top * t + 1.0 * t)
    if k == 2:
        levels = dice.uniform(-size, size, 20)
        return np.where(t < 0.3, 0.0, levels[(t / 0.6).astype(int)])
    tones = [(dice.uniform(0.2, 0.5), omega * dice.uniform(0.1, 1.2), dice.uniform(0, 6.3)) for _ in range(3)]
    return ramp * size * sum(a * np.sin(f * t + p) for a, f, p in tones)
