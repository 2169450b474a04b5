# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Photos as files, with EXIF that the tests write."""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sextant.images.photo_file import decode_colour, geo_position, photo_size, read_grey, read_rgb

ORIENTATION, GPS = 0x0112, 0x8825
LUND = Path(__file__).resolve().parents[4] / "shared" / "data" / "places" / "lund"


def written(path, gps=None, orientation=None, size=(64, 48)):
    """A picture whose left half is black, its right white."""
    pixels = np.zeros((size[1], size[0]), np.uint8)
    pixels[:, size[0] // 2 :] = 255
    exif = Image.Exif()
    if orientation:
        exif[ORIENTATION] = orientation
    if gps:
        exif[GPS] = gps
    Image.fromarray(pixels).save(path, exif=exif)
    return path


def gps(latitude, latitude_ref, longitude, longitude_ref, **more):
    direction = {17: more["direction"]} if "direction" in more else {}
    latitude, longitude = (
        tuple(map(float, angle)) for angle in (latitude, longitude)
    )  # as Pillow 8.1 wants it
    return {1: latitude_ref, 2: latitude, 3: longitude_ref, 4: longitude, **direction}


def test_coordinates_are_degrees_minutes_seconds(tmp_path):
    path = written(tmp_path / "a.jpg", gps((55.0, 42.0, 18.0), "N", (13.0, 11.0, 36.0), "E"))
    position = geo_position(path)
    assert position.latitude == pytest.approx(55 + 42 / 60 + 18 / 3600)
    assert position.longitude == pytest.approx(13 + 11 / 60 + 36 / 3600)
    assert position.yaw is None


def test_south_and_west_are_negative(tmp_path):
    position = geo_position(written(tmp_path / "a.jpg", gps((33.5, 0, 0), "S", (70.25, 0, 0), "W")))
    assert position[:2] == pytest.approx((-33.5, -70.25))


@pytest.mark.parametrize("compass, yaw", [(0, 90), (90, 0), (180, -90), (270, 180), (45, 45), (359, 91)])
def test_a_compass_counts_from_north_clockwise(tmp_path, compass, yaw):
    path = written(tmp_path / "a.jpg", gps((1, 0, 0), "N", (1, 0, 0), "E", direction=float(compass)))
    assert geo_position(path).yaw == pytest.approx(math.radians(yaw))


def test_a_photo_without_coordinates_has_none(tmp_path):
    assert geo_position(written(tmp_path / "a.jpg")) is None


def test_coordinates_that_are_none_are_refused(tmp_path):
    path = written(tmp_path / "a.jpg", gps((95.0, 0, 0), "N", (13.0, 0, 0), "E"))
    with pytest.raises(ValueError, match="a.jpg: the coordinates in its EXIF are invalid"):
        geo_position(path)


@pytest.mark.skipif(not LUND.is_dir(), reason="external test data")
def test_every_street_photo_has_a_position():
    positions = [geo_position(path) for path in sorted(LUND.glob("*.jpg"))]
    assert len(positions) == 29
    assert all(55.6 < position.latitude < 55.8 and 13.1 < position.longitude < 13.3 for position in positions)


def test_a_turned_photo_is_read_upright(tmp_path):
    path = written(tmp_path / "a.png", orientation=6)  # the camera was turned: right is down
    grey = read_grey(path)
    assert grey.shape == (64, 48) and photo_size(path) == (48, 64)
    assert grey[:20].max() == 0 and grey[-20:].min() == 255


def test_a_large_jpeg_is_read_smaller_but_not_too_small(tmp_path):
    path = written(tmp_path / "a.jpg", size=(2048, 1536))
    assert read_grey(path, 320).shape == (384, 512)
    assert read_grey(path).shape == (1536, 2048)
    assert read_grey(written(tmp_path / "b.jpg", size=(300, 200)), 320).shape == (200, 300)


def test_a_colour_image_becomes_grey(tmp_path):
    Image.new("RGB", (8, 8), (255, 0, 0)).save(tmp_path / "a.png")
    assert read_grey(tmp_path / "a.png").tolist() == [[76] * 8] * 8  # ITU-R BT.601


def test_colours_are_blue_green_red(tmp_path):
    path = tmp_path / "a.png"
    for colour, expected in (((255, 128, 0), [0, 128, 255]), (90, [90, 90, 90])):
        Image.new("L" if isinstance(colour, int) else "RGB", (8, 6), colour).save(path)
        image = decode_colour(path.read_bytes(), path)
        assert image.shape == (6, 8, 3) and image.flags.c_contiguous and image[2, 3].tolist() == expected


@pytest.mark.parametrize("name", ["a.png", "a.tif"])
def test_of_16_bits_the_upper_8_are_taken(tmp_path, name):
    pixels = np.array([[0, 1, 255, 256], [5000, 30000, 55000, 65535]], np.uint16)
    Image.fromarray(pixels).save(tmp_path / name)
    assert read_grey(tmp_path / name).tolist() == (pixels // 256).tolist()
    assert read_rgb(tmp_path / name)[:, :, 1].tolist() == (pixels // 256).tolist()


def test_a_damaged_exif_is_reported(tmp_path):
    exif = Image.Exif()
    exif[ORIENTATION], exif[0x010F] = 6, "maker"
    words_for_a_width = exif.tobytes().replace(b"\x01\x0f\x00\x02", b"\x01\x00\x00\x02")
    words_for_a_width = words_for_a_width.replace(b"\x0f\x01\x02\x00", b"\x00\x01\x02\x00")  # little-endian
    Image.new("L", (8, 6)).save(tmp_path / "a.jpg", exif=words_for_a_width)
    with pytest.raises(ValueError, match="a.jpg: the image is damaged"):
        read_grey(tmp_path / "a.jpg")


def test_a_large_jpeg_in_colour_is_read_smaller_too(tmp_path):
    path = written(tmp_path / "a.jpg", size=(2048, 1536), orientation=6)
    assert decode_colour(path.read_bytes(), path, 320).shape == (512, 384, 3)


def test_an_image_in_colour_is_upright_and_white_where_it_is_transparent(tmp_path):
    exif = Image.Exif()
    exif[ORIENTATION] = 6
    image = Image.new("RGBA", (8, 4), (10, 20, 30, 255))
    image.putpixel((0, 0), (0, 0, 0, 0))
    image.save(tmp_path / "a.png", exif=exif)
    rgb = read_rgb(tmp_path / "a.png")
    assert rgb.shape == (8, 4, 3)
    assert rgb[0, 3].tolist() == [255, 255, 255] and rgb[7, 0].tolist() == [10, 20, 30]


@pytest.mark.parametrize("name", ["a.jpg", "a.png"])
@pytest.mark.parametrize("left", [0.1, 0.5, 0.98])
def test_a_truncated_photo_is_refused(tmp_path, name, left):
    path = tmp_path / name
    Image.fromarray(np.random.default_rng(1).integers(0, 255, (200, 300)).astype(np.uint8)).save(path)
    path.write_bytes(path.read_bytes()[: int(left * path.stat().st_size)])
    with pytest.raises(ValueError, match=f"{name}: the image is damaged"):
        read_grey(path, 320)


@pytest.mark.parametrize("content", [b"", b"no picture", b"\xff\xd8\xff"])
@pytest.mark.parametrize("read", [read_grey, read_rgb, photo_size, geo_position])
def test_what_is_no_image_is_refused(tmp_path, content, read):
    (tmp_path / "a.jpg").write_bytes(content)
    with pytest.raises(ValueError, match="a.jpg: is not an image"):
        read(tmp_path / "a.jpg")


def test_a_file_that_is_not_there_is_an_os_error(tmp_path):
    with pytest.raises(FileNotFoundError):
        read_grey(tmp_path / "a.jpg")


def half(dtype, white):
    """The left half black, the right half white."""
    pixels = np.zeros((48, 64), dtype)
    pixels[:, 32:] = white
    return pixels


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "name, image, more",
    [
        ("a.jpg", Image.fromarray(half(np.uint8, 255)).convert("CMYK"), {}),
        ("a.png", Image.fromarray(half(np.uint8, 255)).convert("P"), {}),
        ("a.png", Image.fromarray(half(np.uint8, 1)).convert("P"), {"transparency": bytes([255, 0])}),
        ("a.png", Image.fromarray(half(np.uint8, 255)).convert("1"), {}),
        ("a.png", Image.fromarray(half(np.uint8, 255)).convert("LA"), {}),
        ("a.gif", Image.fromarray(half(np.uint8, 255)), {}),
    ],
)
def test_black_is_black_and_white_is_white(tmp_path, name, image, more):
    image.save(tmp_path / name, **more)
    for read in (read_grey, read_rgb):
        pixels = read(tmp_path / name)
        assert pixels.dtype == np.uint8 and pixels.shape[:2] == (48, 64)
        assert pixels[:, :28].max() < 5 and pixels[:, 36:].min() > 250


@pytest.mark.parametrize("name", ["a.gif", "a.webp", "a.png"])
def test_of_a_moving_image_the_first_is_read(tmp_path, name):
    frames = [Image.new("L", (8, 8), grey).convert("RGB") for grey in (200, 50)]
    frames[0].save(tmp_path / name, save_all=True, append_images=frames[1:], lossless=True)
    assert abs(int(read_grey(tmp_path / name)[0, 0]) - 200) < 5


@pytest.mark.parametrize("dtype, white", [(np.float32, 1.0), (np.int32, -1), (np.int32, 1 << 20)])
def test_what_is_no_brightness_is_refused(tmp_path, dtype, white):
    Image.fromarray(half(dtype, white)).save(tmp_path / "a.tif")
    with pytest.raises(ValueError, match="a.tif: its pixels .*; save it with 8 or 16"):
        read_grey(tmp_path / "a.tif")


@pytest.mark.parametrize("name, left", [("a.webp", 2000), ("a.png", 20), ("a.jpg", 100)])
@pytest.mark.parametrize("read", [read_grey, read_rgb, photo_size, geo_position])
def test_what_is_cut_off_in_its_header_is_named(tmp_path, name, left, read):
    noise = np.random.default_rng(1).integers(0, 255, (99, 99)).astype(np.uint8)
    Image.fromarray(noise).save(tmp_path / name)
    (tmp_path / name).write_bytes((tmp_path / name).read_bytes()[:left])
    with pytest.raises(ValueError, match=f"{name}: is not an image"):
        read(tmp_path / name)


def test_no_program_is_run_for_a_photo(tmp_path):
    drawing = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 10 10\n%%EndComments\nshowpage\n"
    (tmp_path / "a.jpg").write_bytes(drawing)
    with pytest.raises(ValueError, match="a.jpg: has format EPS; allowed are JPEG"):
        read_grey(tmp_path / "a.jpg")
