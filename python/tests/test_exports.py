"""What `export` writes is used where it goes, by the lines that docs/python.md shows."""

import importlib.util
import json
import re
import sys
import types
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from conftest import DELAY, ROOT


def shown(beginning):
    """The block of docs/python.md that begins so."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.DOTALL)
    (block,) = [block for block in blocks if block.startswith(beginning)]
    return block


@pytest.fixture
def exported(program, tmp_path, monkeypatch):
    """Exports what was found of an arm, or of a joint, and goes where it lies."""
    documents = {}

    def export(study, form):
        if study not in documents:
            documents[study] = tmp_path / f"{len(documents)}.json"
            program("gap", study, "--json", documents[study], "--out", tmp_path / "out", "--quiet")
        program("export", documents[study], "--to", form, "--out", tmp_path / "exported", "--quiet")
        monkeypatch.chdir(tmp_path)
        return documents[study]

    return export


def test_an_mjcf_moves_in_mujoco(exported):
    pytest.importorskip("mujoco", reason="MuJoCo is not installed")
    exported(ROOT / "data/examples/arm/study.toml", "mjcf")
    names = {}
    exec(shown("import mujoco"), names)
    assert names["data"].time > 0.0 and names["model"].nu == 2
    assert np.isfinite(names["data"].qpos).all()


def classes_of_isaac_lab(monkeypatch):
    """Isaac Lab's own actuator classes, without the simulator that importing the package starts."""
    spec = importlib.util.find_spec("isaaclab")
    found = [next(Path(place).rglob("actuator_pd_cfg.py"), None) for place in (spec.submodule_search_locations if spec else [])]
    if not any(found):
        pytest.skip("Isaac Lab is not installed")
    folder = next(filter(None, found)).parent
    modules = {name: types.ModuleType(name) for name in ("isaaclab", "isaaclab.utils", "isaaclab.actuators", "isaaclab.actuators.actuator_pd")}
    modules["isaaclab.utils"].configclass = dataclass(kw_only=True)
    modules["isaaclab.actuators"].__path__ = [str(folder)]
    modules["isaaclab.actuators"].actuator_pd = modules["isaaclab.actuators.actuator_pd"]
    modules["isaaclab.actuators.actuator_pd"].__getattr__ = lambda name: type(name, (), {})
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    classes = importlib.import_module("isaaclab.actuators.actuator_pd_cfg")
    for name in ("DelayedPDActuatorCfg", "ImplicitActuatorCfg"):
        setattr(modules["isaaclab.actuators"], name, getattr(classes, name))
    yield
    for name in [name for name in sys.modules if name.startswith("isaaclab.")]:
        sys.modules.pop(name)


isaac_lab = pytest.fixture(classes_of_isaac_lab)


@pytest.mark.skipif(sys.version_info < (3, 10), reason="Isaac Lab needs a newer Python")
def test_actuators_are_isaac_labs(exported, isaac_lab, monkeypatch):
    exported(ROOT / "data/examples/arm/study.toml", "isaac")
    monkeypatch.setattr(sys, "path", list(sys.path))
    names = {}
    exec(shown("import sys\nsys.path.insert"), names)
    sys.modules.pop("isaac", None)
    actuators = names["ACTUATORS"]
    assert set(actuators) == {"arm/shoulder", "arm/elbow"}
    late = actuators["arm/elbow"]
    assert type(late).__name__ == "DelayedPDActuatorCfg" and late.max_delay == round(0.024 / 0.005)
    assert late.stiffness == pytest.approx(12.0, rel=0.03) and type(actuators["arm/shoulder"]).__name__ == "ImplicitActuatorCfg"


def test_a_table_is_the_friction_of_the_answer(exported):
    document = json.loads(exported(DELAY / "study.toml", "table").read_text())
    names = {}
    exec(shown("import numpy as np\nspeed, torque"), names)
    coulomb, viscous = (document["joint"][key]["value"] for key in ("coulomb", "viscous"))
    assert names["friction_nm"] == pytest.approx(coulomb + 0.3 * viscous, rel=1e-3)
    table = json.loads(Path("exported/friction.json").read_text())["tables"][0]
    assert table["speed_rad_s"] == pytest.approx(names["speed"], abs=1e-6)
    delay, gain = table["cannot_say"]
    assert delay.startswith("pendulum: delay (T = 0.016")
    assert gain.startswith("pendulum: gain = 0.99") and gain.endswith("beside which this friction was found")
