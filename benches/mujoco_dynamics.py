"""Forward dynamics of the ERS-7: MuJoCo beside `aibo-fit dynamics --repeat`, on the same states.

    python3 benches/mujoco_dynamics.py [STATES.json] [--model MODEL.xml] [--repeat N]

The model is `ers7/ers7.xml` in the folder that AIBO_FIT_SHARED names. MuJoCo's `mj_forward` does more than forward
dynamics (sensors, constraints, of which the model has none), so `mj_fwdPosition` to `mj_fwdAcceleration` are timed too.
Called from Python, each evaluation carries one call's overhead, which is measured (`mj_versionString`) and printed.
Without the package, the model or cargo it says `skipped: ...` and exits 0.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def median_us(work, repeat):
    """Median time of one call, from batches that are long against the clock."""
    batch = 50
    times = []
    for _ in range(max(repeat // batch, 5)):
        start = time.perf_counter()
        for _ in range(batch):
            work()
        times.append((time.perf_counter() - start) / batch)
    return 1e6 * statistics.median(times)


def time_mujoco(mujoco, model_file, states, repeat):
    model = mujoco.MjModel.from_xml_path(str(model_file))
    data = mujoco.MjData(model)

    def stages():
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)

    whole, parts = [], []
    for state in states:
        data.qpos[:] = state["base_pos"] + state["base_quat_wxyz"] + state["q"]
        data.qvel[:] = state["base_vel_world"] + state["base_omega_body"] + state["dq"]
        data.qfrc_applied[6:] = state["tau"]
        whole.append(median_us(lambda: mujoco.mj_forward(model, data), repeat))
        parts.append(median_us(stages, repeat))
    return {
        "mj_forward": statistics.median(whole),
        "mj_fwdPosition to mj_fwdAcceleration (four calls)": statistics.median(parts),
        "one empty call": median_us(mujoco.mj_versionString, repeat),
    }


def time_ours(states_file, repeat):
    with tempfile.TemporaryDirectory() as folder:
        answers = pathlib.Path(folder) / "answers.json"
        command = ["cargo", "run", "--release", "--quiet", "--", "dynamics", str(states_file)]
        command += ["--json", str(answers), "--repeat", str(repeat), "--quiet"]
        try:
            subprocess.run(command, cwd=ROOT, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            skip(f"aibo-fit did not run: {error}")
        return json.loads(answers.read_text())["timing"]["median_us"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("states", nargs="?", default=ROOT / "data/examples/states.json", type=pathlib.Path)
    parser.add_argument("--model", type=pathlib.Path)
    parser.add_argument("--repeat", type=int, default=5000)
    options = parser.parse_args()
    try:
        import mujoco
    except ImportError:
        skip("Python's mujoco package is not installed")
    shared = os.environ.get("AIBO_FIT_SHARED")
    model_file = options.model or (pathlib.Path(shared) / "ers7/ers7.xml" if shared else None)
    if model_file is None or not model_file.is_file():
        skip("no model: name one with --model, or set AIBO_FIT_SHARED to a folder that holds ers7/ers7.xml")
    states_file = options.states.resolve()
    states = json.loads(states_file.read_text())["states"]
    ours = time_ours(states_file, options.repeat)
    print(f"{'aibo-fit, forward dynamics':<52} {ours:8.3f} us")
    for name, value in time_mujoco(mujoco, model_file, states, options.repeat).items():
        print(f"{'MuJoCo ' + mujoco.__version__ + ', ' + name:<52} {value:8.3f} us   {value / ours:6.1f} times")


if __name__ == "__main__":
    main()
