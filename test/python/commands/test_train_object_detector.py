# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The command that trains a detector: a quick run from pictures to a network that is read again."""

import importlib.util
import sys

import numpy as np
import pytest
from made_labels import write_photos
from PIL import Image

from sextant.commands.train_object_detector import main
from sextant.labels.coco_file import write_coco_file
from sextant.labels.yolo_folder import write_yolo_folder
from sextant.objects.object_kinds import KINDS
from sextant.objects.yolo_detector import YoloDetector, YoloParams

HAS_TORCH = importlib.util.find_spec("torch") is not None
needs_torch = pytest.mark.skipif(not HAS_TORCH, reason="PyTorch is optional: apt install python3-torch")


@needs_torch
def test_a_quick_training_makes_a_network_and_goes_on_where_it_was(tmp_path, capsys):
    folder = tmp_path / "detector"
    assert main([str(folder), "--quick", "--size", "64"]) == 0
    output = capsys.readouterr().out
    assert "epoch 2 of 2" in output and "mean" in output and all(name in output for name in KINDS)
    detector = YoloDetector(YoloParams(model=str(folder / "objects.onnx")))
    assert (detector.classes, detector.size) == (list(KINDS), (64, 64))
    detector.detect(np.zeros((48, 64, 3), np.uint8))
    with Image.open(folder / "confusion.png") as picture:
        assert picture.format == "PNG"
    before = (folder / "objects.onnx").read_bytes()
    assert main([str(folder), "--quick", "--size", "64"]) == 0
    assert "epoch" not in capsys.readouterr().out  # both were there
    assert (folder / "objects.onnx").read_bytes() == before
    assert main([str(folder), "--quick", "--size", "64", "--seed", "1"]) == 2
    refused = "checkpoint.pt: is of a training that differs in seed, images, labels: choose another folder"
    assert refused in capsys.readouterr().err


@needs_torch
def test_photos_belong_to_the_training(tmp_path, capsys):
    (tmp_path / "photos").mkdir()
    Image.new("RGB", (80, 60), (90, 120, 60)).save(tmp_path / "photos/wall.png")
    arguments = ["--quick", "--size", "64", "--photos", str(tmp_path / "photos")]
    assert main([str(tmp_path / "net"), *arguments]) == 0
    assert "epoch 2 of 2" in capsys.readouterr().out
    Image.new("RGB", (80, 60), (120, 90, 60)).save(tmp_path / "photos/wall.png")
    assert main([str(tmp_path / "net"), *arguments]) == 2
    assert "differs in images: choose another folder" in capsys.readouterr().err
    assert main([str(tmp_path / "net"), *arguments, str(tmp_path / "nothing")]) == 2
    assert "nothing: there are no photos" in capsys.readouterr().err


@needs_torch
def test_photos_without_simulated_images_are_refused(tmp_path, capsys):
    write_yolo_folder(tmp_path / "data", write_photos(tmp_path / "photos", 4))
    arguments = ["--data", str(tmp_path / "data"), "--photos", str(tmp_path / "photos")]
    assert main([str(tmp_path / "net"), *arguments]) == 2
    assert "--images N" in capsys.readouterr().err


@needs_torch
def test_a_network_of_own_photos(tmp_path, capsys):
    write_yolo_folder(tmp_path / "data", write_photos(tmp_path / "photos", 20))
    arguments = [str(tmp_path / "net"), "--data", str(tmp_path / "data"), "--size", "64"]
    assert main([*arguments, "--epochs", "2"]) == 0
    output = capsys.readouterr().out
    assert "2 validation images" in output and "epoch 2 of 2" in output and "mAP50" in output
    assert YoloDetector(YoloParams(model=str(tmp_path / "net/objects.onnx"))).classes == ["ball", "goal"]
    more = [str(tmp_path / "more"), *arguments[1:], "--epochs", "1", "--images", "4"]
    assert main([*more, "--start", str(tmp_path / "net/objects.onnx")]) == 0
    assert main([str(tmp_path / "own"), *more[1:], "--start", "shipped"]) == 0
    capsys.readouterr()
    write_coco_file(tmp_path / "labels.json", write_photos(tmp_path / "photos", 12))
    assert (
        main([str(tmp_path / "coco"), "--data", str(tmp_path / "labels.json"), "--quick", "--size", "64"])
        == 0
    )
    assert "2 validation images" in capsys.readouterr().out  # every tenth


@needs_torch
def test_the_part_for_tests_is_not_used(tmp_path, capsys):
    write_yolo_folder(tmp_path / "data", write_photos(tmp_path / "photos", 30))
    data = tmp_path / "data/data.yaml"
    lines = data.read_text().replace("val:", "test:")
    data.write_text(lines)
    arguments = ["--data", str(data), "--quick", "--size", "64"]
    assert main([str(tmp_path / "net"), *arguments]) == 0
    assert "3 validation images" in capsys.readouterr().out  # every tenth of the 27 for training
    data.write_text(lines.replace("train:", "valid:"))
    assert main([str(tmp_path / "other"), *arguments]) == 2
    assert "data.yaml: has no part 'train', only valid, test" in capsys.readouterr().err


@needs_torch
@pytest.mark.parametrize(
    "arguments, reason",
    [
        (["--size", "100"], "--size is 100, must be a multiple of 32"),
        (["--epochs", "0"], "--epochs is 0, must be a whole number from 1 on"),
        (["--seed", "1000"], "--seed must be within"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_drawn(tmp_path, arguments, reason, capsys):
    assert main([str(tmp_path / "detector"), *arguments]) == 2
    assert reason in capsys.readouterr().err
    assert not (tmp_path / "detector").exists()


def test_without_pytorch_it_prints_what_to_install(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "torch", None)
    assert main([str(tmp_path / "detector")]) == 2
    assert "PyTorch is missing: apt install python3-torch" in capsys.readouterr().err
