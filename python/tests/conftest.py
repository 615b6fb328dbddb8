"""What tests share. They run against the installed module and the command that MICA_COMMAND names, or its own."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mica

COMMAND = [os.environ["MICA_COMMAND"]] if "MICA_COMMAND" in os.environ else [sys.executable, "-m", "mica"]


def run_command(*arguments, **options):
    """`mica` with these arguments."""
    words = [*COMMAND, *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, check=False, **options)


def rows_of(count, size, seed=1):
    """Queries u v cuu cuv cvv s t roughness on a map of `size` texels: footprints of 1 to 6 texels, half vectors near
    the centre."""
    random = np.random.default_rng(seed)
    a, b = random.uniform(1, 6, (2, count)) / size
    rows = np.empty((count, 8))
    rows[:, 0:2] = random.uniform(-1, 2, (count, 2))
    rows[:, 2], rows[:, 4] = a * a, b * b
    rows[:, 3] = random.uniform(-0.8, 0.8, count) * a * b
    rows[:, 5:7] = random.normal(0, 0.15, (count, 2)).clip(-0.6, 0.6)
    rows[:, 7] = random.uniform(0.01, 0.06, count)
    return rows


@pytest.fixture(scope="session")
def noise():
    return mica.NormalMap.generate("spectrum", resolution=64, rms_slope=0.3)


@pytest.fixture(scope="session")
def rows():
    return rows_of(500, 64)


@pytest.fixture(scope="session")
def triangles(noise):
    return mica.Evaluator(noise, "triangles")


@pytest.fixture(scope="session")
def map_file(tmp_path_factory):
    """A map as a file, which the command reads as well."""
    path = tmp_path_factory.mktemp("maps") / "noise.exr"
    done = run_command("map", "spectrum", "--resolution", "64", "--rms-slope", "0.3", "-o", path)
    assert done.returncode == 0, done.stderr
    return path


JOB = {
    "image": {"width": 24, "height": 16, "subpixels": 1, "aovs": ["ndf"]},
    "camera": {"position": [0, -3.2, 1.4], "look_at": [0, 0, 0.45], "fov": 24},
    "surface": {"bumps": {"generate": "spectrum", "resolution": 64, "rms_slope": 0.3, "correlation": 8, "seed": 1}},
    "material": {"gold": {"surface": "bumps", "repeat": [6, 6], "specular": {"color": [1, 0.8, 0.4]}}},
    "shape": [{"type": "shell", "material": "gold"}],
    "light": [{"type": "point", "position": [1.6, -3.6, 3.4], "intensity": [25, 25, 25]}],
}


@pytest.fixture
def job():
    import copy

    return copy.deepcopy(JOB)


@pytest.fixture(scope="session")
def root():
    """The repository."""
    return Path(__file__).resolve().parents[2]


def pytest_sessionstart():
    assert Path(mica.__file__).is_relative_to(sys.prefix), f"{mica.__file__}: expected the installed module"
