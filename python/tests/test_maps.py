import pickle

import numpy as np
import pytest

import mica


def slopes(height=6, width=4, channels=2, dtype=np.float64):
    values = np.linspace(-0.4, 0.4, height * width * channels, dtype=dtype).reshape(height, width, channels)
    if channels == 3:
        values[..., 2] = 0.7
    return values


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_keeps_the_projections_that_it_is_given(dtype):
    given = slopes(dtype=dtype)
    map = mica.NormalMap(given)
    assert (map.height, map.width) == (6, 4)
    assert map.array.dtype == np.float64
    np.testing.assert_array_equal(map.array, given)


def test_vectors_are_normalised():
    given = 3 * slopes(channels=3)
    expected = given[..., :2] / np.linalg.norm(given, axis=-1, keepdims=True)
    np.testing.assert_allclose(mica.NormalMap(given).array, expected, rtol=1e-14)


@pytest.mark.parametrize(
    "convert",
    [
        lambda a: a[:, ::-1][:, ::-1],
        lambda a: np.repeat(a, 2, axis=0)[::2],
        np.asfortranarray,
        lambda a: a.astype(">f8"),
        lambda a: a.tolist(),
    ],
    ids=["turned", "strided", "fortran", "big-endian", "lists"],
)
def test_takes_any_layout(convert):
    given = slopes()
    np.testing.assert_array_equal(mica.NormalMap(convert(given)).array, given)


def test_half_floats_and_big_endian_singles_are_converted():
    given = slopes(dtype=np.float32)
    np.testing.assert_array_equal(mica.NormalMap(given.astype(">f4")).array, given)
    half = given.astype(np.float16)
    np.testing.assert_array_equal(mica.NormalMap(half).array, half.astype(np.float64))


def test_takes_what_has_dlpack_alone():
    class Tensor:
        def __init__(self, array):
            self._array = array

        def __dlpack__(self, **options):
            return self._array.__dlpack__(**options)

        def __dlpack_device__(self):
            return self._array.__dlpack_device__()

    given = slopes()
    np.testing.assert_array_equal(mica.NormalMap(Tensor(given)).array, given)


@pytest.mark.parametrize(
    ("normals", "words"),
    [
        (np.zeros((4, 4)), r"2 dimensions; expected \(height, width, 2 or 3\)"),
        (np.zeros((4, 4, 4)), "4 channels; expected 2"),
        (np.zeros((0, 4, 2)), "4 x 0 texels; expected 1"),
        (np.full((2, 2, 2), np.nan), r"texel \(0, 0\): expected finite numbers"),
        (np.full((2, 2, 2), 0.9), r"texel \(0, 0\): expected s\^2 \+ t\^2 below 1"),
        (np.zeros((2, 2, 3)), "a normal of some length"),
        (np.full((2, 2, 3), -1.0), "points up"),
        (np.zeros((2, 2, 2), complex), "found complex128; expected float32 or float64"),
        (np.zeros((2, 2, 2), bool), "found bool; expected float32 or float64"),
        (np.full((2, 2, 2), "a"), "found <U1; expected float32 or float64"),
        ([[1, 2], [3]], "normals: "),
        (object(), "found object; expected float32 or float64"),
    ],
)
def test_refuses_what_is_no_map(normals, words):
    with pytest.raises(mica.UsageError, match=words):
        mica.NormalMap(normals)


def test_names_the_texel_that_is_wrong():
    normals = slopes()
    normals[5, 2] = np.inf
    with pytest.raises(mica.UsageError, match=r"normal of texel \(2, 5\)"):
        mica.NormalMap(normals)


def test_refuses_an_unknown_interpolation():
    with pytest.raises(mica.UsageError, match="found 'linear'; expected one of nearest, bilinear, bicubic"):
        mica.NormalMap(slopes(), "linear")


@pytest.mark.parametrize("interpolation", ["nearest", "bilinear", "bicubic"])
def test_knows_its_interpolation(interpolation):
    assert mica.NormalMap(slopes(), interpolation).interpolation == interpolation
    assert (
        mica.NormalMap.generate("spectrum", resolution=16, interpolation=interpolation).interpolation == interpolation
    )


def test_synthesised_maps_have_the_settings_that_they_are_given():
    a = mica.NormalMap.generate("spectrum", resolution=32, seed=1)
    assert a.array.shape == (32, 32, 2)
    np.testing.assert_array_equal(a, mica.NormalMap.generate("spectrum", resolution=np.int64(32), seed=1))
    assert not np.array_equal(a, mica.NormalMap.generate("spectrum", resolution=32, seed=2))


@pytest.mark.parametrize(
    ("kind", "settings", "words"),
    [
        ("spektrum", {}, "spektrum"),
        ("spectrum", {"rms_slope": 99}, "rms_slope"),
        ("spectrum", {"rms_slop": 0.1}, "rms_slop"),
        ("spectrum", {"rms_slope": object()}, "rms_slope: found a object"),
    ],
)
def test_refuses_what_cannot_be_synthesised(kind, settings, words):
    with pytest.raises(mica.UsageError, match=words):
        mica.NormalMap.generate(kind, **settings)


def test_loads_a_file_as_it_is_told(map_file):
    map = mica.NormalMap.load(map_file, encoding="signed", green="up", interpolation="nearest")
    down = mica.NormalMap.load(str(map_file), encoding="signed", green="down")
    assert map.interpolation == "nearest"
    np.testing.assert_allclose(map.array[..., 1], -down.array[..., 1], atol=1e-7)


def test_a_file_that_is_missing_is_an_os_error(tmp_path):
    with pytest.raises(mica.FileError, match="missing.exr") as raised:
        mica.NormalMap.load(tmp_path / "missing.exr", encoding="signed")
    assert isinstance(raised.value, OSError)


def test_a_file_that_is_damaged_is_named(tmp_path):
    path = tmp_path / "damaged.exr"
    path.write_bytes(b"no picture")
    with pytest.raises(mica.FileError, match="damaged.exr"):
        mica.NormalMap.load(path)


def test_a_wrong_setting_of_a_file_is_a_value_error(map_file):
    with pytest.raises(ValueError, match="encoding"):
        mica.NormalMap.load(map_file, encoding="slopes")


def test_its_array_cannot_be_written_to(noise):
    assert not noise.array.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        noise.array[0, 0] = 0


def test_its_array_is_its_own_memory_and_outlives_it():
    map = mica.NormalMap.generate("spectrum", resolution=32)
    array = map.array
    assert array.ctypes.data == map.array.ctypes.data
    expected = array.copy()
    del map
    np.testing.assert_array_equal(array, expected)


def test_is_an_array_to_numpy_and_to_dlpack(noise):
    np.testing.assert_array_equal(np.asarray(noise), noise.array)
    assert np.asarray(noise, np.float32).dtype == np.float32
    assert np.array(noise, copy=True).flags.writeable
    copy = np.from_dlpack(noise)
    np.testing.assert_array_equal(copy, noise.array)
    assert copy.ctypes.data != noise.array.ctypes.data


def test_goes_through_pickle(noise):
    copy = pickle.loads(pickle.dumps(noise))
    np.testing.assert_array_equal(copy.array, noise.array)
    assert copy.interpolation == noise.interpolation


def test_says_what_it_is(noise):
    assert repr(noise) == "NormalMap(64 x 64 texels, bilinear)"


def test_covariance_is_that_of_turned_axes():
    map = mica.NormalMap(np.zeros((32, 64, 2)))
    np.testing.assert_allclose(map.covariance(2), np.diag([(2 / 64) ** 2, (2 / 32) ** 2]), rtol=1e-14)
    turned = map.covariance((4, 1, 90))
    np.testing.assert_allclose(turned, np.diag([(1 / 64) ** 2, (4 / 32) ** 2]), atol=1e-12)


@pytest.mark.parametrize("sigma", [(1, 2), float("nan"), (1, 1, 1, 1)])
def test_covariance_refuses_other_numbers(noise, sigma):
    with pytest.raises(mica.UsageError, match="sigma: found"):
        noise.covariance(sigma)
