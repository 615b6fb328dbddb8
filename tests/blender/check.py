"""Blender as a client of `mica glints`, inside Blender or with its Python module: run by scripts/blender_check.

    check.py -- MICA WORK

Measures what the add-on leaves against Blender's own pictures and against lobes and rays computed here.
"""
import math
import os
import subprocess
import sys
from array import array
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
ADDON = HERE.parent.parent / "integrations" / "blender" / "mica_glints.py"
sys.path[:0] = [str(HERE), str(ADDON.parent)]

import bpy
import mica_glints
import scenes

failures = []


def expect(right, what):
    """Prints a measurement, and remembers it when it is not what it should be."""
    print(("  ok    " if right else "  WRONG ") + what, file=sys.stderr)
    if not right:
        failures.append(what)


class Picture:
    """RGBA of a file, linear; rows from the bottom."""

    def __init__(self, path):
        image = bpy.data.images.load(str(path))
        self.width, self.height = image.size
        self.values = array("f", bytes(4 * 4 * self.width * self.height))
        image.pixels.foreach_get(self.values)
        bpy.data.images.remove(image)

    def __len__(self):
        return self.width * self.height

    def __getitem__(self, pixel):
        return self.values[4 * pixel:4 * pixel + 4]

    def light(self, pixel):
        return sum(self.values[4 * pixel:4 * pixel + 3])


def render_beauty(path):
    scene = bpy.context.scene
    mica_glints.write_format(scene.render.image_settings, "IMAGE", "OPEN_EXR", "32")
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return Picture(path)


# --- What rays see, without the G-buffer ---
class Sight:
    """First hits of the rays through the pixels' centres, and what lamps send there."""

    def __init__(self, scene):
        self.scene, self.camera = scene, scene.camera
        self.depsgraph = bpy.context.evaluated_depsgraph_get()
        self.width, self.height = scene.render.resolution_x, scene.render.resolution_y
        frame = [self.camera.matrix_world @ corner for corner in self.camera.data.view_frame(scene=scene)]
        self.corner, self.right, self.up = frame[2], frame[1] - frame[2], frame[3] - frame[2]
        self.eye = self.camera.matrix_world.translation
        self.hits = [self.hit(x, y) for y in range(self.height) for x in range(self.width)]

    def hit(self, x, y):
        """Place, normal and name of the material, or None."""
        towards = self.corner + self.right * ((x + 0.5) / self.width) + self.up * ((y + 0.5) / self.height)
        found, place, normal, _, thing, _ = self.scene.ray_cast(self.depsgraph, self.eye, towards - self.eye)
        facing = normal if normal.dot(self.eye - place) > 0 else -normal
        return (place, facing, thing.data.materials[0].name) if found else None

    def is_shadowed(self, place, normal, lamp):
        way = lamp.matrix_world.translation - place
        return self.scene.ray_cast(self.depsgraph, place + 1e-3 * normal, way.normalized(), distance=way.length)[0]

    def lobe_light(self, place, normal, lamp, alpha):
        """Radiance of a smooth white Beckmann lobe: of a point's power / 4 pi, of an area's / pi along its axis."""
        way = lamp.matrix_world.translation - place
        light, view = way.normalized(), (self.eye - place).normalized()
        axis = lamp.matrix_world.to_3x3().col[2]
        area = 4 if bpy.app.version < (4, 0, 0) else math.pi
        facing = max(0, axis.dot(light)) / area if lamp.data.type == "AREA" else 1 / (4 * math.pi)
        half = (light + view).normalized()
        cosine = half.dot(normal)
        if light.dot(normal) <= 0 or cosine <= 0:
            return 0
        if self.is_shadowed(place, normal, lamp):
            return 0
        density = math.exp((1 - 1 / cosine**2) / alpha**2) / (math.pi * alpha**2 * cosine**4)
        return lamp.data.energy * facing / way.length_squared * density / (4 * max(0.05, view.dot(normal)))


def blocks(sight, values, size=8):
    """Sums of a list of pixels over blocks of size x size pixels."""
    across = -(-sight.width // size)
    sums = [0.0] * (across * -(-sight.height // size))
    for pixel, value in enumerate(values):
        sums[pixel // sight.width // size * across + pixel % sight.width // size] += value
    return sums


def correlation(a, b):
    mean_a, mean_b = sum(a) / len(a), sum(b) / len(b)
    covariance = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    return covariance / math.sqrt(sum((x - mean_a)**2 for x in a) * sum((y - mean_b)**2 for y in b))


# --- The checks ---
def run_script(blend, folder, mica):
    """The add-on as a user without a window calls it."""
    with_program = [bpy.app.binary_path, "--background", str(blend), "--python", str(ADDON), "--", "--out", str(folder)]
    with_module = [sys.executable, str(ADDON), "--", str(blend), "--out", str(folder)]
    command = with_program if bpy.app.binary_path else with_module
    return subprocess.run(command, env={**os.environ, "MICA": str(mica)}, stderr=subprocess.PIPE, text=True)


def make_layer(folder):
    context = bpy.context
    return mica_glints.make_layer(context.scene, context.view_layer, context.evaluated_depsgraph_get(), folder)


def check_car(mica, work):
    print("car-paint body on a brushed plate", file=sys.stderr)
    scenes.make_car()
    bpy.context.scene.mica_glints.shadow_samples = 16
    blend, folder = work / "car.blend", work / "car"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    done = run_script(blend, folder, mica)
    expect(done.returncode == 0, f"the script ends with {done.returncode}")
    if done.returncode:
        print(done.stderr, file=sys.stderr)
        return
    beauty = render_beauty(folder / "beauty.exr")
    layer, composite = Picture(folder / "layer.exr"), Picture(folder / "composite.exr")
    sight = Sight(bpy.context.scene)
    glinted = [hit is not None and hit[2] in ("paint", "steel") for hit in sight.hits]
    outside = [pixel for pixel, on in enumerate(glinted) if not on]
    # Two renderings of Blender's differ by rounding, as its threads come to share the picture.
    rounding = 1e-6
    changed = sum(
        max(abs(a - b) for a, b in zip(composite[pixel], beauty[pixel])) > rounding for pixel in outside
    )
    expect(len(outside) > 1000 and changed == 0,
           f"{changed} of {len(outside)} pixels outside glinted materials differ from the beauty")
    expect(all(composite[pixel][3] == beauty[pixel][3] for pixel in range(len(beauty))), "the beauty's alpha is kept")
    off = max(abs(sum_ - under - glints) / (1 + sum_) for pixel in range(len(beauty))
              for sum_, under, glints in zip(composite[pixel][:3], beauty[pixel], layer[pixel]))
    expect(off < 1e-5, f"composite = beauty + layer to {off:.1e}")
    check_highlights(sight, layer)
    check_streak(sight, layer)


def check_highlights(sight, layer):
    """The paint's flakes are Beckmann's on average: sums over blocks follow the smooth lobe of all of them."""
    alpha = math.sqrt(0.22**2 + 2 * 0.02**2)
    lamps = [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]
    painted = [hit is not None and hit[2] == "paint" for hit in sight.hits]
    smooth = [sum(0.55 * lamp.data.color[0] * sight.lobe_light(*hit[:2], lamp, alpha) for lamp in lamps) if on else 0
              for hit, on in zip(sight.hits, painted)]
    glints = [layer[pixel][0] if on else 0 for pixel, on in enumerate(painted)]
    follows, share = correlation(blocks(sight, glints), blocks(sight, smooth)), sum(glints) / sum(smooth)
    expect(follows > 0.9, f"the paint's glints lie where highlights are: correlation {follows:.3f} by blocks of 8")
    expect(0.9 < share < 1.1, f"their light is {share:.3f} of the smooth lobe's")
    shares = [value / lobe for value, lobe in zip(glints, smooth) if lobe > 0.2 * max(smooth)]
    mean = sum(shares) / len(shares)
    contrast = math.sqrt(sum((value - mean)**2 for value in shares) / len(shares)) / mean
    expect(contrast > 0.1, f"and they glitter: pixels are {100 * contrast:.0f}% off the smooth lobe")


def check_streak(sight, layer):
    """The plate is brushed along x, so its normals lean along y alone: so must the half vectors where it has light."""
    lamps = [thing for thing in bpy.context.scene.objects if thing.type == "LIGHT"]

    def is_streak(place, normal, lamp):
        half = (lamp.matrix_world.translation - place).normalized() + (sight.eye - place).normalized()
        return abs(half.normalized().x) < 0.06 and not sight.is_shadowed(place, normal, lamp)

    steel = [pixel for pixel, hit in enumerate(sight.hits) if hit and hit[2] == "steel"]
    streak = [pixel for pixel in steel if any(is_streak(*sight.hits[pixel][:2], lamp) for lamp in lamps)]
    share = sum(map(layer.light, streak)) / max(1e-9, sum(map(layer.light, steel)))
    expect(share > 0.99, f"{100 * share:.2f}% of the plate's light are in a streak across the brushing, out of shadows")


def check_lamp(kind, mica, work, roughness=0.05):
    scenes.make_plane(kind, str(work / "flat.exr"), roughness)
    os.environ["MICA"] = str(mica)
    folder = work / kind.lower()
    path, warnings = make_layer(folder)
    beauty, layer = render_beauty(folder / "beauty.exr"), Picture(path)
    here, there = [layer.light(p) for p in range(len(layer))], [beauty.light(p) for p in range(len(beauty))]
    bright = [p for p, value in enumerate(there) if value > max(there) / 2]
    total = sum(here) / sum(there)
    peak = sum(here[p] for p in bright) / sum(there[p] for p in bright)
    expect(abs(total - 1) < 0.02 and abs(peak - 1) < 0.02 and not warnings,
           f"{kind}: the layer's light is {total:.4f} of Blender's, {peak:.4f} in the {len(bright)} brightest pixels")


def fingerprint():
    """All that the add-on touches, and counts of all that it could leave behind."""
    scene = bpy.context.scene
    tree, _ = mica_glints.compositor_of(scene)
    kinds = ("scenes", "materials", "node_groups", "lights", "cameras", "meshes", "worlds")
    counts = {name: len(getattr(bpy.data, name)) for name in kinds}
    trees = {material.name: (material.users, material.use_fake_user, len(material.node_tree.nodes))
             for material in bpy.data.materials}
    things = {o.name: (o.lightgroup, [slot.material.name for slot in o.material_slots]) for o in scene.objects}
    layers = {layer.name: (len(layer.aovs), len(layer.lightgroups), layer.use_pass_uv, layer.samples)
              for layer in scene.view_layers}
    settings = [(owner.bl_rna.identifier, name, getattr(owner, name))
                for owner in (scene.render, scene.cycles, scene.render.image_settings, scene.camera.data.dof)
                for name in owner.bl_rna.properties.keys() if isinstance(getattr(owner, name), (int, float, str))]
    return len(tree.nodes), len(tree.links), counts, trees, things, layers, settings, scene.world.name


def check_restored(mica, work):
    scenes.make_car(32, 18, 1)
    scene = bpy.context.scene
    scene.camera.data.dof.use_dof, scene.objects["bulb"].lightgroup = True, "mine"
    bpy.data.materials["paint"].use_fake_user = True
    mica_glints.compositor_of(scene)
    before = fingerprint()
    for program, succeeds in ((mica, True), ("/bin/false", False), (work / "nothing", False)):
        os.environ["MICA"], error = str(program), ""
        try:
            make_layer(work / "restored")
        except mica_glints.Failure as failure:
            error = str(failure)
        expect((error == "") == succeeds, f"{Path(program).name}: {error or 'made'}")
        expect(fingerprint() == before, "the scene is as before")
    scene.objects["body"].data.uv_layers.remove(scene.objects["body"].data.uv_layers[0])
    try:
        make_layer(work / "restored")
        expect(False, "a body without UV is refused")
    except mica_glints.Failure as failure:
        expect("'body'" in str(failure), f"a body without UV: {failure}")


def write_flat_map(path):
    image = bpy.data.images.new("flat", 8, 8, float_buffer=True)
    image.pixels.foreach_set([0.0, 0.0, 1.0, 1.0] * 64)
    image.filepath_raw, image.file_format = str(path), "OPEN_EXR"
    image.save()


def main(mica, work):
    work.mkdir(parents=True, exist_ok=True)
    mica_glints.register()
    try:
        check_car(mica, work)
        print("a white metal plane of one normal", file=sys.stderr)
        write_flat_map(work / "flat.exr")
        for kind in scenes.LAMPS:
            check_lamp(kind, mica, work)
        print("what the add-on leaves behind", file=sys.stderr)
        check_restored(mica, work)
    finally:
        mica_glints.unregister()
    print(f"Blender {bpy.app.version_string}: {len(failures)} measurements are wrong", file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    words = sys.argv[sys.argv.index("--") + 1:]
    main(Path(words[0]).resolve(), Path(words[1]).resolve())
