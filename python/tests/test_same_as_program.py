"""The same question by Python and by the program has the same answer, byte for byte."""

import pytest

import aibo_fit

GAPS = [
    ("data/examples/delay/study.toml", {}, []),
    ("data/examples/delay/study.toml", {"without": ["delay", "backlash"]}, ["--without", "delay,backlash"]),
    ("data/examples/delay/study.toml", {"fix": {"moment": 0.05}, "bound": {"delay.T": (0.0, 0.1)}},
     ["--fix", "moment=0.05", "--bound", "delay.T=0:0.1"]),
    ("data/examples/arm/study.toml", {}, []),
]


@pytest.mark.parametrize("study, keywords, words", GAPS)
def test_gap_is_the_same_document(program, tmp_path, study, keywords, words):
    document = tmp_path / "gap.json"
    told = program("gap", study, *words, "--json", document, "--out", tmp_path / "out").stdout
    found = aibo_fit.gap(study, **keywords)
    assert found.to_json().encode() == document.read_bytes()
    assert told.startswith(str(found))
    assert found.to_html() == (tmp_path / "out/report.html").read_text()


def test_drop_of_a_log_with_its_sidecar_is_the_same_document(program, tmp_path):
    document = tmp_path / "drop.json"
    program("drop", "data/q1.csv", "--json", document, "--out", tmp_path / "out", "--quiet")
    found = aibo_fit.drop("data/q1.csv")
    assert found.to_json().encode() == document.read_bytes()
    assert found.to_html() == (tmp_path / "out/report.html").read_text()
    assert "Coulomb friction 0.00100 N m" in found.sentence


@pytest.mark.parametrize("study", ["data/examples/delay/study.toml", "data/examples/arm/study.toml"])
def test_check_is_the_same_document(program, tmp_path, study):
    document = tmp_path / "check.json"
    told = program("check", study, "--json", document).stdout
    found = aibo_fit.check(study)
    assert found.to_json().encode() == document.read_bytes()
    assert told.startswith(str(found))


WRONG = [
    ("schema = 1\n[joint]\nname = 'a'\ninertia = -1.0\nmoment = 0.1\ncoulomb = 0.0\nviscous = 0.0\n", "inertia", 3),
    ("schema = 1\n[joint\n", "line 2", 3),
    ("schema = 1\n[robot]\nmodel = 'absent.urdf'\nscenario = 'fixed'\n[[log]]\nfile = 'a.csv'\nrole = 'fit'\n", "a.csv", 5),
]


@pytest.mark.parametrize("text, named, code", WRONG)
def test_errors_have_the_words_of_the_program(program, tmp_path, text, named, code):
    study = tmp_path / "study.toml"
    study.write_text(text)
    with pytest.raises(aibo_fit.Error) as raised:
        aibo_fit.gap(study)
    assert named in str(raised.value)
    said = program("gap", study, "--out", tmp_path / "out", code=code).stderr
    assert said == f"error: {raised.value}\n"
    assert isinstance(raised.value, ValueError)


@pytest.mark.parametrize("budget", [0.0, -1.0, float("nan"), float("inf"), 1e19])
def test_a_time_that_is_none_is_refused_in_the_words_of_the_program(program, budget):
    study = "data/examples/delay/study.toml"
    with pytest.raises(aibo_fit.Error, match="expected more than 0 s and no more than a year"):
        aibo_fit.gap(study, budget=budget)
    said = program("gap", study, f"--budget={budget}s", code=2).stderr
    assert "expected more than 0 s and no more than a year" in said


def test_the_program_comes_with_the_wheel(program):
    assert program("--version").stdout.splitlines()[0] == f"aibo-fit {aibo_fit.__version__}"
    assert "Exit codes" in program("--help").stdout
    assert "unexpected argument" in program("gap", "--nonsense", code=2).stderr
