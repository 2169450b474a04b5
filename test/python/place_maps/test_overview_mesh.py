# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The textured rectangle, read by the standard (COLLADA 1.4.1)."""

import xml.etree.ElementTree as ElementTree

import numpy as np
from PIL import Image

from sextant.place_maps.overview_mesh import write_overview_mesh

COLLADA = {"c": "http://www.collada.org/2005/11/COLLADASchema"}
PICTURE = np.random.default_rng(1).integers(0, 255, (30, 60, 3)).astype(np.uint8)


def numbers(root, name, width):
    text = root.find(f".//c:float_array[@id='{name}']", COLLADA).text
    return np.array(text.split(), float).reshape(-1, width)


def test_the_image_lies_upright_in_its_size(tmp_path):
    mesh = write_overview_mesh(tmp_path, PICTURE, 20.5, 10.25)
    root = ElementTree.parse(str(mesh)).getroot()
    corners, uv = numbers(root, "corners_array", 3), numbers(root, "uv_array", 2)
    np.testing.assert_array_equal(corners, np.column_stack([uv * [20.5, 10.25], np.zeros(4)]))
    indices = np.array(root.find(".//c:triangles/c:p", COLLADA).text.split(), int).reshape(2, 3, 3)
    np.testing.assert_array_equal(indices[:, :, 0], indices[:, :, 2])  # corners and uv
    a, b, c = (corners[indices[:, i, 0]] for i in range(3))
    area = np.cross(b - a, c - a)[:, 2] / 2
    np.testing.assert_allclose(area, 20.5 * 10.25 / 2)  # both seen from above


def test_the_texture_is_the_image(tmp_path):
    mesh = write_overview_mesh(tmp_path, PICTURE, 2.0, 1.0)
    root = ElementTree.parse(str(mesh)).getroot()
    texture = root.find(".//c:image/c:init_from", COLLADA).text
    np.testing.assert_array_equal(np.asarray(Image.open(tmp_path / texture)), PICTURE)
    linked = {each.get("id") for each in root.iter() if each.get("id")}
    urls = {
        each.get("url") or each.get("target") for each in root.iter() if each.get("url") or each.get("target")
    }
    assert {url[1:] for url in urls if url.startswith("#")} <= linked


def test_another_content_has_another_name(tmp_path):
    first = write_overview_mesh(tmp_path, PICTURE, 2.0, 1.0)
    assert write_overview_mesh(tmp_path, PICTURE, 2.0, 1.0) == first
    assert write_overview_mesh(tmp_path, PICTURE, 2.0, 1.5) != first
    assert write_overview_mesh(tmp_path, PICTURE[::-1], 2.0, 1.0) != first
