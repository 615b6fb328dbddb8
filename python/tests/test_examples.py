"""The examples run, and their types are right."""

import importlib.util
import subprocess
import sys

import numpy as np
import pytest

from conftest import run_command


@pytest.fixture
def example(root, tmp_path):
    """Runs one in a folder of its own; what it printed."""

    def run(name, *arguments):
        program = [sys.executable, str(root / "python" / "examples" / name), *map(str, arguments)]
        done = subprocess.run(program, capture_output=True, text=True, check=False, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


def test_every_example_is_run(root):
    names = {path.name for path in (root / "python" / "examples").glob("*.py")}
    assert names == {"pndf_sheet.py", "speed_and_error.py", "training_set.py", "beside_mitsuba.py", "notebook.py", "glint_layer.py"}


def test_sheet(example, tmp_path):
    pytest.importorskip("matplotlib")
    example("pndf_sheet.py")
    assert (tmp_path / "sheet.png").read_bytes().startswith(b"\x89PNG")


def test_speed_and_error(example):
    lines = example("speed_and_error.py", 2000).splitlines()
    errors = {words[0]: float(words[2]) for words in (line.split() for line in lines[1:])}
    assert errors["triangles"] == 0
    assert 0 < errors["pyramid"] < 0.05
    assert 0 < errors["gaussians"] < 0.1


def test_glint_layer_is_that_of_the_command(example, tmp_path):
    assert "to be added" in example("glint_layer.py", 48)
    words = ["gbuffer.exr", "--scene", "scene.toml", "-o", "command.exr", "--aovs", "D,coverage"]
    done = run_command("glints", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "layer.exr").read_bytes() == (tmp_path / "command.exr").read_bytes()


def test_notebook(example):
    assert "of the normals" in example("notebook.py")


def test_training_set_goes_on_where_it_was(example, tmp_path):
    example("training_set.py", "whole", 600, 16)
    images = np.load(tmp_path / "whole" / "images.npy")
    assert images.shape == (600, 16, 16)
    assert len((tmp_path / "whole" / "images.csv").read_text().splitlines()) == 601
    # As a run leaves it that was stopped within its second batch.
    half = np.load(tmp_path / "whole" / "images.npy")
    half[250:] = -1
    (tmp_path / "part").mkdir()
    np.save(tmp_path / "part" / "images.npy", half)
    (tmp_path / "part" / "done.txt").write_text("250")
    example("training_set.py", "part", 600, 16)
    for name in ("images.npy", "images.csv"):
        assert (tmp_path / "part" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


def test_beside_mitsuba(example):
    if importlib.util.find_spec("mitsuba") is None:
        pytest.skip("mitsuba is not installed")
    words = example("beside_mitsuba.py").splitlines()[0]
    assert float(words.split("differ by ")[1].rstrip("%")) < 3


def test_types_are_right_by_mypy_strict(root, tmp_path):
    pytest.importorskip("mypy")
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import mica\nmica.pndf(1, [[0, 0]], 'a', 0.1).nothing\n")
    mypy = [sys.executable, "-m", "mypy", "--config-file", root / "pyproject.toml", "--cache-dir", tmp_path / "cache"]

    def check(*files):
        return subprocess.run([*mypy, *files], capture_output=True, text=True, check=False, cwd=tmp_path)

    for files in (sorted((root / "python" / "examples").glob("*.py")), ["-p", "mica"]):
        done = check(*files)
        assert done.returncode == 0, done.stdout + done.stderr
    done = check(wrong)
    assert done.stdout.count("[arg-type]") == 2, done.stdout
    assert "[attr-defined]" in done.stdout
