import numpy as np
import pytest

import mica


def test_a_dict_is_a_job(job):
    made = mica.Job(job)
    assert (made.width, made.height) == (24, 16)
    assert list(made.frames) == [0]
    assert "auto on surface bumps" in made.plan()
    assert repr(made) == "Job(24 x 16 pixels)"


def test_arrays_and_numpy_numbers_stand_for_lists_and_numbers(job):
    job["camera"]["position"] = np.array([0, -3.2, 1.4])
    job["image"]["width"] = np.int32(12)
    assert mica.Job(job).width == 12


def test_images_are_dicts_of_arrays_with_metadata(job):
    image = mica.Job(job).render()
    assert list(image)[:3] == ["R", "G", "B"]
    assert "ndf.Y" in image
    assert len(image) == image.pixels.shape[-1]
    assert image["R"].shape == (16, 24)
    assert image["R"].dtype == np.float32
    assert image["R"].max() > 0
    assert image.rgb.shape == (16, 24, 3)
    assert image.metadata["mica:version"] == mica.__version__
    assert repr(image).startswith("Image(24 x 16 pixels: R, G, B")
    with pytest.raises(KeyError):
        image["Q"]


def test_the_same_job_has_the_same_bits(job):
    made = mica.Job(job)
    image = made.render()
    np.testing.assert_array_equal(made.render(), image)
    np.testing.assert_array_equal(mica.Job(job).render(), image)


def test_progress_counts_rows(job):
    seen = []
    mica.Job(job).render(progress=lambda done, rows: seen.append((done, rows)))
    assert seen[-1] == (16, 16)
    assert seen == sorted(seen)


def test_frames_come_one_by_one(job):
    job["frames"] = {"range": [0, 2]}
    job["camera"]["keys"] = [{"frame": 0}, {"frame": 2, "position": [1, -3.2, 1.4]}]
    made = mica.Job(job)
    assert list(made.frames) == [0, 1, 2]
    images = list(made.render(made.frames))
    assert [image.metadata["mica:frame"] for image in images] == ["0", "1", "2"]
    assert not np.array_equal(images[0], images[2])
    np.testing.assert_array_equal(made.render(2), images[2])
    np.testing.assert_array_equal(made.render(), images[0])
    assert "frames 0 to 2" in repr(made)


def test_refuses_a_frame_that_there_is_not(job):
    with pytest.raises(mica.UsageError, match="frame 5: the job has frames 0 to 0"):
        mica.Job(job).render(5)


def test_says_everything_that_is_wrong(job):
    job["image"]["width"] = -3
    job["shape"] = 7
    with pytest.raises(mica.UsageError) as raised:
        mica.Job(job)
    assert "width" in str(raised.value)
    assert "shape" in str(raised.value)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"image": 3j}, "image: found a complex; expected a number"),
        ({"light": [{"type": object}]}, r"light\[0\].type: found a type"),
        ({"shape": [{1: 2}]}, r"shape\[0\]: found the key 1; expected a text"),
    ],
)
def test_refuses_what_a_job_file_cannot_say(job, change, words):
    with pytest.raises(mica.UsageError, match=words):
        mica.Job({**job, **change})


@pytest.mark.parametrize("text", ['quo"te', "back\\slash", "new\nline", "tab\tand ü €", "\x7f\x01"])
def test_texts_of_any_kind_stay_what_they_are(text):
    import tomllib

    from mica._settings import toml_document

    assert tomllib.loads(toml_document({"a": {"b": [text, 1.5, 1e-9, True, -3]}})) == {
        "a": {"b": [text, 1.5, 1e-9, True, -3]}
    }


def test_sets_values_in_place_of_the_jobs(job, tmp_path):
    changed = mica.Job(job, set={"image.width": 12, "camera": {"fov": 30}, "light.0.intensity": (9, 9, 9)})
    assert changed.width == 12
    job["image"]["width"], job["camera"]["fov"], job["light"][0]["intensity"] = 12, 30, [9, 9, 9]
    np.testing.assert_array_equal(changed.render(), mica.Job(job).render())
    with pytest.raises(mica.UsageError, match="image.wdth"):
        mica.Job(job, set={"image.wdth": 12})


def test_a_job_file_that_is_missing_is_an_os_error(tmp_path):
    with pytest.raises(mica.FileError, match="missing.toml") as raised:
        mica.Job.load(tmp_path / "missing.toml")
    assert isinstance(raised.value, OSError)


def test_a_job_file_with_a_mistake_is_named_with_its_place(tmp_path):
    path = tmp_path / "wrong.toml"
    path.write_text("image = { width = 8 \n")
    with pytest.raises(mica.UsageError, match=r"wrong.toml:\d+"):
        mica.Job.load(path)


def test_files_of_a_job_are_relative_to_its_folder(job, map_file):
    job["surface"]["bumps"] = {"file": map_file.name, "encoding": "signed"}
    assert mica.Job(job, folder=map_file.parent).render()["R"].max() > 0
    with pytest.raises(mica.UsageError, match="found no file"):
        mica.Job(job)


def test_writes_files_and_refuses_others(job, tmp_path):
    image = mica.Job(job).render()
    image.write(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(mica.UsageError, match="ends in .exr or .png"):
        image.write(tmp_path / "a.jpg")
    with pytest.raises(mica.FileError, match="nowhere"):
        image.write(tmp_path / "nowhere" / "a.exr")
    image.tone_map = "sepia"
    with pytest.raises(mica.UsageError, match='tone map "sepia"'):
        image.write(tmp_path / "b.png")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png"]


def test_notebooks_show_images(job):
    image = mica.Job(job).render()
    assert image._repr_png_().startswith(b"\x89PNG")
    assert mica.Image({"D": np.eye(4)})._repr_png_().startswith(b"\x89PNG")


def test_images_are_made_of_arrays(tmp_path):
    image = mica.Image({"R": np.eye(3), "G": np.zeros((3, 3)), "B": np.ones((3, 3), np.float32)}, {"by": "test"})
    np.testing.assert_array_equal(image["R"], np.eye(3))
    assert np.asarray(image).shape == (3, 3, 3)
    assert np.from_dlpack(image).shape == (3, 3, 3)
    image["G"][0, 1] = 2
    assert image.pixels[0, 1, 1] == 2
    image.write(tmp_path / "a.exr")
    copy = mica.NormalMap.load(tmp_path / "a.exr", encoding="slope", channels="R,G")
    assert copy.width == 3


@pytest.mark.parametrize(
    "channels", [{}, {"R": np.zeros(3)}, {"R": np.zeros((2, 2)), "G": np.zeros((2, 3))}, {"R": np.zeros((0, 2))}]
)
def test_refuses_images_without_a_shape(channels):
    with pytest.raises(mica.UsageError, match=r"channels: found .*; expected \(height, width\)"):
        mica.Image(channels)


def test_refuses_light_that_there_is_not():
    with pytest.raises(mica.UsageError, match="rgb: the image has the channels D"):
        mica.Image({"D": np.eye(2)}).rgb
