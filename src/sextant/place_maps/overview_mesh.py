# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Writes an image as a textured rectangle for 3-D viewers: COLLADA 1.4.1 with a PNG file."""

import hashlib
import io
from pathlib import Path

import numpy as np
from PIL import Image

from sextant.base.atomic_file import atomic_file

# Corners counterclockwise from the lower left, which is also the origin of the texture coordinates. The
# material is emissive, so that its colours do not depend on the viewer's lights.
_COLLADA = """<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
  <library_images><image id="picture"><init_from>{texture}</init_from></image></library_images>
  <library_effects><effect id="paper"><profile_COMMON>
    <newparam sid="surface"><surface type="2D"><init_from>picture</init_from></surface></newparam>
    <newparam sid="sampler"><sampler2D><source>surface</source></sampler2D></newparam>
    <technique sid="common"><lambert>
      <emission><color>1 1 1 1</color></emission>
      <ambient><color>0 0 0 1</color></ambient>
      <diffuse><texture texture="sampler" texcoord="UV"/></diffuse>
    </lambert></technique>
  </profile_COMMON></effect></library_effects>
  <library_materials><material id="material"><instance_effect url="#paper"/></material></library_materials>
  <library_geometries><geometry id="rectangle"><mesh>
    <source id="corners">
      <float_array id="corners_array" count="12">
        0 0 0 {width} 0 0 {width} {height} 0 0 {height} 0
      </float_array>
      <technique_common><accessor source="#corners_array" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <source id="normals"><float_array id="normals_array" count="3">0 0 1</float_array>
      <technique_common><accessor source="#normals_array" count="1" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <source id="uv"><float_array id="uv_array" count="8">0 0 1 0 1 1 0 1</float_array>
      <technique_common><accessor source="#uv_array" count="4" stride="2">
        <param name="S" type="float"/><param name="T" type="float"/>
      </accessor></technique_common></source>
    <vertices id="vertices"><input semantic="POSITION" source="#corners"/></vertices>
    <triangles material="material" count="2">
      <input semantic="VERTEX" source="#vertices" offset="0"/>
      <input semantic="NORMAL" source="#normals" offset="1"/>
      <input semantic="TEXCOORD" source="#uv" offset="2" set="0"/>
      <p>0 0 0 1 0 1 2 0 2 0 0 0 2 0 2 3 0 3</p>
    </triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="scene"><node><instance_geometry url="#rectangle">
    <bind_material><technique_common><instance_material symbol="material" target="#material">
      <bind_vertex_input semantic="UV" input_semantic="TEXCOORD" input_set="0"/>
    </instance_material></technique_common></bind_material>
  </instance_geometry></node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
"""


def write_overview_mesh(folder: Path, image: np.ndarray, width: float, height: float) -> Path:
    """Writes the rectangle from (0, 0, 0) to (width, height, 0); seen from +z, the image is upright.

    File names contain a hash of the content, as viewers cache meshes by name.

    :param image: uint8 (rows, columns, 3), RGB
    :param width: height: metres
    :returns: the .dae file
    :raises OSError: a file cannot be written
    """
    png = io.BytesIO()
    Image.fromarray(image).save(png, "PNG")
    digest = hashlib.sha256(png.getvalue() + f"{width} {height}".encode()).hexdigest()[:16]
    mesh = folder / f"overview_{digest}.dae"
    texture = mesh.with_suffix(".png")
    with atomic_file(texture, "wb") as file:
        file.write(png.getvalue())
    with atomic_file(mesh) as file:
        file.write(_COLLADA.format(texture=texture.name, width=width, height=height))
    return mesh
