"""The tables of `docs/performance.md`, measured anew beside peers in one run.

    AIBO_FIT_SHARED=... python3 benches/peers/run.py [--write]

Needs cargo, and of PyPI numpy, scipy, cma and mujoco[sysid]; what is missing is left out with a word. Prints what stands
between the marks of the page, and with --write puts it there.
"""
import os
import pathlib
import platform
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
PAGE = ROOT / "docs/performance.md"
MARKS = ("<!-- measured: benches/peers/run.py -->", "<!-- end -->")
REPEAT = 5000


def machine():
    cpu = "an unknown processor"
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        cpu = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    compiler = subprocess.run(["rustc", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    load = os.getloadavg()[0]
    return (f"Machine: {os.cpu_count()} cores, {cpu}, {platform.system()}; rustc {compiler}; {load:.1f} processes wanted to run "
            "when it began.")


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def dynamics():
    import mujoco
    import mujoco_dynamics as bench
    import json
    states = ROOT / "data/examples/states.json"
    model = pathlib.Path(os.environ["AIBO_FIT_SHARED"]) / "ers7/ers7.xml"
    ours = bench.time_ours(states, REPEAT)
    theirs = bench.time_mujoco(mujoco, model, json.loads(states.read_text())["states"], REPEAT)
    rows = [("aibo-fit, forward dynamics", f"{ours:.2f} us", "1")]
    rows += [(f"MuJoCo {mujoco.__version__}, {name}", f"{value:.2f} us", f"{value / ours:.1f}") for name, value in theirs.items()]
    return table(("ERS-7, 22 joints, free base", "median", "ratio"), rows)


def walk():
    import mujoco_walk as bench
    times, displacement, version = bench.by_mujoco()
    ours = bench.ours()
    rows = [(f"aibo-fit, steps of {step:g} s", f"{own:.0f}", f"{forward:.4f} m", f"{own / times:.2f}") for step, forward, own in ours]
    rows.append((f"MuJoCo {version}, steps of {bench.STEP_S:g} s, its own contact", f"{times:.0f}", f"{displacement:.4f} m", "1"))
    return table(("ten seconds of the reference walk", "times real time", "forward", "ratio"), rows)


def identification():
    import identify
    found, skipped = identify.compare()
    first = next((arrived for name, arrived, _, _ in found if name.startswith("aibo-fit")), None)

    def row(name, arrived, whole, error):
        told = "never" if arrived is None else f"{1e3 * arrived:.2f} ms"
        ratio = "" if arrived is None or first is None else f"{arrived / first:.0f}"
        return name, told, f"{1e3 * whole:.1f} ms", f"{1e3 * error:.3f} mrad", ratio
    head = ("one swing fitted, another held out", "within 1 % of the best after", "in all", "held-out error", "ratio")
    return "\n".join([table(head, [row(*one) for one in found])] + [f"\nLeft out: {why}." for why in skipped])


def measured():
    parts = [machine()]
    for part in (dynamics, walk, identification):
        try:
            parts.append(part())
        except (ImportError, KeyError, FileNotFoundError, subprocess.CalledProcessError) as error:
            parts.append(f"Left out ({part.__name__}): {error!r}.")
    return "\n\n".join(parts)


def main():
    text = measured()
    print(text)
    if "--write" in sys.argv[1:]:
        page = PAGE.read_text(encoding="utf-8")
        before, rest = page.split(MARKS[0])
        after = rest.split(MARKS[1])[1]
        PAGE.write_text(f"{before}{MARKS[0]}\n{text}\n{MARKS[1]}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
