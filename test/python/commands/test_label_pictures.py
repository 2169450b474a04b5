# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Converting and proposing labels."""

import json

import numpy as np
import pytest
from made_labels import NAMES, assert_same_labels, write_photos
from made_yolo import ExportedHeads

from sextant.commands.label_pictures import main
from sextant.labels.label_formats import read_labels
from sextant.labels.yolo_folder import write_yolo_folder


@pytest.fixture()
def dataset(tmp_path):
    """A YOLO folder, and its labels."""
    write_yolo_folder(tmp_path / "data", write_photos(tmp_path / "photos", 5))
    return tmp_path / "data", read_labels(tmp_path / "data")


def test_from_format_to_format_and_back(tmp_path, dataset, capsys):
    folder, photos = dataset
    steps = [("coco", "a.json"), ("label-studio", "b.json"), ("yolo", "again")]
    source = folder
    for name, target in steps:
        assert main([str(source), "-o", str(tmp_path / target), "--to", name, "--classes", *NAMES]) == 0
        source = tmp_path / target
    assert_same_labels(read_labels(source), photos, tolerance=0.02)
    counts = photos.counts()
    line = f"{tmp_path}/again: 5 pictures, {counts[0]} ball, {counts[1]} goal"
    assert capsys.readouterr().out.splitlines()[-1] == line


def test_a_page(tmp_path, dataset):
    assert main([str(dataset[0]), "-o", str(tmp_path / "sheet.html"), "--to", "sheet"]) == 0
    assert "5 photos, 10 objects" in (tmp_path / "sheet.html").read_text()


def test_a_network_proposes_labels(tmp_path):
    """Of 96 × 96 pixels, with one confident prediction per cell: one box remains where they overlap."""
    write_photos(tmp_path / "photos", 2, (96, 96))
    heads = ExportedHeads(NAMES, [0.4, 0.4, 0.4, 0.4], [2.0, -2.0])
    model = heads.write(tmp_path / "net.onnx", taken=(1, 3, 96, 96))
    target = tmp_path / "tasks.json"
    arguments = [str(tmp_path / "photos"), "-o", str(target), "--model", model]
    assert main([*arguments, "--to", "label-studio"]) == 0
    tasks = json.loads(target.read_text())
    assert [len(task["predictions"][0]["result"]) for task in tasks] == [100, 100]
    result = tasks[0]["predictions"][0]["result"][0]
    assert result["value"]["rectanglelabels"] == ["ball"]
    assert result["score"] == pytest.approx(1 / (1 + np.exp(-2)), abs=1e-4)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["nowhere", "-o", "a.json", "--to", "coco"], "nowhere"),
        (["data", "-o", "a.json", "--to", "coco", "--classes", "ball"], "has objects of goal"),
        (["data", "-o", "photos", "--to", "yolo"], "photos: is not empty; --force adds to it"),
        (["data", "-o", "there.json", "--to", "coco"], "there.json"),
        (["data", "-o", "a.json", "--to", "coco", "--part", "test"], "has no part test"),
        (["data", "-o", "a.json", "--to", "coco", "--model", "no.onnx"], "no.onnx"),
        (["empty", "-o", "a.json", "--to", "coco", "--model", "no.onnx"], "there are no pictures in it"),
    ],
)
def test_wrong_options_are_refused(tmp_path, dataset, monkeypatch, capsys, options, reason):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.json").write_text("[]")
    (tmp_path / "empty").mkdir()
    assert main(options) == 2
    assert reason in capsys.readouterr().err
    assert not (tmp_path / "a.json").exists()
