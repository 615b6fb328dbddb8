"""Mica's glints on Blender's picture: an add-on for Blender 3.4 and newer, and a script for it.

    blender -b SCENE.blend -P mica_glints.py -- --out DIR [--mica PROGRAM]

Renders the scene's G-buffer with Cycles, has `mica glints` make a layer of it, and adds the layer to the picture in the
compositor. In DIR the script leaves composite.exr and composite.png beside what led to them: gbuffer.exr, gbuffer.json,
scene.toml, layer.exr. Exit code: 0 when they are there, 1 otherwise. docs/blender.md says more.
"""
import argparse
import json
import math
import os
import re
import subprocess
import sys
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy
from bpy.props import (BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty,
                       StringProperty)
from mathutils import Matrix

bl_info = {
    "name": "Mica Glints",
    "description": "Glints of explicit normal maps as a layer over the rendered picture",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Material and Properties > Render",
    "category": "Render",
}

# The keys of a surface that is generated: docs/job.md has their meaning.
GENERATORS = {
    "flakes": "flake_size = {size}\nalpha = {strength}",
    "spectrum": "correlation = {size}\nrms_slope = {strength}",
    "brushed": "correlation_across = {size}\nrms_slope = {strength}\ndirection = {direction}",
    "scratches": "width = {size}\ndepth = {strength}\ndirection = {direction}",
    "dents": "radius = [{size}, {size}]\ndepth = {strength}",
    "bumps": "cell = {size}\nslope = {strength}",
}
METHODS = ("auto", "triangles", "pyramid", "gaussians", "beckmanns", "cavities", "smooth")
PASSES = ("z", "position", "normal", "uv")
AOVS = {"smooth_normal": "COLOR", "true_normal": "COLOR", "tangent": "COLOR", "tangent_sign": "VALUE",
        "glint_id": "VALUE"}
LAYER = "Mica Glints"  # name of the image node, and with " Add" of the node that adds it


class Failure(Exception):
    """What keeps the layer from being made, in words for the artist."""


def choices(*words):
    return [(word, word.capitalize(), "") for word in words]


class MicaGlintsMaterial(bpy.types.PropertyGroup):
    enabled: BoolProperty(name="Mica glints", description="This material glitters")
    source: EnumProperty(name="Map", items=choices("file", *GENERATORS), default="flakes")
    file: StringProperty(name="File", subtype="FILE_PATH", description="Normal map, height or slope map")
    encoding: EnumProperty(name="Encoding", items=choices("found", "unorm", "signed", "height", "slope"),
                           description="How the file tells normals; 'found': as its numbers look")
    green: EnumProperty(name="Green", items=choices("up", "down"),
                        description="Direction in which the second channel points")
    resolution: IntProperty(name="Resolution", default=2048, min=8, max=16384, description="Texels of a side")
    size: FloatProperty(name="Size", default=12, min=2, soft_max=100,
                        description="Of a flake, bump or scratch, or correlation; texels")
    strength: FloatProperty(name="Strength", default=0.2, min=0, max=2,
                            description="Roughness of flakes, slope of bumps, depth of scratches and dents")
    direction: FloatProperty(name="Direction", subtype="ANGLE", min=-2 * math.pi, max=2 * math.pi,
                             description="Of brushing and scratches, from u towards v")
    seed: IntProperty(name="Seed", default=1, min=0)
    repeat: FloatVectorProperty(name="Repeat", size=2, default=(1, 1), min=1e-3, max=1e6,
                                description="Map periods over one unit of u and v")
    method: EnumProperty(name="Method", items=choices(*METHODS), description="Evaluator of the P-NDF")
    roughness: FloatProperty(name="Roughness", default=0.01, min=1e-4, max=1, precision=4,
                             description="Of one facet: standard deviation of its normals on the unit disk")
    own_color: BoolProperty(name="Own colour", description="Instead of the Principled BSDF's base colour")
    color: FloatVectorProperty(name="Colour", subtype="COLOR", default=(1, 1, 1), min=0, max=1,
                               description="Reflectance, linear")


class MicaGlintsScene(bpy.types.PropertyGroup):
    folder: StringProperty(name="Folder", subtype="DIR_PATH", default="//mica_glints/",
                           description="For the G-buffer and the layer")
    tolerance: FloatProperty(name="Tolerance", default=0.01, min=5e-4, max=0.5, precision=4,
                             description="Relative error that the method 'auto' may make")
    scale: IntProperty(name="Scale", default=1, min=1, max=16,
                       description="The G-buffer has so many times the picture's width and height: cleaner edges. "
                                   "1, or 4 and more: 2 and 3 are too few for Blender's own filter")
    shadow_samples: IntProperty(name="Shadow samples", default=64, min=1, max=4096,
                                description="A pixel, for the lamps' visibility")


class MicaGlintsPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__
    # Not the scene's: a file from elsewhere must not say which program runs here.
    program: StringProperty(name="Mica", subtype="FILE_PATH",
                            description="The program; default MICA of the environment, then mica in PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


# --- The G-buffer ---
def write_format(settings, media, file_format, depth):
    if hasattr(settings, "media_type"):  # from Blender 5.0 on
        settings.media_type = media
    settings.file_format, settings.color_depth = file_format, depth


@contextmanager
def changed(owner, **values):
    """Attributes have these values while it lasts."""
    before = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


def write_aovs(tree, number):
    """Has a material's tree write what `mica glints` asks for beside the passes."""
    node = lambda kind: tree.nodes.new("ShaderNode" + kind)
    geometry, tangent, sign, identity = node("NewGeometry"), node("Tangent"), node("Attribute"), node("Value")
    tangent.direction_type, sign.attribute_name = "UV_MAP", "tangent_sign"  # both of the mesh's active UV map
    identity.outputs[0].default_value = number
    sockets = {
        "smooth_normal": geometry.outputs["Normal"], "true_normal": geometry.outputs["True Normal"],
        "tangent": tangent.outputs[0], "tangent_sign": sign.outputs["Fac"], "glint_id": identity.outputs[0],
    }
    for name, kind in AOVS.items():
        output = node("OutputAOV")
        setattr(output, "aov_name" if hasattr(output, "aov_name") else "name", name)
        tree.links.new(sockets[name], output.inputs["Color" if kind == "COLOR" else "Value"])


@contextmanager
def marked(materials):
    """While it lasts, copies that write AOVs stand for the materials; glint_id counts from 1 in their order."""
    copies = []
    try:
        for number, material in enumerate(materials, 1):
            copy = material.copy()
            copies.append((material, copy))
            copy.use_nodes = True
            write_aovs(copy.node_tree, number)
            material.user_remap(copy)
        yield
    finally:
        for material, copy in copies:
            copy.user_remap(material)
            bpy.data.materials.remove(copy)


@contextmanager
def grouped(layer, lamps):
    """While it lasts, each lamp is a light group of the layer; yields the groups' names."""
    before = [lamp.lightgroup for lamp in lamps]
    try:
        for lamp in lamps:
            lamp.lightgroup = layer.lightgroups.add(name=lamp.name).name
        yield [lamp.lightgroup for lamp in lamps]
    finally:
        for lamp, name in zip(lamps, before):
            lamp.lightgroup = name


def copy_visibility(source, target):
    for name in ("exclude", "holdout", "indirect_only"):
        setattr(target, name, getattr(source, name))
    for child in target.children:
        copy_visibility(source.children[child.name], child)


def add_layer(scene, source, name):
    layer = scene.view_layers.new(name)
    copy_visibility(source.layer_collection, layer.layer_collection)
    return layer


@contextmanager
def white_diffuse():
    material = bpy.data.materials.new("Mica white")
    try:
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
        shader.inputs["Color"].default_value, shader.inputs["Roughness"].default_value = (1, 1, 1, 1), 0
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
        yield material
    finally:
        bpy.data.materials.remove(material)


def size_of(render):
    return [side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y)]


def prepare_scene(scene):
    """Settings of a picture whose every pixel is one ray through its centre."""
    render, cycles = scene.render, scene.cycles
    if hasattr(scene, "compositing_node_group"):  # from Blender 5.0 on
        scene.compositing_node_group = None
    elif scene.node_tree:
        scene.node_tree.nodes.clear()
    if render.engine != "CYCLES":
        cycles.film_exposure = 1
    render.engine, scene.world = "CYCLES", None
    render.film_transparent, render.use_single_layer, render.use_persistent_data = True, False, False
    render.use_compositing = render.use_sequencer = render.use_motion_blur = False
    render.use_border = render.use_freestyle = render.use_multiview = False
    cycles.samples, cycles.pixel_filter_type, cycles.filter_width = 1, "BLACKMAN_HARRIS", 0.01
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.shading_system = False
    render.resolution_x, render.resolution_y = (scene.mica_glints.scale * side for side in size_of(render))
    render.resolution_percentage = 100
    cycles.max_bounces, cycles.sample_clamp_direct, cycles.light_sampling_threshold = 0, 0, 0
    write_format(render.image_settings, "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER", "32")
    render.image_settings.exr_codec = "ZIP"
    if hasattr(render.image_settings, "use_exr_interleave"):  # 5.0 writes no parts of pixels that are not square
        render.image_settings.use_exr_interleave = True


def remove_scene(scene):
    scene.user_clear()  # a copy counts itself as its user for each Render Layers node that it had
    bpy.data.scenes.remove(scene)


@contextmanager
def gbuffer_scene(source, layer, materials, lamps):
    """A scene of the same objects that renders the G-buffer; yields it and the names of the lamps' groups."""
    with ExitStack() as stack:
        scene = source.copy()
        stack.callback(remove_scene, scene)
        prepare_scene(scene)
        fit = add_layer(scene, layer, "G-buffer")
        shadows = add_layer(scene, layer, "Lamps")
        for other in [other for other in scene.view_layers if other not in (fit, shadows)]:
            scene.view_layers.remove(other)
        for name in PASSES:
            setattr(fit, "use_pass_" + name, True)
        for name, kind in AOVS.items():
            aov = fit.aovs.add()
            aov.name, aov.type = name, kind
        fit.name = "ViewLayer"
        shadows.samples = source.mica_glints.shadow_samples
        shadows.material_override = stack.enter_context(white_diffuse())
        stack.enter_context(changed(scene.camera.data.dof, use_dof=False))
        stack.enter_context(marked(materials))
        yield scene, stack.enter_context(grouped(shadows, lamps))


# --- What is told beside the pixels ---
def rendered_objects(branch):
    """Objects of a layer's collections that are rendered; instances are not among them."""
    if branch.collection.hide_render:
        return
    if not branch.exclude:
        yield from (thing for thing in branch.collection.objects if not thing.hide_render)
    for child in branch.children:
        yield from rendered_objects(child)


def is_lamp(thing):
    """Whether a lamp's mirror images are seen."""
    if thing.type != "LIGHT" or not thing.visible_glossy:
        return False
    portal = getattr(thing.data, "cycles", None)
    return not (thing.data.type == "AREA" and portal and portal.is_portal)


def rigid(matrix):
    place, turn, _ = matrix.decompose()
    return [list(row) for row in Matrix.Translation(place) @ turn.to_matrix().to_4x4()]


def describe_camera(camera):
    data = camera.data
    if data.type == "PANO":
        raise Failure(f"camera '{camera.name}' is panoramic; glints want a perspective or an orthographic one")
    return {
        "type": data.type, "sensor_fit": data.sensor_fit, "shift": [data.shift_x, data.shift_y],
        "angle_x": data.angle_x, "angle_y": data.angle_y, "ortho_scale": data.ortho_scale,
        "matrix_world": rigid(camera.matrix_world),
    }


def emission_of(lamp, warnings):
    """Factor and colour that a lamp's nodes put on its energy, as far as they are constant."""
    if not (lamp.use_nodes and lamp.node_tree):
        return 1, (1, 1, 1)
    node = next((node for node in lamp.node_tree.nodes if node.bl_idname == "ShaderNodeEmission"), None)
    if node is None or node.inputs["Color"].is_linked or node.inputs["Strength"].is_linked:
        warnings.append(f"lamp '{lamp.name}': its texture is left out")
    if node is None:
        return 1, (1, 1, 1)
    return node.inputs["Strength"].default_value, node.inputs["Color"].default_value[:3]


def power_of(lamp):
    """Power as Blender means it from 4.0 on: before, an area lamp had the radiance P / (4 area), now P / (pi area)."""
    return lamp.energy * (math.pi / 4 if lamp.type == "AREA" and bpy.app.version < (4, 0, 0) else 1)


def describe_lamp(thing, group, exposure, warnings):
    lamp = thing.data
    factor, tint = emission_of(lamp, warnings)
    if getattr(lamp, "use_temperature", False):
        tint = [a * b for a, b in zip(tint, lamp.temperature_color)]
    if lamp.type == "AREA" and lamp.spread < 3.14:
        warnings.append(f"lamp '{lamp.name}': its spread is left out")
    told = {
        "name": group, "type": lamp.type, "matrix_world": rigid(thing.matrix_world),
        "energy": power_of(lamp) * factor * exposure, "color": [a * b for a, b in zip(lamp.color, tint)],
        "exposure": getattr(lamp, "exposure", 0), "normalize": getattr(lamp, "normalize", True),
    }
    across, up, along = thing.matrix_world.to_scale()
    told["radius"], told["angle"] = getattr(lamp, "shadow_soft_size", None), getattr(lamp, "angle", None)
    # A cone that is scaled is no round one: then the lamps' layer alone tells where it shines.
    if lamp.type == "SPOT" and max(abs(side - 1) for side in (across, up, along)) < 1e-4:
        told["spot_size"], told["spot_blend"] = lamp.spot_size, lamp.spot_blend
    if lamp.type == "AREA":  # a square or disk that is scaled unevenly is none any more
        told["shape"] = "ELLIPSE" if lamp.shape in ("DISK", "ELLIPSE") else "RECTANGLE"
        height = lamp.size_y if lamp.shape in ("RECTANGLE", "ELLIPSE") else lamp.size
        told["size"] = [lamp.size * across, height * up]
    return told


def write_json(path, scene, depsgraph, lamps, groups, warnings):
    render, film = scene.render, scene.cycles.film_exposure  # a factor of the beauty and the lamps' layer alike
    described = [describe_lamp(lamp.evaluated_get(depsgraph), group, film, warnings)
                 for lamp, group in zip(lamps, groups)]
    told = {
        "blender": bpy.app.version_string, "resolution": size_of(render),
        "pixel_aspect": [render.pixel_aspect_x, render.pixel_aspect_y],
        "camera": describe_camera(scene.camera.evaluated_get(depsgraph)), "lamps": described,
    }
    path.write_text(json.dumps(told, indent=1))


def base_color(material, warnings):
    """Linear reflectance: the material's own, or that of its Principled BSDF."""
    settings = material.mica_glints
    if settings.own_color:
        return settings.color
    nodes = material.node_tree.nodes if material.use_nodes and material.node_tree else ()
    node = next((node for node in nodes if node.bl_idname == "ShaderNodeBsdfPrincipled"), None)
    if node is None:
        return material.diffuse_color[:3]
    if node.inputs["Base Color"].is_linked:
        warnings.append(f"material '{material.name}': its base colour's texture is left out; give it an own colour")
    return node.inputs["Base Color"].default_value[:3]


def numbers(values):
    return "[" + ", ".join(f"{value:.7g}" for value in values) + "]"


def describe_surface(material):
    settings = material.mica_glints
    if settings.source == "file":
        if not settings.file:
            raise Failure(f"material '{material.name}' names no file of a map")
        path = bpy.path.abspath(settings.file, library=material.library)
        encoding = "" if settings.encoding == "found" else f"\nencoding = \"{settings.encoding}\""
        return f"file = {json.dumps(path, ensure_ascii=False)}{encoding}\ngreen = \"{settings.green}\""
    keys = GENERATORS[settings.source].format(size=f"{settings.size:.7g}", strength=f"{settings.strength:.7g}",
                                              direction=f"{math.degrees(settings.direction):.7g}")
    return f"generate = \"{settings.source}\"\nresolution = {settings.resolution}\nseed = {settings.seed}\n{keys}"


def write_toml(path, scene, materials, warnings):
    text = f"accuracy = {{ tolerance = {scene.mica_glints.tolerance:.7g} }}\n"
    for number, material in enumerate(materials, 1):
        settings, name = material.mica_glints, re.sub(r"[^A-Za-z0-9_-]", "_", material.name) + f"_{number}"
        text += f"""
[surface.{name}]
{describe_surface(material)}

[material.{name}]
surface = "{name}"
id = {number}
ndf = "{settings.method}"
roughness = {settings.roughness:.7g}
repeat = {numbers(settings.repeat)}
specular = {{ color = {numbers(base_color(material, warnings))} }}
"""
    path.write_text(text, encoding="utf-8")


# --- The layer ---
def filter_of(scene):
    """Mica's words for the filter of the scene's picture."""
    cycles = scene.cycles
    if scene.render.engine != "CYCLES":  # EEVEE's size is the Blackman-Harris window's half width
        return ["blackman-harris", f"{2 * scene.render.filter_size:.7g}"]
    if cycles.pixel_filter_type == "GAUSSIAN":  # Cycles cuts it off at 6 standard deviations
        return ["gaussian", f"{cycles.filter_width / 12:.7g}"]
    return ["box", "1"] if cycles.pixel_filter_type == "BOX" else ["blackman-harris", f"{cycles.filter_width:.7g}"]


def program():
    addon = bpy.context.preferences.addons.get(__name__)
    return (addon and bpy.path.abspath(addon.preferences.program)) or os.environ.get("MICA") or "mica"


def call_mica(arguments):
    """@return what Mica warns of"""
    try:
        done = subprocess.run([program(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except OSError as error:
        advice = "name Mica's program in the add-on's preferences or in MICA"
        raise Failure(f"{program()} does not start ({error.strerror}): {advice}") from error
    print(done.stderr, end="")
    if done.returncode != 0:
        raise Failure(f"mica glints ends with {done.returncode}: {done.stderr.strip()}")
    return [line.removeprefix("warning: ") for line in done.stderr.splitlines() if line.startswith("warning: ")]


def check_objects(things, materials):
    for thing in things:
        glints = [slot.material.name for slot in thing.material_slots if slot.material in materials]
        if glints and thing.type == "MESH" and not thing.data.uv_layers:
            raise Failure(f"object '{thing.name}' has no UV map, which the glints of material '{glints[0]}' need")


def check_scene(scene, materials, lamps):
    if not hasattr(scene, "cycles"):
        raise Failure("Cycles, which renders the G-buffer, is switched off in the preferences")
    linked = [material.name for material in materials if material.library]
    if linked:
        raise Failure(f"material '{linked[0]}' is another file's: make it local, or override it")
    if scene.render.use_border and scene.render.use_crop_to_border:
        raise Failure("the picture is cropped to a render region: switch 'Crop to Render Region' off")
    for what, there in (("camera", scene.camera), ("material with Mica glints", materials), ("lamp", lamps)):
        if not there:
            raise Failure(f"scene '{scene.name}' has no {what}")


def make_layer(scene, view_layer, depsgraph, folder):
    """Renders the G-buffer and has Mica make FOLDER/layer.exr. Nothing of the scene is changed after it.

    @return the layer's path and what the artist should know
    """
    materials = [material for material in bpy.data.materials
                 if material.mica_glints.enabled and material.users > material.use_fake_user]
    things = list(dict.fromkeys(rendered_objects(view_layer.layer_collection)))
    lamps, warnings = [thing for thing in things if is_lamp(thing)], []
    check_scene(scene, materials, lamps)
    check_objects(things, materials)
    folder.mkdir(parents=True, exist_ok=True)
    gbuffer, layer = folder / "gbuffer.exr", folder / "layer.exr"
    with gbuffer_scene(scene, view_layer, materials, lamps) as (fit, groups):
        write_json(gbuffer.with_suffix(".json"), fit, depsgraph, lamps, groups, warnings)
        write_toml(folder / "scene.toml", scene, materials, warnings)
        fit.render.filepath = str(gbuffer)
        if bpy.ops.render.render(write_still=True, scene=fit.name) != {"FINISHED"}:
            raise Failure("the rendering of the G-buffer was stopped")
    preset, (kind, width) = "blender5" if bpy.app.version >= (5, 0, 0) else "blender3", filter_of(scene)
    warnings += call_mica(["glints", str(gbuffer), "--scene", str(folder / "scene.toml"), "-o", str(layer),
                           "--preset", preset, "--filter", kind, "--filter-width", width,
                           "--scale", str(scene.mica_glints.scale), "--quiet"])
    return layer, warnings


# --- The compositor ---
def compositor_of(scene):
    """The scene's tree, and its node for the result."""
    if hasattr(scene, "compositing_node_group"):  # from Blender 5.0 on
        kind, tree = "NodeGroupOutput", scene.compositing_node_group
        if not tree:
            tree = scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
            tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    else:
        scene.use_nodes = True
        kind, tree = "CompositorNodeComposite", scene.node_tree
    return tree, next((node for node in tree.nodes if node.bl_idname == kind), None) or tree.nodes.new(kind)


def picture_of(tree, output, scene, view_layer):
    """The picture's socket: of its Render Layers node or, so that glints stay sharp, of a Denoise node behind it."""
    rendered = [node for node in tree.nodes if node.bl_idname == "CompositorNodeRLayers" and node.scene == scene]
    node = next((node for node in rendered if node.layer == view_layer.name), None)
    if node is None:
        node = tree.nodes.new("CompositorNodeRLayers")
        node.scene, node.layer = scene, view_layer.name
    picture = node.outputs["Image"]
    denoised = [link.to_node for link in picture.links if link.to_node.bl_idname == "CompositorNodeDenoise"]
    picture = denoised[0].outputs["Image"] if denoised else picture
    if not output.inputs[0].is_linked:
        tree.links.new(picture, output.inputs[0])
    return picture


def add_node(tree):
    """A node that adds, and its sockets: two inputs and the sum, which has the first one's alpha."""
    try:
        node, inputs, result = tree.nodes.new("CompositorNodeMixRGB"), (1, 2), 0
    except RuntimeError:  # from Blender 5.0 on
        node, inputs, result = tree.nodes.new("ShaderNodeMix"), (6, 7), 2
        node.data_type = "RGBA"
    node.blend_type, node.name, node.label = "ADD", LAYER + " Add", LAYER
    node.inputs[0].default_value = 1
    return node, *(node.inputs[number] for number in inputs), node.outputs[result]


def add_to_compositor(scene, view_layer, path):
    tree, output = compositor_of(scene)
    image = tree.nodes.get(LAYER) or tree.nodes.new("CompositorNodeImage")
    image.name = image.label = LAYER
    image.image = bpy.data.images.load(str(path), check_existing=True)
    image.image.alpha_mode = "PREMUL"
    image.image.reload()
    if tree.nodes.get(LAYER + " Add"):
        return
    picture = picture_of(tree, output, scene, view_layer)
    targets = [link.to_socket for link in picture.links]
    node, first, second, result = add_node(tree)
    node.location = picture.node.location.x + 300, picture.node.location.y
    image.location = picture.node.location.x, picture.node.location.y - 450
    for target in targets:
        tree.links.new(result, target)
    tree.links.new(picture, first)
    tree.links.new(image.outputs["Image"], second)


# --- Buttons ---
class MicaGlintsRender(bpy.types.Operator):
    """Renders the G-buffer, has Mica make the layer, and adds it in the compositor"""
    bl_idname, bl_label, bl_options = "render.mica_glints", "Render Glints", {"UNDO"}

    def execute(self, context):
        scene, view_layer = context.scene, context.view_layer
        try:
            if scene.mica_glints.folder.startswith("//") and not bpy.data.filepath:
                raise Failure("save the scene first: the folder of the glints lies beside it")
            folder = Path(bpy.path.abspath(scene.mica_glints.folder))
            path, warnings = make_layer(scene, view_layer, context.evaluated_depsgraph_get(), folder)
            add_to_compositor(scene, view_layer, path)
        except (Failure, OSError, RuntimeError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for warning in warnings:
            self.report({"WARNING"}, warning)
        return {"FINISHED"}


class MicaGlintsPanel:
    bl_label, bl_space_type, bl_region_type, bl_options = "Mica glints", "PROPERTIES", "WINDOW", {"DEFAULT_CLOSED"}

    def draw(self, context):
        self.layout.use_property_split = True
        self.draw_settings(context)

    def draw_properties(self, owner, *names):
        for name in names:
            self.layout.prop(owner, name)


class MATERIAL_PT_mica_glints(MicaGlintsPanel, bpy.types.Panel):
    bl_context = "material"

    @classmethod
    def poll(cls, context):
        return context.material is not None

    def draw_header(self, context):
        self.layout.prop(context.material.mica_glints, "enabled", text="")

    def draw_settings(self, context):
        settings = context.material.mica_glints
        self.layout.active = settings.enabled
        if settings.source == "file":
            own = ("file", "encoding", "green")
        else:
            directed = ("direction",) if "{direction}" in GENERATORS[settings.source] else ()
            own = ("resolution", "size", "strength", *directed, "seed")
        color = ("own_color", "color") if settings.own_color else ("own_color",)
        self.draw_properties(settings, "source", *own, "repeat", "method", "roughness", *color)


class RENDER_PT_mica_glints(MicaGlintsPanel, bpy.types.Panel):
    bl_context = "render"

    def draw_settings(self, context):
        self.draw_properties(context.scene.mica_glints, "folder", "tolerance", "scale", "shadow_samples")
        self.layout.operator(MicaGlintsRender.bl_idname)


CLASSES = (MicaGlintsMaterial, MicaGlintsScene, MicaGlintsPreferences, MicaGlintsRender, MATERIAL_PT_mica_glints,
           RENDER_PT_mica_glints)


def register():
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Material.mica_glints = PointerProperty(type=MicaGlintsMaterial)
    bpy.types.Scene.mica_glints = PointerProperty(type=MicaGlintsScene)


def unregister():
    del bpy.types.Scene.mica_glints, bpy.types.Material.mica_glints
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)


# --- Without a window ---
def render_composite(scene, folder):
    scene.render.use_compositing = True
    bpy.ops.render.render(scene=scene.name)
    for name, file_format, depth in (("composite.exr", "OPEN_EXR", "32"), ("composite.png", "PNG", "8")):
        write_format(scene.render.image_settings, "IMAGE", file_format, depth)
        bpy.data.images["Render Result"].save_render(str(folder / name), scene=scene)


def main(words):
    parser = argparse.ArgumentParser(prog="mica_glints.py", description=__doc__.split("\n")[0])
    parser.add_argument("scene", nargs="?", help="SCENE.blend, where Blender has not opened it already")
    parser.add_argument("--out", required=True, help="folder of the pictures")
    parser.add_argument("--mica", help="the program; default MICA of the environment, then mica in PATH")
    options = parser.parse_args(words)
    if options.mica:
        os.environ["MICA"] = options.mica
    installed = hasattr(bpy.types.Scene, "mica_glints")
    if not installed:
        register()
    try:
        if options.scene:
            bpy.ops.wm.open_mainfile(filepath=os.path.abspath(options.scene))
        scene, view_layer, folder = bpy.context.scene, bpy.context.view_layer, Path(options.out).resolve()
        path, warnings = make_layer(scene, view_layer, bpy.context.evaluated_depsgraph_get(), folder)
        add_to_compositor(scene, view_layer, path)
        render_composite(scene, folder)
    except (Failure, OSError, RuntimeError) as error:
        sys.exit(f"mica_glints: {error}")
    finally:
        if not installed:
            unregister()
    for warning in warnings:
        print(f"mica_glints: {warning}", file=sys.stderr)


if __name__ == "__main__":
    if "--" in sys.argv:
        main(sys.argv[sys.argv.index("--") + 1:])
    else:  # run from Blender's text editor
        register()
