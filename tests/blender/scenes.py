"""The scenes of the check, made in an empty Blender: a car-paint body on a brushed plate, a plane under one lamp."""
import math

import bpy
from mathutils import Vector


def empty_scene(width, height, samples):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.device = "CYCLES", "CPU"
    scene.cycles.samples, scene.cycles.seed, scene.cycles.use_denoising = samples, 1, False
    scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    return scene


def add_object(scene, name, data, place=(0, 0, 0), target=None):
    thing = bpy.data.objects.new(name, data)
    scene.collection.objects.link(thing)
    thing.location = place
    if target is not None:
        thing.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    return thing


def add_camera(scene, place, target, lens):
    camera = bpy.data.cameras.new("camera")
    camera.lens = lens
    scene.camera = add_object(scene, "camera", camera, place, target)


def add_lamp(scene, kind, name, place, target, **values):
    lamp = bpy.data.lights.new(name, kind)
    for key, value in values.items():
        setattr(lamp, key, value)
    return add_object(scene, name, lamp, place, target)


def grid_mesh(name, columns, rows, place_of, uv_of):
    """A smooth mesh of columns x rows quads; place_of and uv_of take (column / columns, row / rows)."""
    corners = [(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    line = columns + 1
    quad = lambda first: (first, first + 1, first + line + 1, first + line)
    faces = [quad(j * line + i) for j in range(rows) for i in range(columns)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([place_of(*corner) for corner in corners], [], faces)
    layer = mesh.uv_layers.new(name="UVMap")
    layer.data.foreach_set("uv", [value for loop in mesh.loops for value in uv_of(*corners[loop.vertex_index])])
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    return mesh


def body_mesh():
    """Half a rounded body, as of a car under its cover: a hood, a cabin, closed at nose and tail."""
    def outline(along):
        x = 2 * along - 1
        end = (1 - abs(x) ** 3) ** (1 / 3)
        return 2.1 * x, 0.95 * end, end * (0.55 + 0.4 * math.exp(-((x + 0.1) / 0.45) ** 4))

    def place(along, around):
        x, width, height = outline(0.5 - 0.5 * math.cos(math.pi * along))
        angle = math.pi * around
        rounded = (abs(math.cos(angle)) ** 2.6 + abs(math.sin(angle)) ** 2.6) ** (-1 / 2.6)
        return x, width * rounded * math.cos(angle), height * rounded * math.sin(angle)
    return grid_mesh("body", 192, 96, place, lambda along, around: (4.2 * along, 2.4 * around))


def principled(name, color, roughness, metallic=1):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = next(node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeBsdfPrincipled").inputs
    for name, value in (("Base Color", (*color, 1)), ("Roughness", roughness), ("Metallic", metallic)):
        inputs[name].default_value = value
    return material


def set_glints(material, **values):
    material.mica_glints.enabled = True
    for key, value in values.items():
        setattr(material.mica_glints, key, value)


def surround(scene, low, high):
    """An environment: one colour below, another one above."""
    world = scene.world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    nodes, link = world.node_tree.nodes, world.node_tree.links.new
    place, split, ramp = (nodes.new("ShaderNode" + kind) for kind in ("TexCoord", "SeparateXYZ", "ValToRGB"))
    link(place.outputs["Generated"], split.inputs[0])
    link(split.outputs["Z"], ramp.inputs[0])
    ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (*low, 1), (*high, 1)
    background = next(node for node in nodes if node.bl_idname == "ShaderNodeBackground")
    link(ramp.outputs[0], background.inputs["Color"])


def make_car(width=320, height=180, samples=16):
    scene = empty_scene(width, height, samples)
    paint = principled("paint", (0.55, 0.03, 0.04), 0.45)
    steel = principled("steel", (0.3, 0.3, 0.31), 0.35)
    rubber = principled("rubber", (0.02, 0.02, 0.02), 0.8, metallic=0)
    set_glints(paint, source="flakes", resolution=1024, size=8, strength=0.22, repeat=(2, 2), roughness=0.02,
               method="triangles")
    set_glints(steel, source="brushed", resolution=1024, size=3, strength=0.12, repeat=(3, 3), roughness=0.01,
               method="triangles", seed=2)
    add_object(scene, "body", body_mesh(), (0, 0, 0.18)).data.materials.append(paint)
    plate = grid_mesh("plate", 1, 1, lambda u, v: (7 * u - 3.5, 5 * v - 2.2, 0), lambda u, v: (1.4 * u, v))
    add_object(scene, "plate", plate).data.materials.append(steel)
    around = lambda u: 2 * math.pi * u
    skirt = grid_mesh("skirt", 64, 1, lambda u, v: (1.9 * math.cos(around(u)), 0.8 * math.sin(around(u)), 0.2 * v),
                      lambda u, v: (u, v))
    add_object(scene, "skirt", skirt).data.materials.append(rubber)
    add_lamp(scene, "AREA", "Soft.box", (-2.2, -2.0, 3.2), (0, 0, 0.5), energy=200, size=0.4)
    add_lamp(scene, "POINT", "bulb", (-8.3, 8.3, 6), (0, 0, 0), energy=700, shadow_soft_size=0.05, color=(1, 0.85, 0.7))
    surround(scene, (0.02, 0.02, 0.025), (0.1, 0.14, 0.2))
    add_camera(scene, (1.6, -5.6, 2.5), (0, 0, 0.35), 45)
    return scene


# One lamp of each kind over a plane: what it is, and what it has.
LAMPS = {
    "POINT": {"energy": 300, "shadow_soft_size": 0},
    "SPOT": {"energy": 300, "shadow_soft_size": 0, "spot_size": math.radians(16), "spot_blend": 0.7},
    "SUN": {"energy": 3, "angle": math.radians(0.5)},
    "AREA": {"energy": 100, "shape": "RECTANGLE", "size": 0.2, "size_y": 0.3},
}
# And how it is seen.
CAMERAS = {
    "POINT": {"type": "ORTHO", "ortho_scale": 2.2},
    "SPOT": {"sensor_fit": "VERTICAL", "shift_x": 0.1, "shift_y": -0.05, "lens": 45},
    "SUN": {},
    "AREA": {"sensor_fit": "HORIZONTAL"},
}


def make_plane(kind, map_file, roughness, width=96, height=64, samples=64):
    """A white metal plane of one normal under one lamp; `roughness` is a Beckmann alpha over sqrt(2)."""
    scene = empty_scene(width, height, samples)
    white = bpy.data.materials.new("white metal")
    white.use_nodes = True
    tree = white.node_tree
    tree.nodes.clear()
    glossy, output = tree.nodes.new("ShaderNodeBsdfGlossy"), tree.nodes.new("ShaderNodeOutputMaterial")
    glossy.distribution = "BECKMANN"
    glossy.inputs["Color"].default_value = (1, 1, 1, 1)
    glossy.inputs["Roughness"].default_value = math.sqrt(math.sqrt(2) * roughness)  # Blender squares it
    tree.links.new(glossy.outputs[0], output.inputs["Surface"])
    set_glints(white, source="file", file=map_file, encoding="signed", method="triangles", roughness=roughness,
               own_color=True)
    plane = grid_mesh("plane", 1, 1, lambda u, v: (4 * u - 2, 4 * v - 2, 0), lambda u, v: (u, v))
    add_object(scene, "plane", plane).data.materials.append(white)
    add_lamp(scene, kind, "lamp", (0, 3, 3), (0, 0, 0), **LAMPS[kind]).scale.x = 1.5
    add_camera(scene, (0, -3, 3), (0, 0, 0), 70)
    for key, value in CAMERAS[kind].items():
        setattr(scene.camera.data, key, value)
    scene.render.pixel_aspect_x = 1.3 if kind == "AREA" else 1
    scene.cycles.film_exposure = 2 if kind == "SUN" else 1
    return scene
