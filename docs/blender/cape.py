"""Takes the steps of `docs/blender.md` in Blender 3.4 or 4.2: from an empty file to a character with a cape.

`blender --factory-startup --python docs/blender/cape.py -- FOLDER` writes `cape.glb` to the folder, and a picture of the window after
each step; with `--background` it writes the file only. `.ci/blender` runs it.
"""

import os
import pathlib
import re
import subprocess
import sys
import traceback

import bpy
import numpy
from mathutils import Euler

# Blender 3.4 asks for a name that newer numpy has dropped.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

ROOT = pathlib.Path(__file__).parents[2]
FOLDER = pathlib.Path(sys.argv[sys.argv.index("--") + 1])

# Columns and rows of vertices; height of the collar, and what the cape falls and widens by, in metres.
COLUMNS, ROWS = 13, 23
COLLAR, FALL, HALF_WIDTH, WIDER = 1.46, 0.95, 0.19, 0.16

# The bones that carry the cape.
CARRIERS = ["hips", "spine", "chest", "left thigh", "right thigh"]

# The programs that move the mouse.
MOUSE = []


def in_view(kind="VIEW_3D"):
    """The context of an editor of the window; without a window the context as it is."""
    if bpy.app.background:
        return bpy.context.temp_override()
    window = bpy.context.window_manager.windows[0]
    area = next(area for area in window.screen.areas if area.type == kind)
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window, area=area, region=region)


def look(distance, height, azimuth=-0.55, wires=False):
    """Looks at the back of the character from a distance in metres."""
    if bpy.app.background:
        return
    with in_view():
        bpy.context.space_data.overlay.show_wireframes = wires
        region = bpy.context.space_data.region_3d
        region.view_perspective = "PERSP"
        region.view_rotation = Euler((1.35, 0.0, azimuth)).to_quaternion()
        region.view_location = (0.0, 0.0, height)
        region.view_distance = distance


def show_properties(tab):
    """Opens a tab of the properties editor."""
    with in_view("PROPERTIES"):
        bpy.context.space_data.context = tab


def mouse(*words):
    """Moves the mouse, and presses its buttons and keys of the keyboard: the language of `xdotool`."""
    MOUSE.append(subprocess.Popen(["xdotool", *map(str, words)]))


def part_down(vertex):
    """How far down the cape a vertex is, from 0 at the collar to 1 at the hem."""
    return (COLLAR - vertex.co.z) / FALL


def is_collar(vertex):
    """True for the top row of the cape."""
    return part_down(vertex) < 1e-3


def select(*names):
    """Selects objects. The last one becomes active."""
    bpy.ops.object.select_all(action="DESELECT")
    for name in names:
        bpy.data.objects[name].select_set(True)
        bpy.context.view_layer.objects.active = bpy.data.objects[name]


def tidy():
    """Leaves the 3D viewport and the properties editor."""
    if not bpy.app.background:
        for kind in ("DOPESHEET_EDITOR", "OUTLINER"):
            with in_view(kind):
                bpy.ops.screen.area_close()
        with in_view("PROPERTIES"):
            edge = bpy.context.area.x
        drag = ["mousedown", 1, "sleep", 0.5, "mousemove", edge - 60, 400, "sleep", 0.5, "mousemove", edge - 120, 400]
        mouse("mousemove", edge - 1, 400, "sleep", 0.5, *drag, "sleep", 0.5, "mouseup", 1)
    with in_view():
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.delete()


def character():
    """Step 1: a rigged character in its rest pose."""
    # Animations are exported frame by frame.
    bpy.context.scene.render.fps = 30
    with in_view():
        bpy.ops.import_scene.gltf(filepath=str(ROOT / "assets/models/cape.glb"), bone_heuristic="TEMPERANCE")
    bpy.data.meshes.remove(bpy.data.objects["Cape"].data)
    bpy.data.materials.remove(bpy.data.materials["cloth"])
    bpy.data.objects["Character"].data.pose_position = "REST"
    for helper in bpy.data.objects:
        helper.hide_set(helper.name not in ("Character", "Figure"))
    with in_view():
        select("Character")
    look(2.7, 0.9)


def grid():
    """Step 2: a grid behind the shoulders."""
    with in_view():
        bpy.ops.mesh.primitive_grid_add(
            "INVOKE_REGION_WIN",
            True,
            x_subdivisions=COLUMNS - 1,
            y_subdivisions=ROWS - 1,
            size=1.0,
            location=(0.0, -0.2, COLLAR - FALL / 2),
            rotation=(1.5708, 0.0, 0.0),
        )
        cape = bpy.context.active_object
        cape.name = cape.data.name = "Cape"
        cape.scale = (2 * HALF_WIDTH, FALL, 1.0)
    look(2.2, 0.95, wires=True)


def shape():
    """Step 3: a wider hem that stands off, and applied transforms."""
    cape = bpy.data.objects["Cape"]
    look(2.2, 0.95, azimuth=-1.2)
    with in_view():
        if not bpy.app.background:
            # The panel of the grid.
            bpy.context.space_data.show_region_hud = False
        bpy.ops.object.transform_apply(location=True, rotation=True, scale=True)
        bpy.ops.object.shade_smooth()
    for vertex in cape.data.vertices:
        down = part_down(vertex)
        vertex.co.x *= (HALF_WIDTH + WIDER * down) / HALF_WIDTH
        vertex.co.y = -0.17 - 0.07 * down
    material = bpy.data.materials.new("cloth")
    material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.4, 0.05, 0.05, 1.0)
    material.use_backface_culling = False
    cape.data.materials.append(material)
    with in_view():
        bpy.ops.object.mode_set(mode="EDIT")


def weights():
    """Step 4: the cape's parent is the armature, and the chest alone carries the collar."""
    look(2.2, 0.95)
    with in_view():
        bpy.ops.object.mode_set(mode="OBJECT")
        select("Cape", "Character")
        bpy.ops.object.parent_set(type="ARMATURE_AUTO")
        select("Cape")
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
        groups = bpy.context.active_object.vertex_groups
        for group in [group for group in groups if group.name not in CARRIERS]:
            groups.remove(group)
        bpy.ops.object.vertex_group_normalize_all(lock_active=False)
        collar = [vertex.index for vertex in bpy.data.objects["Cape"].data.vertices if is_collar(vertex)]
        for group in groups:
            group.remove(collar)
        groups["chest"].add(collar, 1.0, "REPLACE")
        groups.active_index = groups["chest"].index
    for vertex in bpy.data.objects["Cape"].data.vertices:
        assert sum(group.weight for group in vertex.groups) > 0.99, "a vertex without weights"


def paint():
    """Step 5, as by hand: red pins and green limits."""
    with in_view():
        bpy.ops.object.mode_set(mode="OBJECT")
    mesh = bpy.data.objects["Cape"].data
    colours = mesh.color_attributes.new("Color", "FLOAT_COLOR", "POINT")
    for vertex in mesh.vertices:
        colours.data[vertex.index].color = (float(is_collar(vertex)), part_down(vertex), 0.0, 1.0)
    with in_view():
        bpy.ops.object.mode_set(mode="VERTEX_PAINT")


def paint_from_groups():
    """Step 5, by the script of the page: it takes the same paint from vertex groups, beside another attribute of colours."""
    cape = bpy.data.objects["Cape"]
    painted = [tuple(value.color) for value in cape.data.color_attributes["Color"].data]
    cape.data.color_attributes.remove(cape.data.color_attributes["Color"])
    cape.data.color_attributes.new("Tint", "FLOAT_COLOR", "POINT")
    groups = [cape.vertex_groups.new(name=name) for name in ("pins", "limits")]
    for index, colour in enumerate(painted):
        for group, value in zip(groups, colour):
            group.add([index], value, "REPLACE")
    page = (ROOT / "docs/blender.md").read_text()
    script = re.search(r"```python\n(.*?)```", page, re.DOTALL).group(1)
    with in_view():
        exec(compile(script, "docs/blender.md", "exec"), {})
    again = [tuple(value.color) for value in cape.data.color_attributes["Color"].data]
    assert numpy.allclose(painted, again, atol=1e-6), "the script paints otherwise"
    cape.data.color_attributes.remove(cape.data.color_attributes["Tint"])
    for group in groups:
        cape.vertex_groups.remove(group)


def attributes():
    """Attributes instead of colours: their names begin with an underscore."""
    mesh = bpy.data.objects["Cape"].data
    painted = [tuple(value.color) for value in mesh.color_attributes["Color"].data]
    for channel, name in enumerate(("_PINS", "_LIMITS")):
        mesh.attributes.new(name, "FLOAT", "POINT")
        mesh.attributes[name].data.foreach_set("value", [colour[channel] for colour in painted])


def components():
    """Components of Bevy in the extras of meshes, where Skein's extension of Blender would write them."""
    cloth = {"paint": {"max_distance": "Green", "full_distance": 0.7}}
    fabric = {"areal_density": 0.3, "drag": 1.0, "thickness": 0.01}
    bpy.data.objects["Cape"].data["skein"] = [
        {"bevy_drape::render::from_mesh::cloth_mesh::ClothMesh": cloth},
        {"bevy_drape::body::fabric::Fabric": fabric},
    ]
    bpy.data.objects["Figure"].data["skein"] = [
        {"bevy_drape::render::from_mesh::body_colliders::BodyColliders": {"friction": 0.3}},
    ]


def export(invoke=False):
    """Step 6: the file. Animations are sampled from the pose."""
    bpy.data.objects["Character"].data.pose_position = "POSE"
    with in_view():
        options = {name: True for name in ("export_apply", "export_attributes", "export_extras", "export_skins", "export_animations")}
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
        # Blender 4.2 names which colours; before it there was one tick.
        colours = {"export_vertex_color": "ACTIVE"} if "export_vertex_color" in known else {"export_colors": True}
        options.update(colours, filepath=str(FOLDER / "cape.glb"))
        bpy.ops.export_scene.gltf("INVOKE_DEFAULT" if invoke else "EXEC_DEFAULT", **options)


# A step, the picture afterwards, the tab of properties in it, and the head of a panel that is opened for it.
STEPS = [
    (tidy, None, None, None),
    (character, "character", "DATA", None),
    (grid, "grid", "OBJECT", (124, 752, "click", 1)),
    (shape, "shape", "MATERIAL", None),
    (weights, "weights", "DATA", None),
    (paint, "paint", "DATA", (1036, 534, "keydown", "ctrl", "click", 1, "keyup", "ctrl")),
    (paint_from_groups, None, None, None),
    (attributes, None, None, None),
    (components, None, None, None),
    (export, None, None, None),
    (lambda: export(invoke=True), "export", None, (1043, 285, "click", 1, "sleep", 0.5, "mousemove", 1056, 314, "click", 1)),
]


def steps():
    """Takes the steps one by one. Waits between them until the window is drawn."""
    for step, picture, tab, panel in STEPS:
        step()
        while any(moving.poll() is None for moving in MOUSE):
            yield 0.1
        yield 0.5
        if tab:
            show_properties(tab)
            yield 0.5
        if panel:
            mouse("mousemove", *panel)
        if picture:
            yield 1.5
            path = str(FOLDER / f"{picture}.png")
            subprocess.run(["import", "-window", "root", path], check=True)


def tick(waits=steps()):
    """One turn of the window's timer."""
    try:
        return next(waits)
    except StopIteration:
        os._exit(0)
    except Exception:
        traceback.print_exc()
        os._exit(1)


if bpy.app.background:
    # All but the last step, which is a dialogue.
    for step, *_ in STEPS[:-1]:
        step()
    # Blender as a module may crash when Python ends.
    os._exit(0)
else:
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    bpy.context.preferences.view.ui_scale = 1.1
    bpy.app.timers.register(tick, first_interval=3.0)
