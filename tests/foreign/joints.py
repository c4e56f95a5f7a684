"""Joints that share no formula and no code with the program: many at once, as lanes of numpy arrays.

Semi-implicit Euler. Friction is LuGre's bristle (presliding, no stick events), limits are soft, cables pull one way only,
stops follow a power law, flanks of a backlash are elastic. A lane is a dict over `NEUTRAL`; all in SI.
"""
import numpy as np

G = 9.81
GRID_S = 5e-4
INF = float("inf")

NEUTRAL = dict(
    inertia=1e-3, moment=5e-3, coulomb=1e-3, viscous=1e-3,  # the joint, extra mass included
    angle=0.0, speed=0.0, release=0.0,                      # start; held until released
    kp=0.0, kd=0.0, stamps=None, setpoints=None,            # the position law and what it follows, each from its stamp on
    bristle=1e-4,                                           # presliding distance
    static=0.0, stribeck_speed=1.0, lorentz=0.0,            # static friction beyond Coulomb; which curve
    bearing=0.0, load_square=0.0,                           # friction by the bearing's whole reaction, by the load squared
    gear_loss=0.0,                                          # friction per motor torque when driving; 0.4 of it when driven
    drag=0.0, lopsided=0.0, bump=0.0, bump_at=0.0,          # |w|^1.8; share by direction; share at an angle
    warming=0.0, warming_s=4.0,                             # share of friction that warming adds in the end
    play=0.0, rotor=0.0, flank=0.0, flank_damping=0.0,      # rotor > 0: two bodies; flank: their stiffness
    cable=0.0, cable_from=0.0, cubic=0.0,                   # pulls back beyond an angle; grows with the cube
    stop=INF, stop_stiffness=0.0,
    zero=0.0, reading_gain=1.0, reading_late=0.0,
    motor_gain=1.0, cooling=0.0,                            # delivered share; share of it lost as the motor heats
    torque_limit=INF, stall=INF, no_load_speed=INF, dead_band=0.0,
    slew=INF, slew_rate=INF,                                # the servo's own limits on its setpoint: speed, acceleration
    cogs=0.0, teeth=24.0, second=0.0, second_phase=0.0, hum=0.0, hum_hz=3.0, hum_phase=0.0,  # outside any catalogue
)


def simulate(lanes, seconds, step_s=1e-4):
    """True angles of every lane on a grid of GRID_S, and the largest motor torque and speed of each."""
    p = {k: np.array([lane.get(k, v) for lane in lanes], float) for k, v in NEUTRAL.items() if k not in ("stamps", "setpoints")}
    n, h, every = len(lanes), step_s, round(GRID_S / step_s)
    has = lambda mask: np.flatnonzero(mask)
    square, geared = has(p["load_square"] > 0), has(p["gear_loss"] > 0)
    rubbing, dragging, bumpy = has(p["bearing"] > 0), has(p["drag"] > 0), has(p["bump"] != 0)
    sided, warm, two = has(p["lopsided"] != 0), has(p["warming"] != 0), has(p["rotor"] > 0)
    cable, stop, limited, sagging = has(p["cable"] > 0), has(p["stop"] < INF), has(p["torque_limit"] < INF), has(p["stall"] < INF)
    dead, slow, late, static = has(p["dead_band"] > 0), has(p["slew"] < INF), has(p["reading_late"] > 0), has(p["static"] > 0)
    odd = has((p["cogs"] > 0) | (p["second"] > 0) | (p["hum"] > 0))
    at = lambda idx, *names: [p[name][idx] for name in names]

    driven = has(p["kp"] > 0)
    commands = [(np.asarray(lane["stamps"], float), np.asarray(lane["setpoints"], float)) if lane.get("stamps") is not None
                else (np.array([INF]), np.array([0.0])) for lane in lanes]
    due, place = np.array([c[0][0] for c in commands]), np.zeros(n, int)
    ref = np.zeros(n)
    q, w, z = p["angle"].copy(), p["speed"].copy(), np.zeros(n)
    qr, wr = q + np.sign(q) * 0.5 * p["play"], w.copy()
    profile, profile_speed = np.zeros(n), np.zeros(n)
    stiffness = p["coulomb"] / p["bristle"]
    damping = 0.1 * np.sqrt(stiffness * p["inertia"])
    link = p["inertia"] * (1 - p["rotor"])
    rotor = np.where(p["rotor"] > 0, p["inertia"] * p["rotor"], 1.0)
    gm = G * p["moment"]
    ring = max(1, int(round(p["reading_late"].max() / h)) + 1)
    old, back = np.tile(q, (ring, 1)), np.round(p["reading_late"] / h).astype(int)
    held_until = p["release"]
    steps = int(round(seconds / h))
    path = np.empty((steps // every + 1, n))
    most_nm, most_rad_s, acc = np.zeros(n), np.zeros(n), np.zeros(n)
    for k in range(steps + 1):
        t = k * h
        if k % every == 0:
            path[k // every] = q
        for i in np.flatnonzero(due <= t + 1e-9):
            stamps, values = commands[i]
            j = place[i]
            while j < len(stamps) and stamps[j] <= t + 1e-9:
                ref[i] = values[j]
                j += 1
            place[i], due[i] = j, stamps[j] if j < len(stamps) else INF
        seen, target = p["reading_gain"] * q, ref
        rate = p["reading_gain"] * w
        if late.size:
            old[k % ring] = q
            seen[late] = (p["reading_gain"] * old[(k - back) % ring, np.arange(n)])[late]
        if slow.size:
            top, most = at(slow, "slew", "slew_rate")
            miss = ref[slow] - profile[slow]
            want = np.sign(miss) * np.minimum(top, np.sqrt(2 * most * np.abs(miss)))
            profile_speed[slow] += np.clip(want - profile_speed[slow], -most * h, most * h)
            profile[slow] += h * profile_speed[slow]
            target = ref.copy()
            target[slow] = profile[slow]
        u = p["kp"] * (target - seen) - p["kd"] * rate
        u *= p["motor_gain"] * (1 - p["cooling"] * (1 - np.exp(-t / 5.0)))
        if limited.size:
            (most,) = at(limited, "torque_limit")
            u[limited] = most * np.tanh(u[limited] / most)
        if sagging.size:
            stall, top = at(sagging, "stall", "no_load_speed")
            pushing = np.maximum(0.0, np.sign(u[sagging]) * w[sagging])
            room = stall * np.maximum(0.0, 1 - pushing / top - 0.15 * np.abs(u[sagging]) / stall)  # the supply sags under load
            u[sagging] = np.clip(u[sagging], -room, room)
        if dead.size:
            u[dead] = np.where(np.abs(u[dead]) < p["dead_band"][dead], 0.0, u[dead])
        if driven.size:
            np.maximum(most_nm, np.abs(u), out=most_nm)
        np.maximum(most_rad_s, np.abs(w), out=most_rad_s)

        load = gm * np.sin(q + p["zero"])
        v = w
        if two.size:
            v = w.copy()
            v[two] = wr[two]
        fast = np.abs(v)
        slide = p["coulomb"].copy()
        viscous = p["viscous"]
        if warm.size:
            grown = 1 + p["warming"] * (1 - np.exp(-t / p["warming_s"]))
            slide, viscous = slide * grown, viscous * grown
        if bumpy.size:
            slide[bumpy] *= 1 + p["bump"][bumpy] * np.exp(np.cos(q[bumpy] - p["bump_at"][bumpy]) / 0.3 - 1 / 0.3)
        if sided.size:
            slide[sided] *= 1 + p["lopsided"][sided] * np.tanh(v[sided] / 0.05)
        if rubbing.size:
            a = (G * np.cos(q[rubbing]) + w[rubbing] ** 2, G * np.sin(q[rubbing]) + acc[rubbing])
            slide[rubbing] += p["bearing"][rubbing] * p["moment"][rubbing] * np.hypot(*a)
        if square.size:
            slide[square] += p["load_square"][square] * load[square] ** 2 / gm[square]
        if geared.size:
            slide[geared] += p["gear_loss"][geared] * np.abs(u[geared]) * np.where(u[geared] * v[geared] > 0, 1.0, 0.4)
        if static.size:
            x = fast[static] / p["stribeck_speed"][static]
            slide[static] += p["static"][static] * np.where(p["lorentz"][static] > 0, 1 / (1 + x * x), np.exp(-x))
        z = (z + h * v) / (1 + h * stiffness * fast / slide)
        friction = stiffness * z + damping * (v - stiffness * fast * z / slide) + viscous * v
        if dragging.size:
            friction[dragging] += p["drag"][dragging] * np.sign(v[dragging]) * fast[dragging] ** 1.8

        outer = -load
        if cable.size:
            x = np.maximum(0.0, q[cable] - p["cable_from"][cable])
            outer[cable] -= p["cable"][cable] * (x + p["cubic"][cable] * x**3)
        if stop.size:
            x = np.maximum(0.0, q[stop] - p["stop"][stop])
            outer[stop] -= p["stop_stiffness"][stop] * x**1.5 * np.maximum(0.0, 1 + 0.2 * w[stop])
        if odd.size:
            outer[odd] += p["cogs"][odd] * np.sin(p["teeth"][odd] * q[odd]) + p["second"][odd] * np.sin(2 * q[odd] + p["second_phase"][odd])
            outer[odd] += p["hum"][odd] * np.sin(2 * np.pi * p["hum_hz"][odd] * t + p["hum_phase"][odd])
        inner = u - friction
        acc = (inner + outer) / p["inertia"]
        if two.size:
            x = qr[two] - q[two]
            past = x - np.clip(x, -0.5 * p["play"][two], 0.5 * p["play"][two])
            push = p["flank"][two] * past + p["flank_damping"][two] * (wr[two] - w[two]) * (past != 0)
            push = np.where(p["play"][two] > 0, np.sign(past) * np.maximum(0.0, np.sign(past) * push), push)
            acc[two] = (outer[two] + push) / link[two]
            wr[two] += h * (inner[two] - push) / rotor[two]
            wr[two] *= t >= held_until[two]
            qr[two] += h * wr[two]
        w += h * acc
        w *= t >= held_until
        q += h * w
    return path, most_nm, most_rad_s


def read(path, lane, times):
    """What a perfect encoder with the lane's own gain and age of readings shows at the times."""
    grid = GRID_S * np.arange(len(path))
    return lane.get("reading_gain", 1.0) * np.interp(np.maximum(0.0, times - lane.get("reading_late", 0.0)), grid, path)
