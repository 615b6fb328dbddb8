"""The module and the command line answer with the same bits."""

import json

import numpy as np
import pytest

import mica
from conftest import rows_of, run_command

COUNT = 2000
METHODS = ["triangles", "gaussians", "beckmanns", "smooth", "pyramid", "auto", "normalmap", "reference", "grid"]


@pytest.fixture(scope="module")
def loaded(map_file):
    return mica.NormalMap.load(map_file, encoding="signed")


def answers_of_command(tmp_path, rows, *options):
    np.save(tmp_path / "q.npy", rows)
    out = tmp_path / "d.npy"
    done = run_command("eval", *options, "--queries", tmp_path / "q.npy", "-o", out)
    assert done.returncode == 0, done.stderr
    return np.load(out)


def map_options(method, map_file):
    return [] if method == "grid" else ["--map", map_file, "--encoding", "signed"]


def evaluator_of(method, loaded, **settings):
    return mica.Grid(**settings) if method == "grid" else mica.Evaluator(loaded, method, **settings)


def test_every_method_is_compared():
    with_densities = {name for name in mica.methods() if mica._mica.method_info(name).has_densities}
    assert with_densities <= set(METHODS)


@pytest.mark.parametrize("method", METHODS)
def test_densities(tmp_path, loaded, map_file, method):
    if not mica._mica.method_info(method).has_densities:
        pytest.skip("it has no densities")
    rows = rows_of(50 if method == "reference" else COUNT, 64)
    expected = answers_of_command(tmp_path, rows, "--ndf", method, *map_options(method, map_file))
    np.testing.assert_array_equal(evaluator_of(method, loaded).eval(rows), expected)
    assert expected.max() > 0


def test_singles_with_settings_and_one_roughness(tmp_path, loaded, map_file):
    rows = rows_of(COUNT, 64)[:, :7].astype(np.float32)
    options = ["--ndf", "gaussians", "--elements", "2", "--roughness", "0.03"]
    expected = answers_of_command(tmp_path, rows, *options, *map_options("gaussians", map_file))
    np.testing.assert_array_equal(mica.Evaluator(loaded, "gaussians", elements=2).eval(rows, 0.03), expected)


def test_tolerance_of_auto(tmp_path, loaded, map_file):
    rows = rows_of(COUNT, 64)
    options = ["--ndf", "auto", "--tolerance", "0.1"]
    expected = answers_of_command(tmp_path, rows, *options, *map_options("auto", map_file))
    np.testing.assert_array_equal(mica.Evaluator(loaded, tolerance=0.1).eval(rows), expected)


def directions(count, seed):
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    vectors[:, 2] = abs(vectors[:, 2]) + 0.2
    return vectors


@pytest.mark.parametrize("method", ["beckmanns", "cavities", "normalmap", "grid"])
@pytest.mark.parametrize("quantity", ["brdf", "energy", "sample"])
def test_patches(tmp_path, loaded, map_file, method, quantity):
    rows = rows_of(300, 64)
    parts = rows[:, :2], rows[:, 2:5], directions(300, 1)
    light, roughness = directions(300, 2), rows[:, 7]
    table = np.column_stack([*parts, *([light] if quantity == "brdf" else []), roughness])
    options = [
        "--ndf",
        method,
        "--quantity",
        quantity,
        *(["--seed", "7"] if quantity == "sample" and method != "grid" else []),
    ]
    expected = answers_of_command(tmp_path, table, *options, *map_options(method, map_file))
    evaluator = evaluator_of(method, loaded)
    if quantity == "brdf":
        found = evaluator.brdf(*parts, light, roughness)
    elif quantity == "energy":
        found = np.stack(evaluator.energy(*parts, roughness), axis=-1)
    else:
        samples = evaluator.sample(*parts, roughness, seed=1 if method == "grid" else 7)
        found = np.column_stack(samples)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("method", ["triangles", "auto", "pyramid"])
def test_images(tmp_path, loaded, map_file, method):
    centers = np.random.default_rng(5).uniform(size=(20, 2))
    np.save(tmp_path / "c.npy", centers)
    options = ["--sigma", "4,2,30", "--roughness", "0.05", "--ndf", method, "--size", "32", "-o", tmp_path / "i.npy"]
    done = run_command("ndf", *map_options(method, map_file), "--centers", tmp_path / "c.npy", *options)
    assert done.returncode == 0, done.stderr
    images = mica.pndf(loaded, centers, (4, 2, 30), 0.05, size=32, ndf=method)
    np.testing.assert_array_equal(images.reshape(20, -1), np.load(tmp_path / "i.npy"))


@pytest.mark.parametrize(
    ("name", "more"),
    [
        ("first", {"surface.bumps.resolution": 256, "image.exposure": 1.5, "image.tone_map": "filmic"}),
        ("glitter", {}),
    ],
)
def test_jobs(tmp_path, root, name, more):
    job = root / "data" / "jobs" / f"{name}.toml"
    small = {"image.width": 32, "image.height": 18, "image.subpixels": 1, **more}
    words = [word for key, value in small.items() for word in ("--set", f"{key}={json.dumps(value)}")]  # TOML, here
    done = run_command("render", job, *words, "--quiet", "-o", tmp_path / "a.exr")
    assert done.returncode == 0, done.stderr
    image = mica.Job.load(job, set=small).render()
    image.write(tmp_path / "b.exr")
    image.write(tmp_path / "b.png")
    for ending in (".exr", ".png"):
        assert (tmp_path / f"b{ending}").read_bytes() == (tmp_path / f"a{ending}").read_bytes()


@pytest.mark.parametrize(
    ("arguments", "ask"),
    [
        (["--map", "nowhere.exr"], lambda: mica.NormalMap.load("nowhere.exr")),
    ],
)
def test_errors_have_the_same_words(tmp_path, arguments, ask):
    np.save(tmp_path / "q.npy", rows_of(1, 64))
    done = run_command(
        "eval", *arguments, "--ndf", "triangles", "--queries", tmp_path / "q.npy", "-o", tmp_path / "d.npy"
    )
    with pytest.raises(mica.Error) as raised:
        ask()
    assert done.stderr.strip() == f"mica: {raised.value}"
    assert done.returncode == 4


def test_python_m_mica_is_the_command_line(tmp_path):
    import subprocess
    import sys

    def run(*words):
        return subprocess.run([sys.executable, "-m", "mica", *words], capture_output=True, text=True, check=False)

    done = run("--version")
    assert done.returncode == 0
    assert mica.__version__ in done.stdout
    done = run("eval", "--ndf", "nothing")
    assert done.returncode == 2
    assert done.stdout == ""
    done = run("check", str(tmp_path / "missing.toml"))
    assert done.returncode == 4
    assert "missing.toml" in done.stderr
    assert run("devices").stdout == run_command("devices").stdout


def test_signals_end_the_command_line_as_they_end_the_command(tmp_path, map_file):
    import signal
    import subprocess
    import sys

    np.save(tmp_path / "q.npy", np.repeat([[0.5, 0.5, 0.001, 0, 0.001, 0.1, 0.1, 0.02]], 10**5, axis=0))
    words = ["eval", "--map", map_file, "--ndf", "reference", "--queries", tmp_path / "q.npy", "-o", tmp_path / "d.npy"]
    running = subprocess.Popen([sys.executable, "-m", "mica", *map(str, words)], stderr=subprocess.PIPE, text=True)
    progress = running.stderr.readline()  # it is at work
    running.send_signal(signal.SIGINT)
    _, log = running.communicate(timeout=20)
    assert running.returncode == 130, progress + log
    assert "nothing unfinished was written" in log
    assert "Traceback" not in log
    assert not (tmp_path / "d.npy").exists()


def test_bench_is_the_commands(tmp_path):
    with pytest.raises(mica.UsageError, match="slow"):
        mica.bench("slow")
    with pytest.raises(mica.DeviceError):
        mica.bench("tiny", device=1000)
    with pytest.raises(mica.DeviceError):
        mica.selftest(device=1000)
