# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Evaluating networks of known answers."""

import re

import pytest
from made_labels import NAMES, write_photos
from made_yolo import ExportedHeads

from sextant.commands.evaluate_objects import main
from sextant.labels.yolo_folder import write_yolo_folder


@pytest.fixture()
def files(tmp_path):
    """A network that finds a ball of 16 × 16 pixels in each cell, and photos of 64 × 64 pixels."""
    write_yolo_folder(tmp_path / "data", write_photos(tmp_path / "photos", 3, (64, 64), seed=2))
    heads = ExportedHeads(NAMES, [1.0] * 4, [2.0, -9.0])
    return heads.write(tmp_path / "net.onnx", taken=("n", 3, "h", "w")), tmp_path / "data"


def test_figures_page_and_plots(tmp_path, files, capsys):
    model, data = files
    arguments = [model, "--data", str(data), "--sizes", "64", "96", "-o", str(tmp_path / "out")]
    assert main([*arguments, "--table", str(tmp_path / "figures.csv")]) == 0
    out = capsys.readouterr().out
    rows = re.findall(r"^net (64|96) +(\d+×\d+)", out, re.M)
    assert rows == [("64", "64×64"), ("96", "96×96")]
    page = (tmp_path / "out/evaluation.html").read_text()
    assert page.count("data:image/png") == 5 and page.count("data:image/jpeg") == 3
    names = {"confidence.png", "reliability.png", "groups.png", "confusion_1.png", "confusion_2.png"}
    assert {path.name for path in (tmp_path / "out").glob("*.png")} == names
    assert (tmp_path / "figures.csv").read_text().startswith("network,input,mAP50")


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--data", "nowhere"], "nowhere"),
        (["--data", "data", "--part", "test"], "has no part test"),
        (["--data", "data", "--false-alarms", "-1"], "--false-alarms is -1"),
        (["--data", "data", "--sizes", "-1"], "size"),
        (["--data", "data", "--confidence", "2"], "confidence"),
        (["--data", "data"], "has objects of goal; the classes are ball, blue_pillar"),
    ],
)
def test_wrong_options_are_refused(tmp_path, files, monkeypatch, capsys, options, reason):
    """The network that comes with Sextant has other classes."""
    monkeypatch.chdir(tmp_path)
    assert main(options) == 2
    assert reason in capsys.readouterr().err
