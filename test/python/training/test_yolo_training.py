# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Training on a few images."""

import numpy as np
import pytest
from made_labels import COLOURS, write_photos

torch = pytest.importorskip("torch", reason="PyTorch is optional: apt install python3-torch")

from sextant.training import yolo_training  # noqa: E402
from sextant.training.labelled_images import labelled_image_set  # noqa: E402
from sextant.training.network_score import network_score  # noqa: E402
from sextant.training.yolo_export import export  # noqa: E402
from sextant.training.yolo_network import YoloNetwork  # noqa: E402
from sextant.training.yolo_training import TrainingParams, mosaic, train  # noqa: E402


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    return labelled_image_set(write_photos(tmp_path_factory.mktemp("photos"), 8), 64, 1)


def test_a_mosaic_has_the_objects_of_four_images(pictures):
    found = mosaic(pictures, 5, np.random.default_rng(1))
    assert found.images.shape == (5, 64, 64, 3) and found.exists.sum() > 20
    for image, truth in zip(found.images, found.truths()):
        for box, each in zip(truth.boxes, truth.classes):
            x, y = (0.5 * (box[:2] + box[2:])).astype(int)
            assert np.abs(image[y, x].astype(int) - COLOURS[each]).max() < 40


@pytest.mark.slow
def test_training_learns_ends_early_and_keeps_the_best(pictures, tmp_path, capsys):
    params = TrainingParams(epochs=200, batch=2, patience=15, mosaic=0.2, average=0.9, seed=1)
    network = train(pictures, 2, params, tmp_path / "checkpoint.pt", "training", pictures)
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("epoch")]
    scores = [float(line.split("mAP50 ")[1].split(",")[0]) for line in lines]
    assert max(scores) > 0.3 and len(lines) < 200
    assert network_score(network, pictures, 2).mean == pytest.approx(max(scores), abs=1e-3)
    assert len(lines) == 1 + int(np.argmax(scores)) + 15


def test_without_validation_all_epochs_are_trained(pictures, tmp_path, capsys):
    params = TrainingParams(epochs=3, batch=8, patience=1)
    train(pictures, 2, params, tmp_path / "checkpoint.pt", "training")
    assert "epoch 3 of 3" in capsys.readouterr().out


def test_an_interrupted_training_goes_on_as_if_it_had_not_been(pictures, tmp_path, monkeypatch):
    params = TrainingParams(epochs=3, batch=4, mosaic=0.3)
    straight = train(pictures, 2, params, tmp_path / "straight.pt", validation=pictures)
    train_batch, left = yolo_training._State._train_batch, [3]  # two batches are an epoch

    def interrupted(*arguments):
        left[0] -= 1
        if left[0] < 0:
            raise KeyboardInterrupt
        return train_batch(*arguments)

    monkeypatch.setattr(yolo_training._State, "_train_batch", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train(pictures, 2, params, tmp_path / "halved.pt", validation=pictures)
    monkeypatch.setattr(yolo_training._State, "_train_batch", train_batch)
    resumed = train(pictures, 2, params, tmp_path / "halved.pt", validation=pictures)
    np.testing.assert_allclose(_weights(straight), _weights(resumed), atol=1e-5)


def test_corrected_labels_are_another_training(pictures, tmp_path):
    params, path = TrainingParams(epochs=1, batch=8), tmp_path / "checkpoint.pt"
    train(pictures, 2, params, path, validation=pictures)
    moved = pictures._replace(boxes=pictures.boxes + 1.0)
    with pytest.raises(ValueError, match="checkpoint.pt: is of a training that differs in labels:"):
        train(moved, 2, params, path, validation=pictures)
    with pytest.raises(ValueError, match="differs in validation labels:"):
        train(pictures, 2, params, path, validation=moved)
    with pytest.raises(ValueError, match="differs in validation images, validation labels:"):
        train(pictures, 2, params, path)


def test_mixed_precision_trains_alike(pictures, tmp_path, monkeypatch):
    found = []
    for is_fast in (False, True):
        monkeypatch.setattr(yolo_training, "has_fast_bfloat16", lambda is_fast=is_fast: is_fast)
        network = train(pictures, 2, TrainingParams(epochs=2, batch=4), tmp_path / f"{is_fast}.pt")
        found.append(_weights(network))
    torch.manual_seed(TrainingParams.seed)
    start = _weights(YoloNetwork(2))
    assert np.any(found[0] != found[1])
    assert np.corrcoef(found[0] - start, found[1] - start)[0, 1] > 0.5


def _weights(network):
    return torch.cat([each.detach().flatten() for each in network.parameters()]).numpy()


def test_a_training_starts_from_another_one(pictures, tmp_path):
    first = train(pictures, 2, TrainingParams(epochs=2, batch=8), tmp_path / "first.pt")
    params = TrainingParams(epochs=1, batch=8, rate=1e-9, decay=0.0)
    second = train(pictures, 2, params, tmp_path / "second.pt", start=tmp_path / "first.pt")
    for one, other in zip(first.parameters(), second.parameters()):
        np.testing.assert_allclose(one.numpy(), other.numpy(), atol=1e-4)
    export(first, tmp_path / "first.onnx", 64, ["one", "other"])
    third = train(pictures, 2, params, tmp_path / "third.pt", start=tmp_path / "first.onnx")
    np.testing.assert_allclose(_weights(first), _weights(third), atol=1e-4)
    three = train(pictures, 3, params, tmp_path / "three.pt", start=tmp_path / "first.pt")
    stem = [next(each.parameters()).numpy() for each in (first, three)]
    np.testing.assert_allclose(*stem, atol=1e-4)
    with pytest.raises(ValueError, match="first.pt: is not of a network of this size"):
        train(pictures, 2, TrainingParams(network="large"), tmp_path / "l.pt", start=tmp_path / "first.pt")
    narrow = torch.load(tmp_path / "first.pt", weights_only=True)
    narrow["kept"] = {name: each[:1] if each.ndim > 3 else each for name, each in narrow["kept"].items()}
    torch.save(narrow, tmp_path / "narrow.pt")
    with pytest.raises(ValueError, match="narrow.pt: is not of a network of this size"):
        train(pictures, 2, params, tmp_path / "fifth.pt", start=tmp_path / "narrow.pt")
    torch.save({"weights": torch.zeros(3)}, tmp_path / "other.pt")
    with pytest.raises(ValueError, match="other.pt: is not of a network of this size"):
        train(pictures, 2, params, tmp_path / "fourth.pt", start=tmp_path / "other.pt")
