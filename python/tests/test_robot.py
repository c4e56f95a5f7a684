"""A robot's dynamics from Python are those of the program."""

import json

import numpy as np
import pytest
from conftest import ROOT

import aibo_fit

ARM = ROOT / "data/examples/robots/arm.urdf"


def test_numbers_are_those_of_the_program(program, tmp_path):
    out = tmp_path / "answers.json"
    program("dynamics", "data/examples/robots/arm-states.json", "--robot", ARM, "--json", out, "--quiet")
    answers = json.loads(out.read_text())
    robot = aibo_fit.Robot.from_file(ARM, base=answers["base"])
    names = answers["conventions"]["joint_order"]
    assert robot.joint_names == names and robot.mass == pytest.approx(answers["total_mass"])
    for state in answers["states"]:
        q, dq, tau = ([state[key].get(name, 0.0) for name in names] for key in ("q", "dq", "tau"))
        out = state["out"]
        np.testing.assert_allclose(robot.mass_matrix(q), out["M"], rtol=1e-12)
        np.testing.assert_allclose(robot.bias(q, dq), out["bias"], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(robot.gravity(q), out["gravity"], rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(robot.accelerations(q, dq, tau), out["qacc"], rtol=1e-10)


def test_inverse_undoes_forward():
    robot = aibo_fit.Robot.from_file(ARM, base="fixed")
    rng = np.random.default_rng(1)
    q, dq, tau = rng.normal(size=(3, len(robot.joint_names)))
    ahead = robot.accelerations(q, dq, tau)
    np.testing.assert_allclose(robot.inverse_dynamics(q, dq, ahead), tau, atol=1e-9)
    matrix = robot.mass_matrix(q)
    np.testing.assert_allclose(matrix, matrix.T)
    np.testing.assert_allclose(matrix @ ahead + robot.bias(q, dq), tau, atol=1e-9)
    by_name = dict(zip(robot.joint_names, q))
    np.testing.assert_array_equal(robot.gravity(by_name), robot.gravity(q))


FLOATING = """<robot name="floating">
<link name="base"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="arm"><inertial><origin xyz="0 0 -0.1"/><mass value="0.5"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hip" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/></joint>
</robot>"""


def test_a_free_base_falls(tmp_path):
    urdf = tmp_path / "floating.urdf"
    urdf.write_text(FLOATING)
    robot = aibo_fit.Robot.from_file(urdf, base="free", gravity=[0.0, 0.0, -9.81])
    assert robot.freedoms == 6 + len(robot.joint_names)
    still = {"position": [0.0, 0.0, 1.0], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    falling = robot.accelerations(base=still)
    np.testing.assert_allclose(falling[:6], [0.0, 0.0, -9.81, 0.0, 0.0, 0.0], atol=1e-9)


def test_what_is_wrong_is_said():
    robot = aibo_fit.Robot.from_file(ARM, base="fixed")
    for ask, said in [
        (lambda: aibo_fit.Robot.from_file("absent.urdf"), "absent.urdf"),
        (lambda: aibo_fit.Robot.from_file(ARM, base="floating"), "expected fixed or free"),
        (lambda: robot.mass_matrix([0.0] * 99), "99 values"),
        (lambda: robot.mass_matrix({"nonsense": 1.0}), "no joint `nonsense`"),
        (lambda: robot.bias([float("nan")] * len(robot.joint_names)), "finite"),
        (lambda: robot.gravity(base={"position": [0, 0, 0]}), "the base is fixed"),
    ]:
        with pytest.raises(aibo_fit.Error) as raised:
            ask()
        assert said in str(raised.value)
