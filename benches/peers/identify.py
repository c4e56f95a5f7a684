"""One identification problem, four ways: time until a swing that was not fitted is predicted as well as by the best.

A reference swing of the thesis's robot (`data/thesis-robot/q1-402g-0.csv`, made by another engine) is fitted by inertia,
Coulomb and viscous friction and rest angle, the moment held, all from the same start; `q1-402g-1.csv` is held out. Every
way writes down its best numbers with the time they took; one judge (the integrator of `benches/scipy_joint.py`, its clock
not counted) predicts the held-out swing with each. A way has arrived where that error is within one per cent of the best
that any way reached.
"""
import contextlib
import io
import json
import math
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE.parent))
FITTED, HELD_OUT = (str(ROOT / f"data/thesis-robot/q1-402g-{k}.csv") for k in (0, 1))
# Inertia of the bare leg, Coulomb and viscous friction, rest angle: twice, three times and a third of the thesis's.
START = {"inertia": 1.195e-3, "coulomb": 0.003, "viscous": 0.0057, "rest": 0.0}
NAMES = list(START)
WITHIN = 1.01


class Course:
    """Best numbers so far, each with the time from the beginning [s]; the clock stands while something is written down."""

    def __init__(self, name):
        self.name, self.points, self.aside, self.began = name, [], 0.0, time.perf_counter()

    def note(self, numbers):
        now = time.perf_counter()
        self.points.append((now - self.began - self.aside, [float(n) for n in numbers]))
        self.aside += time.perf_counter() - now


def ours():
    """`benches/fit.rs --estimate`: median time from the log in memory to numbers with both kinds of interval."""
    from scipy_joint import Sidecars
    moment = Sidecars([FITTED], None, None).joint["moment"]
    numbers = [START["inertia"], moment, START["coulomb"], START["viscous"]]
    command = ["cargo", "bench", "--quiet", "--bench", "fit", "--", "--estimate", FITTED, *map(repr, numbers)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    told = json.loads(run.stdout.strip().splitlines()[-1])
    course = Course("aibo-fit, with intervals")
    course.points = [(told["estimate_ms"] / 1e3, [told["parameters"][name] for name in NAMES])]
    return course


def problem_of(path, frozen=None):
    import scipy_fit
    study = scipy_fit.Sidecars([path], None, None)
    study.joint.pop("rest", None)
    return study, scipy_fit.Problem(study, study.logs, False, False, frozen=frozen)


def by_scipy():
    """`scipy.optimize.least_squares` with central differences, every column in one numpy batch."""
    import numpy as np
    from scipy.optimize import least_squares
    course = Course("scipy least_squares")
    _, problem = problem_of(FITTED)
    known, least = {}, [math.inf]

    def both(x):
        if x.tobytes() not in known:
            known.clear()
            residual, jacobian = known[x.tobytes()] = problem.evaluate([x])[0]
            if residual @ residual < least[0]:
                least[0] = residual @ residual
                course.note(x[:4])
        return known[x.tobytes()]

    start = problem.start_vector(list(START.values()))
    least_squares(lambda x: both(x)[0], np.clip(start, problem.low, problem.high), jac=lambda x: both(x)[1],
                  bounds=(problem.low, problem.high), x_scale=problem.scale, ftol=1e-9, xtol=1e-9, gtol=1e-12, max_nfev=100)
    return course


def by_cma():
    """CMA-ES as servo toolkits use it: no derivatives, each generation in one numpy batch."""
    import cma
    import numpy as np
    course = Course("CMA-ES")
    _, problem = problem_of(FITTED)
    start = problem.start_vector(list(START.values()))
    scaled = lambda x: np.clip(start + problem.scale * x, problem.low, problem.high)
    search = cma.CMAEvolutionStrategy(np.zeros(problem.size), 0.5, {"seed": 1, "verbose": -9, "maxfevals": 6000, "tolfun": 1e-10})
    least = math.inf
    while not search.stop():
        drawn = search.ask()
        squares = [float(r @ r) for r, _ in problem.evaluate([scaled(np.array(x)) for x in drawn], False)]
        search.tell(drawn, squares)
        k = int(np.argmin(squares))
        if squares[k] < least:
            least = squares[k]
            course.note(scaled(np.array(drawn[k]))[:4])
    return course


def by_mujoco():
    """MuJoCo's own toolbox (`mujoco.sysid`): a hinge with armature, frictionloss and damping from the moment of release."""
    import mujoco
    import numpy as np
    from mujoco import sysid
    from scipy_joint import hollow_cylinder
    study, _ = problem_of(FITTED)
    log, joint = study.logs[0], study.joint
    inertia_of_load, moment_of_load = hollow_cylinder(log.extra)
    moment = joint["moment"] + moment_of_load
    mass = moment / 0.1
    # All inertia about the axis is the joint's armature: the point mass below it has mass * 0.1^2 of its own.
    armature = lambda inertia: max(inertia + inertia_of_load - mass * 0.01, 1e-9)
    xml = f"""<mujoco><compiler angle="radian"/><option timestep="0.001" integrator="implicitfast" gravity="0 0 -{joint["gravity"]}">
      <flag contact="disable"/></option><worldbody><body name="link">
      <inertial pos="0 0 -0.1" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/><joint name="q" type="hinge" axis="0 -1 0"/>
      </body></worldbody><sensor><jointpos name="angle" joint="q"/></sensor></mujoco>"""
    course = Course("MuJoCo sysid")
    spec = mujoco.MjSpec.from_string(xml)

    def rested(spec, parameter):
        rest = parameter.value[0]
        spec.body("link").ipos = [-0.1 * math.sin(rest), 0.0, -0.1 * math.cos(rest)]

    setters = {
        "inertia": lambda s, p: setattr(s.joint("q"), "armature", armature(p.value[0])),
        "coulomb": lambda s, p: setattr(s.joint("q"), "frictionloss", p.value[0]),
        "viscous": lambda s, p: setattr(s.joint("q"), "damping", np.array([p.value[0], 0, 0])),
        "rest": rested,
    }
    bounds = {"inertia": (2e-5, 3e-2), "coulomb": (0.0, 0.1), "viscous": (0.0, 0.3), "rest": (-3.2, 3.2)}
    parameters = sysid.ParameterDict()
    for name in NAMES:
        parameters.add(sysid.Parameter(name, START[name], *bounds[name], modifier=setters[name]))
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[0] = log.held[2]
    initial = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    times = log.t - log.t[0]
    measured = sysid.TimeSeries.from_names(times, log.q[:, None], model)
    grid = np.arange(0.0, times[-1] + 5e-4, 1e-3)
    control = sysid.TimeSeries(grid, np.zeros((len(grid), 0)))
    swing = sysid.ModelSequences("swing", spec, "q1", initial, control, measured)
    residual = sysid.build_residual_fn(models_sequences=[swing])
    least = [math.inf]

    def noted(x, parameters, **more):
        answer = residual(x, parameters, **more)
        # Several points at once are those of a Jacobian.
        if np.size(x) == len(NAMES):
            squares = float((np.asarray(answer[0][0]) ** 2).sum())
            if squares < least[0]:
                least[0] = squares
                course.note(np.ravel(x))
        return answer

    with contextlib.redirect_stdout(io.StringIO()):
        found, _ = sysid.optimize(parameters, noted, optimizer="mujoco", verbose=False, x_scale="jac")
    course.note(found.as_vector())
    return course


def judged(course, predict):
    """Held-out error [rad] with each of the numbers, in the order of time."""
    return [(seconds, predict(numbers)) for seconds, numbers in course.points]


def compare():
    """Rows of name, time to within one per cent of the best [s] (None: never), time in all [s], held-out error reached [rad]."""
    import scipy_fit
    courses, skipped = [], []
    for way in (ours, by_scipy, by_cma, by_mujoco):
        try:
            courses.append(way())
        except (ImportError, AttributeError, OSError, subprocess.CalledProcessError) as error:
            skipped.append(f"{way.__name__}: {error}")
    study, problem = problem_of(FITTED)
    held_study, _ = problem_of(HELD_OUT)

    def predict(numbers):
        import numpy as np
        full = np.concatenate([numbers, problem.start_vector([])])
        return scipy_fit.predict(held_study, problem, full, held_study.logs)[0]

    errors = {course.name: judged(course, predict) for course in courses}
    best = min(error for course in errors.values() for _, error in course)
    rows = []
    for name, course in errors.items():
        arrived = next((seconds for seconds, error in course if error <= WITHIN * best), None)
        rows.append((name, arrived, course[-1][0], min(error for _, error in course)))
    return rows, skipped


if __name__ == "__main__":
    rows, skipped = compare()
    for name, arrived, whole, error in rows:
        told = "never" if arrived is None else f"{1e3 * arrived:.2f} ms"
        print(f"{name:28s} {told:>12s} of {1e3 * whole:10.2f} ms, held-out error {1e3 * error:.4f} mrad")
    for why in skipped:
        print("skipped:", why)
