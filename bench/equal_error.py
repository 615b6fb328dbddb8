"""How long Mitsuba 3 samples until its picture is as near to its own limit as Mica's is to its own.

    equal_error.py MICA FOLDER

A ball of 62 pixels' radius under a far lamp, its normals a map of random slopes, roughness 0.02 and 0.005 (Mitsuba's alpha
is sqrt(2) of it); a Gaussian filter of half a pixel in both. Mica's error is that against its picture of 16 times the
size, convolved; Mitsuba's the one that two independent renderings say, whose fall with the number of samples is measured
from 256 to 4096 and carried on. CPU seconds of both: of Mica the whole command, of Mitsuba the rendering
alone. Needs mitsuba and numpy from PyPI, and an LLVM that Mitsuba accepts, without which it is slower by far."""

import math
import pathlib
import resource
import subprocess
import sys

import mitsuba as mi
import numpy as np

for variant in ("llvm_ad_rgb", "scalar_rgb"):
    try:
        mi.set_variant(variant)
        mi.load_dict({"type": "sphere"})
        break
    except Exception as error:  # without LLVM
        print(f"{variant}: {error}", file=sys.stderr)

SIZE, FINE = 128, 16
ALL = slice(3, SIZE - 3)


def write_map(path, resolution, correlation_texels=8, rms_slope=0.3):
    rng = np.random.default_rng(1)
    f = np.fft.fftfreq(resolution) * 2 * math.pi
    k2 = f[:, None] ** 2 + f[None, :] ** 2
    heights = np.fft.fft2(rng.standard_normal((resolution, resolution))) * np.exp(-k2 * correlation_texels**2 / 8)
    slopes = [np.real(np.fft.ifft2(1j * axis * heights)) for axis in (f[None, :], f[:, None])]
    scale = rms_slope / math.sqrt(np.mean(slopes[0] ** 2 + slopes[1] ** 2))
    normals = np.stack([-scale * slopes[0], -scale * slopes[1], np.ones((resolution, resolution))], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    mi.Bitmap((0.5 + 0.5 * normals).astype(np.float32)).write(str(path))


def mica(program, folder, repeat, roughness, *sets):
    path = folder / "race.toml"
    path.write_text(f"""
image = {{ width = {SIZE}, height = {SIZE} }}
camera = {{ position = [0, -8, 0], look_at = [0, 0, 0], fov = {math.degrees(2 * math.atan(1.032 / math.sqrt(64 - 1))):.6f} }}
audit = {{ samples = 0 }}
surface.m = {{ file = "{folder}/map.exr", encoding = "unorm" }}
material.a = {{ surface = "m", repeat = [{2 * repeat}, {repeat}], roughness = {roughness} }}
shape = [{{ type = "sphere", material = "a" }}]
light = [{{ type = "directional", direction = [-0.3, 1, -0.4], irradiance = [3, 3, 3] }}]
""")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "render", path, "-o", folder / "race.exr", "--quiet"] + [a for s in sets for a in ("--set", s)], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    picture = np.array(mi.Bitmap(str(folder / "race.exr")).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    return picture[..., 1].astype(float), seconds


def convolved(fine):
    """By the picture's filter, from single Gaussians of half a fine pixel."""
    offsets = np.arange(fine.shape[0]) + 0.5 - (np.arange(SIZE) + 0.5)[:, None] * FINE
    weights = np.exp(-0.5 * offsets**2 / (0.25 * FINE**2 - 0.25))
    weights /= weights.sum(axis=1, keepdims=True)
    return weights @ fine @ weights.T


def mitsuba_scene(folder, repeat, roughness):
    t = mi.ScalarTransform4f
    alpha = math.sqrt(2) * roughness
    bsdf = {"type": "normalmap",
            "normalmap": {"type": "bitmap", "filename": str(folder / "map.exr"), "raw": True,
                          "to_uv": t().scale([2 * repeat, repeat, 1])},
            "nested": {"type": "roughconductor", "distribution": "beckmann", "alpha": alpha, "material": "none"}}
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "gaussian", "stddev": 0.5}, "pixel_format": "rgb"}
    fov = math.degrees(2 * math.atan(1.032 / math.sqrt(64 - 1)))
    return mi.load_dict({"type": "scene", "integrator": {"type": "direct", "bsdf_samples": 0, "emitter_samples": 1},
                         "sensor": {"type": "perspective", "fov": fov, "film": film, "sampler": {"type": "stratified"},
                                    "to_world": t().look_at(origin=[0, -8, 0], target=[0, 0, 0], up=[0, 0, 1])},
                         "ball": {"type": "sphere", "bsdf": bsdf},
                         "sun": {"type": "directional", "direction": [-0.3, 1, -0.4], "irradiance": {"type": "rgb", "value": [3, 3, 3]}}})


def mitsuba(scene, samples, seed):
    before = resource.getrusage(resource.RUSAGE_SELF)
    picture = np.array(mi.render(scene, spp=samples, seed=seed))[..., 1].astype(float)
    after = resource.getrusage(resource.RUSAGE_SELF)
    return picture, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def error_of_mitsuba(scene, samples):
    """Relative L2 of one rendering, and its CPU seconds."""
    (a, first), (b, second) = mitsuba(scene, samples, 1), mitsuba(scene, samples, 2)
    a, b = a[ALL, ALL], b[ALL, ALL]
    return math.sqrt(((a - b) ** 2).sum() / 2 / ((a + b) ** 2 / 4).sum()), (first + second) / 2


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    resolution = 512
    write_map(folder / "map.exr", resolution)
    print(f"{mi.variant()}; CPU seconds")
    for repeat in (2, 12):
        texels = repeat * resolution / (62 * math.pi)  # a pixel, where the ball faces the camera
        for roughness in (0.02, 0.005):
            shown, seconds = mica(program, folder, repeat, roughness)
            truth = convolved(mica(program, folder, repeat, roughness, f"image.width={SIZE * FINE}", f"image.height={SIZE * FINE}",
                                   "image.subpixels=1", 'image.filter="subpixels"')[0])
            error = math.sqrt(((shown - truth)[ALL, ALL] ** 2).sum() / (truth[ALL, ALL] ** 2).sum())
            scene = mitsuba_scene(folder, repeat, roughness)
            mitsuba(scene, 16, 0)  # compiles
            (few, _), (many, its_seconds) = error_of_mitsuba(scene, 256), error_of_mitsuba(scene, 4096)
            slope = math.log(few / many) / math.log(16)
            needed = its_seconds * max(many / error, 1e-9) ** (1 / slope)
            print(f"{texels:.0f} texels a pixel, roughness {roughness}: Mica {error:.2%} in {seconds:.2f} s; Mitsuba {many:.2%} of "
                  f"4096 samples in {its_seconds:.1f} s, falling as samples^-{slope:.2f}: as near in {needed:.0f} s, "
                  f"{needed / seconds:.0f} times as long", flush=True)


if __name__ == "__main__":
    main()
