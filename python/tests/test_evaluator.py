import numpy as np
import pytest

import mica
from conftest import rows_of


def call(evaluator, rows, **options):
    """The same queries by their parts."""
    return evaluator(rows[:, :2], rows[:, 2:5], rows[:, 5:7], rows[:, 7], **options)


def test_rows_and_parts_are_the_same_queries(triangles, rows):
    densities = triangles.eval(rows)
    assert densities.dtype == np.float32
    assert densities.shape == (len(rows),)
    assert densities.max() > 1
    np.testing.assert_array_equal(call(triangles, rows), densities)


def test_covariances_are_matrices_or_three_numbers(triangles, rows):
    matrices = rows[:, [2, 3, 3, 4]].reshape(-1, 2, 2)
    np.testing.assert_array_equal(triangles(rows[:, :2], matrices, rows[:, 5:7], rows[:, 7]), triangles.eval(rows))


@pytest.mark.parametrize(
    "convert",
    [
        np.asfortranarray,
        lambda rows: np.repeat(rows, 3, axis=0)[::3],
        lambda rows: rows[::-1].copy()[::-1],
        lambda rows: rows.astype(">f8"),
        lambda rows: rows.astype(np.longdouble),
        lambda rows: np.pad(rows, ((0, 0), (2, 3)))[:, 2:10],
        lambda rows: rows.tolist(),
    ],
    ids=["fortran", "strided", "backwards", "big-endian", "long", "part", "lists"],
)
def test_takes_any_layout(triangles, rows, convert):
    np.testing.assert_array_equal(triangles.eval(convert(rows)), triangles.eval(rows))


def test_takes_rows_at_any_address(triangles, rows):
    memory = np.empty(rows.nbytes + 1, np.uint8)
    unaligned = memory[1:].view(np.float64).reshape(rows.shape)
    unaligned[:] = rows
    assert not unaligned.flags.aligned
    np.testing.assert_array_equal(triangles.eval(unaligned), triangles.eval(rows))


def test_takes_fields_of_records(triangles, rows):
    """Whose numbers are no whole number of numbers apart."""
    records = np.zeros(len(rows), [("name", "S3"), ("query", np.float64, 8)])
    records["query"] = rows
    assert records["query"].strides[0] % 8 != 0
    np.testing.assert_array_equal(triangles.eval(records["query"]), triangles.eval(rows))


def test_singles_are_read_as_they_are(triangles, rows):
    single = rows.astype(np.float32)
    np.testing.assert_array_equal(triangles.eval(single), triangles.eval(single.astype(np.float64)))
    np.testing.assert_array_equal(triangles.eval(single.astype(">f4")), triangles.eval(single))


def test_roughness_is_of_all_rows_where_the_table_has_none(triangles, rows):
    rows = rows.copy()
    rows[:, 7] = 0.03
    np.testing.assert_array_equal(triangles.eval(rows[:, :7], roughness=0.03), triangles.eval(rows))


def test_lobes_and_turns_stand_in_rows_of_fourteen(triangles, rows):
    table = np.zeros((50, 14))
    table[:, :7] = rows[:50, :7]
    table[:, 7], table[:, 9] = 0.03**2, 0.02**2
    table[:, 10] = 0.5
    lobe, turn = table[:, 7:10], table[:, 10:].reshape(-1, 2, 2)
    densities = triangles(table[:, :2], table[:, 2:5], table[:, 5:7], turn=turn, lobe=lobe)
    np.testing.assert_array_equal(triangles.eval(table), densities)
    round_lobe = triangles(table[:, :2], table[:, 2:5], table[:, 5:7], 0.03)
    assert not np.array_equal(densities, round_lobe)
    matrix = 0.03**2 * np.eye(2)
    np.testing.assert_allclose(
        triangles(table[:, :2], table[:, 2:5], table[:, 5:7], lobe=matrix), round_lobe, rtol=1e-3, atol=1e-3
    )


def test_shapes_are_broadcast_together(triangles, noise):
    uv = np.random.default_rng(3).uniform(size=(3, 1, 2))
    half = np.linspace(-0.2, 0.2, 10).reshape(1, 5, 2)
    densities = triangles(uv, noise.covariance(3), half, roughness=0.03)
    assert densities.shape == (3, 5)
    one = triangles(uv[2, 0], noise.covariance(3), half[0, 4], 0.03)
    assert one.shape == ()
    assert one == densities[2, 4]


def test_nothing_asked_is_nothing_answered(triangles, noise):
    assert triangles.eval(np.empty((0, 8))).shape == (0,)
    assert triangles(np.empty((0, 2)), noise.covariance(3), [0, 0], 0.03).shape == (0,)


def test_answers_go_where_the_caller_wants_them(triangles, rows):
    out = np.full(len(rows), -1, np.float32)
    assert triangles.eval(rows, out=out) is out
    np.testing.assert_array_equal(out, triangles.eval(rows))


@pytest.mark.parametrize(
    "out",
    [
        np.empty(500, np.float64),
        np.empty(499, np.float32),
        np.empty(1000, np.float32)[::2],
        np.empty(500, ">f4"),
        np.frombuffer(bytes(2000), np.float32),
        [0.0] * 500,
    ],
    ids=["double", "short", "strided", "big-endian", "read-only", "list"],
)
def test_refuses_room_that_does_not_fit(triangles, rows, out):
    with pytest.raises(mica.UsageError, match=r"out: found .*; expected .*float32 of shape \(500,\)"):
        triangles.eval(rows, out=out)


def test_batches_make_no_difference(triangles, rows):
    densities = triangles.eval(rows)
    parts = [triangles.eval(rows[n : n + 7]) for n in range(0, len(rows), 7)]
    np.testing.assert_array_equal(np.concatenate(parts), densities)


def test_torch_like_tensors_are_taken_by_dlpack(triangles, rows):
    class Tensor:
        def __dlpack__(self, **options):
            return rows.__dlpack__(**options)

        def __dlpack_device__(self):
            return rows.__dlpack_device__()

    np.testing.assert_array_equal(triangles.eval(Tensor()), triangles.eval(rows))


@pytest.mark.parametrize(
    ("place", "number", "words"),
    [
        ((7, 2), -1, "query 7: "),
        ((0, 0), np.nan, "query 0: "),
        ((9, 7), 2, "query 9: .*roughness"),
        ((9, 7), 1e-9, "query 9: .*roughness"),
        ((499, 5), np.inf, "query 499: "),
    ],
)
def test_names_the_query_that_cannot_be_answered(triangles, rows, place, number, words):
    rows = rows.copy()
    rows[place] = number
    out = np.full(len(rows), -1, np.float32)
    with pytest.raises(mica.UsageError, match=words):
        triangles.eval(rows, out=out)
    assert (out == -1).all(), "nothing is written"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([0.5], [1e-3, 0, 1e-3], [0, 0], 0.1), r"uv: found shape \(1,\); expected \(..., 2\)"),
        ((0.5, [1e-3, 0, 1e-3], [0, 0], 0.1), r"uv: found shape \(\)"),
        (([0, 0], 1e-3, [0, 0], 0.1), r"cov: found shape \(\); expected \(..., 2, 2\) or \(..., 3\)"),
        (([0, 0], [[1e-3, 1e-4], [0, 1e-3]], [0, 0], 0.1), "cov: found a matrix that is not symmetric"),
        (([0, 0], [1e-3, 0, 1e-3], [0, 0, 1], 0.1), r"half: found shape \(3,\)"),
        (([0, 0], [1e-3, 0, 1e-3], [0, 0]), "roughness: found none"),
        ((np.zeros((3, 2)), [1e-3, 0, 1e-3], np.zeros((4, 2)), 0.1), "do not go together"),
        ((["a", "b"], [1e-3, 0, 1e-3], [0, 0], 0.1), "uv: found <U1"),
        (([0, 0], [1e-3, 0, 1e-3], [1j, 0], 0.1), "half: found complex128"),
    ],
)
def test_refuses_parts_that_are_wrong(triangles, arguments, words):
    with pytest.raises(mica.UsageError, match=words):
        triangles(*arguments)


@pytest.mark.parametrize("shape", [(8,), (3, 9), (2, 3, 8), (3, 6)])
def test_refuses_tables_of_other_shapes(triangles, shape):
    with pytest.raises(mica.UsageError, match=r"queries: found shape .*; expected \(rows, 7\)"):
        triangles.eval(np.zeros(shape))


def test_refuses_a_roughness_beside_a_lobe(triangles):
    with pytest.raises(mica.UsageError, match="roughness: found a lobe besides"):
        triangles([0, 0], [1e-3, 0, 1e-3], [0, 0], 0.1, lobe=[1e-3, 0, 1e-3])


@pytest.mark.parametrize(
    ("name", "settings", "words"),
    [
        ("triangle", {}, "triangle"),
        ("grid", {}, "grid needs no map"),
        ("gaussians", {"element": 2}, 'gaussians: found the setting "element"'),
        ("gaussians", {"elements": 9}, "elements"),
        ("gaussians", {"tolerance": 0.01}, "tolerance"),
        ("auto", {"tolerance": "small"}, "tolerance"),
        ("beckmanns", {"masking": "none"}, "masking"),
        ("gaussians", {"elements": {}}, "elements: found a dict"),
    ],
)
def test_refuses_methods_and_settings_that_there_are_not(noise, name, settings, words):
    with pytest.raises(mica.UsageError, match=words):
        mica.Evaluator(noise, name, **settings)


def test_refuses_a_method_without_its_map(noise):
    with pytest.raises(mica.UsageError, match="triangles needs a map"):
        mica.Evaluator(None, "triangles")
    with pytest.raises(mica.UsageError, match="map: found a ndarray; expected a NormalMap"):
        mica.Evaluator(noise.array)


def test_a_device_that_there_is_not_is_a_runtime_error(noise):
    with pytest.raises(mica.DeviceError) as raised:
        mica.Evaluator(noise, "triangles", device=1000)
    assert isinstance(raised.value, RuntimeError)


def test_what_a_method_lacks_is_said(noise, triangles, rows):
    with pytest.raises(mica.UsageError, match="triangles"):
        triangles.brdf([0, 0], [1e-3, 0, 1e-3], [0, 0, 1], [0, 0, 1], 0.1)
    cavities = mica.Evaluator(noise, "cavities")
    with pytest.raises(mica.UsageError, match="cavities"):
        cavities.eval(rows)
    with pytest.raises(mica.UsageError, match="gaussians does not tell"):
        gaussians = mica.Evaluator(noise, "gaussians")
        gaussians.error(rows, gaussians.eval(rows))


def test_errors_of_triangles_are_a_share_of_the_density(triangles, rows):
    densities = triangles.eval(rows)
    np.testing.assert_allclose(triangles.error(rows, densities), 1e-4 * densities, rtol=1e-5)
    with pytest.raises(mica.UsageError, match=r"densities: found shape \(3,\); expected \(500,\)"):
        triangles.error(rows, densities[:3])


def test_auto_keeps_its_tolerance_and_tells_its_choices(noise, triangles):
    rows = rows_of(3000, 64)
    auto = mica.Evaluator(noise, tolerance=0.05)
    assert auto.choices == []
    densities, expected = auto.eval(rows), triangles.eval(rows)
    assert np.linalg.norm(densities - expected) <= 0.05 * np.linalg.norm(expected)
    assert auto.choices
    assert all("texels" in choice for choice in auto.choices)
    assert np.isfinite(auto.error(rows, densities)).all()


def test_patches_reflect_no_more_than_they_get(noise):
    brdf = mica.Evaluator(noise, "beckmanns")
    cov, view = noise.covariance(4), [0.3, 0.0, 0.9]
    single, lost = brdf.energy([0.5, 0.5], cov, view, 0.05)
    assert 0.5 < single <= 1.001
    samples = brdf.sample(np.full((2000, 2), 0.5), cov, view, 0.05, seed=3)
    assert samples.light.shape == (2000, 3)
    drawn = samples.pdf > 0
    np.testing.assert_allclose(np.linalg.norm(samples.light[drawn], axis=-1), 1, rtol=1e-5)
    values = brdf.brdf([0.5, 0.5], cov, view, samples.light[drawn], 0.05, part="all")
    np.testing.assert_allclose(values / samples.pdf[drawn], samples.weight[drawn], rtol=2e-2)
    assert lost >= 0


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda e: e.brdf([0, 0], [1e-3, 0, 1e-3], [0, 0, 1], [0, 0, 0], 0.1), "query 0: i"),
        (lambda e: e.brdf([0, 0], [1e-3, 0, 1e-3], [0, 0, 1], [0, 0, 1], 0.1, part="some"), "part: found 'some'"),
        (lambda e: e.brdf([0, 0], [1e-3, 0, 1e-3], [0, 0], [0, 0, 1], 0.1), "view: found shape"),
        (lambda e: e.energy([0, 0], [1e-3, 0, 1e-3], [0, 0, np.nan], 0.1), "query 0: o"),
        (lambda e: e.sample([0, 0], [1e-3, 0, 1e-3], [0, 0, 1], 0.1, seed=-1), "seed: found -1"),
    ],
)
def test_refuses_wrong_questions_to_a_brdf(noise, ask, words):
    beckmanns = mica.Evaluator(noise, "beckmanns")
    with pytest.raises(mica.UsageError, match=words):
        ask(beckmanns)


def test_images_have_the_densities_of_their_pixels(triangles, noise):
    images = triangles.pndf([[0.2, 0.3], [0.7, 0.1]], 4, 0.05, size=16)
    assert images.shape == (2, 16, 16)
    assert images[0, 0, 0] == 0
    steps = (2 * np.arange(16) + 1) / 16 - 1
    half = np.stack(np.meshgrid(steps, -steps), axis=-1)
    inside = (half**2).sum(-1) < 1
    densities = triangles([0.7, 0.1], noise.covariance(4), half[inside], 0.05)
    np.testing.assert_allclose(images[1][inside], densities, rtol=2e-2, atol=1e-3)
    np.testing.assert_array_equal(mica.pndf(noise, [[0.7, 0.1]], 4, 0.05, size=16, ndf="triangles"), images[1:])


def test_images_have_a_roughness_each(triangles):
    centers = [[0.2, 0.3]] * 2
    images = triangles.pndf(centers, 4, [0.05, 0.1], size=16)
    np.testing.assert_array_equal(images[1:], triangles.pndf(centers[1:], 4, 0.1, size=16))


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        (([0.5, 0.5], 4, 0.1), {}, r"centers: found shape \(2,\); expected \(n, 2\)"),
        (([[0.5, 0.5]], (1, 2), 0.1), {}, "sigma: found"),
        (([[0.5, 0.5]], 4, [0.1, 0.2]), {}, "roughness: found shape"),
        (([[0.5, 0.5]], 4, 7), {}, "query 0: "),
        (([[0.5, 0.5]], 4, 0.1, 0), {}, "0 pixels a side"),
        (([[0.5, 0.5]], 4, 0.1), {"window": (0, 0)}, "window: found 2 numbers"),
        (([[0.5, 0.5]], 4, 0.1), {"window": (0, 0, -1)}, "positive radius"),
        (([[0.5, 0.5]], 4, 0.1, 8), {"out": np.empty((1, 9, 8), np.float32)}, "out: found"),
    ],
)
def test_refuses_images_of_nothing(triangles, arguments, options, words):
    with pytest.raises(mica.UsageError, match=words):
        triangles.pndf(*arguments, **options)


def test_a_grid_has_its_own_roughness():
    grid = mica.Grid(density=1e4, microroughness=0.02)
    given = grid([0.3, 0.2], 1e-4 * np.eye(2), [[0, 0], [0.1, 0]], 0.02)
    np.testing.assert_array_equal(grid([0.3, 0.2], 1e-4 * np.eye(2), [[0, 0], [0.1, 0]]), given)
    with pytest.raises(mica.UsageError, match="grid has no map"):
        grid.pndf([[0, 0]], 1, 0.1)
    with pytest.raises(mica.UsageError, match="densty"):
        mica.Grid(densty=3)


def test_pairs_of_a_setting_are_tuples():
    assert "alpha=(0.2, 0.4)" in repr(mica.Grid(alpha=(0.2, 0.4)))


def test_says_what_it_is(noise, triangles):
    assert "Evaluator('triangles', 64 x 64 texels; " in repr(triangles)
    assert "MiB on device 0" in repr(triangles)
    assert triangles.bytes > 0
    assert triangles.ndf == "triangles"
    assert triangles.map is noise


def test_methods_are_told_with_a_line_each():
    assert {"triangles", "auto", "grid", "reference"} <= set(mica.methods())
    assert all(mica.methods().values())


def test_devices_tell_what_they_are():
    device = mica.devices()[0]
    assert device.name
    assert device.compute_units > 0
    assert device.memory_bytes >= device.buffer_bytes > 0
    assert repr(device).startswith(f"DeviceInfo('{device.name}' of ")
