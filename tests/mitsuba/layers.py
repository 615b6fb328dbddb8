"""Layers of glints over G-buffers that Mitsuba 3's integrator `aov` writes, for compare.py: a pixel's D against Mica's own
picture of the same shape.

The buffer is Mitsuba's as it is. Its sphere has v from the other pole than Mica's, so that there the layer's map is turned
over: rows, and the normals' v with them."""

import json
import math
import subprocess
from dataclasses import dataclass

import mitsuba as mi
import numpy as np

from pairs import T, rgb

WIDTH, HEIGHT, FOV = 96, 72, 24.0
AOVS = ("position", "uv", "geo_normal", "sh_normal", "dp_du", "dp_dv", "duv_dx", "duv_dy", "shape_index")
LAMP = [3.0, -3.0, 4.0]


@dataclass
class Layer:
    name: str
    shape: str  # Mica's
    theirs: dict  # Mitsuba's
    eye: list
    turned_over: bool  # v of the two
    mean: float  # largest mean relative difference of D where a pixel has all its neighbours
    alone: float  # likewise of pixels without neighbours, of which nobody knows how the normal turns
    largest: float = 0.02  # of any that has all of them


def layers():
    return [
        Layer("layer of a plane", 'type = "plane", size = 4', {"type": "rectangle", "to_world": T().scale([2, 2, 1])},
              [0.5, -4.0, 3.0], False, 0.001, 0.01),
        Layer("layer of a sphere", 'type = "sphere"', {"type": "sphere"}, [5.0, 1.0, 1.5], True, 0.002, math.inf),
    ]


def write_maps(folder):
    """Normals of random soft bumps, and the same turned over: fine, since texels are cut along one diagonal."""
    size = 512
    random = np.random.default_rng(1)
    frequency = np.fft.fftfreq(size) * size
    radius2 = frequency[:, None] ** 2 + frequency[None, :] ** 2
    height = np.fft.fft2(random.normal(size=(size, size))) * np.exp(-radius2 * (math.pi / 16) ** 2)
    along_u = np.fft.ifft2(height * 1j * frequency[None, :]).real
    along_v = np.fft.ifft2(height * -1j * frequency[:, None]).real  # rows run from the top
    scale = 0.2 / math.sqrt((along_u**2 + along_v**2).mean())
    normals = np.stack([-scale * along_u, -scale * along_v, np.ones_like(along_u)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    for name, pixels in (("soft", normals), ("soft_turned", normals[::-1] * [1, -1, 1])):
        mi.Bitmap(np.ascontiguousarray(0.5 + 0.5 * pixels, dtype=np.float32)).write(str(folder / f"{name}.exr"))


def camera(layer):
    """Blender's words for Mitsuba's camera, which looks along +z with +x to the left."""
    to_world = T().look_at(origin=layer.eye, target=[0, 0, 0], up=[0, 0, 1])
    turned = np.array(to_world.matrix).reshape(4, 4) @ np.diag([-1, 1, -1, 1])
    lamp = {"name": "lamp", "type": "POINT", "energy": 25 * 4 * math.pi, "radius": 0,
            "matrix_world": [[1, 0, 0, LAMP[0]], [0, 1, 0, LAMP[1]], [0, 0, 1, LAMP[2]], [0, 0, 0, 1]]}
    words = {"type": "PERSP", "sensor_fit": "VERTICAL", "angle_y": math.radians(FOV), "matrix_world": turned.tolist()}
    return {"resolution": [WIDTH, HEIGHT], "camera": words, "lamps": [lamp]}


def buffer(layer):
    """Mitsuba's bitmap: one sample through each pixel's centre."""
    film = {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "rfilter": {"type": "box"}, "pixel_format": "rgb",
            "component_format": "float32"}
    sensor = {"type": "perspective", "fov": FOV, "fov_axis": "y", "film": film,
              "to_world": T().look_at(origin=layer.eye, target=[0, 0, 0], up=[0, 0, 1]),
              "sampler": {"type": "stratified", "sample_count": 1, "jitter": False}}
    scene = mi.load_dict({"type": "scene", "integrator": {"type": "aov", "aovs": ",".join(f"{a}:{a}" for a in AOVS)},
                          "sensor": sensor, "shape": layer.theirs,
                          "light": {"type": "point", "position": LAMP, "intensity": rgb([25, 25, 25])}})
    mi.render(scene)
    return scene.sensors()[0].film().bitmap()


def material(surface, folder):
    return (f'surface.bumps = {{ file = "{folder}/{surface}.exr", encoding = "unorm" }}\n'
            'material.a = { surface = "bumps", ndf = "triangles", repeat = [4, 2], roughness = 0.1, id = 1 }\n')


def run(*arguments):
    done = subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)


def channel(path, name):
    bitmap = mi.Bitmap(str(path))
    return np.array(bitmap, dtype=np.float64)[..., [field.name for field in bitmap.struct_()].index(name)]


def density_of_layer(program, folder, bitmap):
    bitmap.write(str(folder / "buffer.exr"))
    run(program, "glints", folder / "buffer.exr", "--scene", folder / "layer.toml", "-o", folder / "layer.exr", "--aovs", "D",
        "--preset", "mitsuba", "--quiet")
    return channel(folder / "layer.exr", "D")


def without_neighbours(bitmap):
    """Every third pixel of every third row alone, and which these are."""
    pixels = np.array(bitmap, dtype=np.float32)
    names = [field.name for field in bitmap.struct_()]
    kept = np.zeros(pixels.shape[:2], dtype=bool)
    kept[1::3, 1::3] = True
    pixels[~kept, names.index("shape_index.I")] = 0
    return mi.Bitmap(pixels, mi.Bitmap.PixelFormat.MultiChannel, names), kept


def compare_layer(program, folder, layer):
    (folder / "buffer.json").write_text(json.dumps(camera(layer)))
    (folder / "layer.toml").write_text(material("soft_turned" if layer.turned_over else "soft", folder))
    (folder / "picture.toml").write_text(
        f'image = {{ width = {WIDTH}, height = {HEIGHT}, filter = "gaussian", aovs = ["ndf", "queries"] }}\n'
        f"camera = {{ position = {layer.eye}, look_at = [0, 0, 0], fov = {FOV} }}\n{material('soft', folder)}"
        f'shape = [{{ {layer.shape}, material = "a" }}]\n'
        f'light = [{{ type = "point", position = {LAMP}, intensity = [25, 25, 25] }}]\n')
    run(program, "render", folder / "picture.toml", "-o", folder / "picture.exr", "--quiet")
    expected, queries = channel(folder / "picture.exr", "ndf.Y"), channel(folder / "picture.exr", "queries.Y")
    bitmap = buffer(layer)
    covered = np.pad(np.array(bitmap)[..., [field.name for field in bitmap.struct_()].index("shape_index.I")] == 1, 1)
    inside = np.all([covered[1 + down : 1 + down + HEIGHT, 1 + right : 1 + right + WIDTH]
                     for down in (-1, 0, 1) for right in (-1, 0, 1)], axis=0)
    # Where the picture, too, has one footprint a pixel, and light enough to speak of a share of it.
    counts = inside & (queries == 1) & (expected > 1e-3 * expected.max())
    errors = np.abs(density_of_layer(program, folder, bitmap) / np.maximum(expected, 1e-30) - 1)
    some, kept = without_neighbours(bitmap)
    alone = np.abs(density_of_layer(program, folder, some) / np.maximum(expected, 1e-30) - 1)[counts & kept]
    mean, largest = errors[counts].mean(), errors[counts].max()
    good = bool(counts.sum() > 150 and mean <= layer.mean and largest <= layer.largest and alone.mean() <= layer.alone)
    print(f"{'good' if good else 'BAD ':4}  {layer.name:44} {counts.sum()} pixels, D off by {mean:.5f} of {layer.mean}, at most "
          f"{largest:.4f} of {layer.largest}; without neighbours {alone.mean():.4f} of {layer.alone}", flush=True)
    return good
