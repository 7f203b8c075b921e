#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a scene of vecino with Blender's Cycles: python3 cycles_render.py SCENE.json OUT.exr --size WxH --spp N --max-depth D --seed S

Needs: pip install bpy (the wheel asks for one version of Python; see PyPI). Cycles' own sampler, box filter, no clamping, no denoising.
Spheres are meshes of 256 x 128 faces. Blender writes the time of rendering alone, without its start, into the image: the attribute
"cycles.ViewLayer.render_time". --planes emission adds the light that is seen directly, as a multilayer file; --planes guide writes that and
the first hits through the pixel centres, of one sample: what `vecino upsample --guide` reads.
"""
import json
import math
import pathlib

import bpy
from mathutils import Matrix, Vector

from arguments import render_arguments


def material_of(name, properties):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*properties.get("albedo", [0, 0, 0]), 1)
    surface = diffuse.outputs[0]
    if any(properties.get("emission", [0])):
        # One side emits: that of the normal.
        emission = nodes.new("ShaderNodeEmission")
        emission.inputs["Strength"].default_value = max(properties["emission"])
        emission.inputs["Color"].default_value = (*[e / max(properties["emission"]) for e in properties["emission"]], 1)
        both = nodes.new("ShaderNodeAddShader")
        links.new(emission.outputs[0], both.inputs[0])
        links.new(diffuse.outputs[0], both.inputs[1])
        mix = nodes.new("ShaderNodeMixShader")
        links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], mix.inputs[0])
        links.new(both.outputs[0], mix.inputs[1])
        links.new(diffuse.outputs[0], mix.inputs[2])
        surface = mix.outputs[0]
    links.new(surface, output.inputs["Surface"])
    return material


def add_objects(scene):
    materials = {name: material_of(name, properties) for name, properties in scene["materials"].items()}
    for number, thing in enumerate(scene["objects"]):
        if "sphere" in thing:
            bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=thing["sphere"]["radius"],
                                                 location=thing["sphere"]["center"])
            bpy.ops.object.shade_smooth()
            item = bpy.context.object
        else:
            positions = thing.get("quad") or thing["triangles"]["positions"]
            faces = [[0, 1, 2], [0, 2, 3]] if "quad" in thing else thing["triangles"]["indices"]
            mesh = bpy.data.meshes.new(str(number))
            mesh.from_pydata(positions, [], faces)
            item = bpy.data.objects.new(str(number), mesh)
            bpy.context.collection.objects.link(item)
        item.pass_index = number + 1
        item.data.materials.append(materials[thing["material"]])


def add_camera(camera):
    position, target = Vector(camera["position"]), Vector(camera["look_at"])
    forward = (target - position).normalized()
    right = forward.cross(Vector(camera["up"])).normalized()
    up = right.cross(forward)
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(camera["vertical_fov_degrees"])
    item = bpy.data.objects.new("camera", data)
    item.matrix_world = Matrix([[right[i], up[i], -forward[i], position[i]] for i in range(3)] + [[0, 0, 0, 1]])
    bpy.context.collection.objects.link(item)
    bpy.context.scene.camera = item


def add_passes(render, planes):
    layer = bpy.context.view_layer
    layer.use_pass_emit = layer.use_pass_environment = True
    if hasattr(render.image_settings, "media_type"):  # Blender 5
        render.image_settings.media_type = "MULTI_LAYER_IMAGE"
    render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    render.image_settings.color_depth = "32"
    if planes == "emission":
        return
    layer.use_pass_z = layer.use_pass_position = layer.use_pass_normal = True
    layer.use_pass_diffuse_color = layer.use_pass_object_index = True
    cycles = bpy.context.scene.cycles
    cycles.samples = 1
    cycles.max_bounces = 0
    cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    cycles.filter_width = 0.01  # as good as the middle of the pixel


def set_up(scene, arguments):
    render, cycles = bpy.context.scene.render, bpy.context.scene.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = arguments.size
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    render.image_settings.color_mode = "RGB"
    render.filepath = arguments.output
    cycles.samples, cycles.seed = arguments.spp, arguments.seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type = "BOX"
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.max_bounces = cycles.diffuse_bounces = arguments.max_depth - 1
    cycles.blur_glossy = 0
    if arguments.planes != "none":
        add_passes(render, arguments.planes)
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*scene.get("background", [0, 0, 0]), 1)
    bpy.context.scene.world = world


def main():
    arguments = render_arguments(__doc__)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = json.loads(pathlib.Path(arguments.scene).read_text())
    add_objects(scene)
    add_camera(scene["camera"])
    set_up(scene, arguments)
    bpy.ops.render.render(write_still=True)


main()
