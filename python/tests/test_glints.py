"""Layers of glints: the same options as `mica glints`, and its refusals; the layer itself is tested by its example."""

import importlib.util
import json

import pytest

import mica
from conftest import run_command


@pytest.fixture
def files(root, tmp_path, monkeypatch):
    """The example's G-buffer, camera and scene, in the working folder."""
    specification = importlib.util.spec_from_file_location("layer", root / "python" / "examples" / "glint_layer.py")
    example = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(example)
    monkeypatch.chdir(tmp_path)
    channels, _ = example.draw(32)
    mica.Image(channels).write("g.exr")
    (tmp_path / "g.json").write_text(json.dumps(example.camera(32)))
    (tmp_path / "s.toml").write_text(example.SCENE)
    return tmp_path


def test_every_option_is_that_of_the_command(files):
    (files / "g.json").rename(files / "view.json")
    rows = []
    layer = mica.glints(
        "g.exr", "s.toml", "layer.exr", camera="view.json", preset="mitsuba", channels={"uv": "uv.U,uv.V"},
        other_ids="skip", filter="blackman-harris", filter_width=2, scale=4, per_lamp=True, aovs=["D", "footprint"],
        set={"material.paint.roughness": 0.05}, progress=lambda done, whole: rows.append((done, whole)),
    )  # fmt: skip
    words = "--camera view.json --preset mitsuba --channel uv=uv.U,uv.V --other-ids skip --filter blackman-harris"
    words += " --filter-width 2 --scale 4 --per-lamp --aovs D,footprint --set material.paint.roughness=0.05"
    done = run_command("glints", "g.exr", "--scene", "s.toml", "-o", "command.exr", *words.split(), cwd=files)
    assert done.returncode == 0, done.stderr
    assert (files / "layer.exr").read_bytes() == (files / "command.exr").read_bytes()
    assert rows[-1] == (8, 8)
    assert layer.channels[:4] == ["R", "G", "B", "A"]
    assert {"lamp.R", "D", "footprint.CUU"} <= set(layer.channels)
    assert layer.queries > 0
    assert layer.covered > layer.one_sided > 0
    assert layer.broken == layer.without_footprint == 0
    assert any("found the ids 1" in note for note in layer.notes)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"filter": "tent"}, "filter: found .tent."),
        ({"preset": "maya"}, "preset: found .maya."),
        ({"aovs": ["depth"]}, "aovs: found .depth."),
        ({"other_ids": "keep"}, "other_ids: found .keep."),
        ({"scale": 17}, "scale 17: expected 1 to 16"),
        ({"filter_width": 9}, "filter width 9: expected 0.1 to 8"),
        ({"filter": "blackman-harris", "scale": 2}, "standard deviation"),
        ({"channels": {"colour": "R"}}, "expected ROLE=NAME"),
    ],
)
def test_wrong_options(files, options, message):
    with pytest.raises(mica.UsageError, match=message):
        mica.glints("g.exr", "s.toml", "layer.exr", **options)
    assert not (files / "layer.exr").exists()


def test_wrong_files(files):
    with pytest.raises(mica.FileError, match="none.exr"):
        mica.glints("none.exr", "s.toml", "layer.exr", camera="g.json")
    for path in ("g.exr", "g.json", "s.toml"):
        before = (files / path).read_bytes()
        with pytest.raises(mica.UsageError, match="expected another name"):
            mica.glints("g.exr", "s.toml", files / path)
        assert (files / path).read_bytes() == before


def test_what_progress_raises_passes_through(files):
    def stop(done, whole):
        raise KeyError("enough")

    with pytest.raises(KeyError):
        mica.glints("g.exr", "s.toml", "layer.exr", progress=stop)
