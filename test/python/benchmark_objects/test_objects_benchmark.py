# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of object detection in a quick run: what needs no PyTorch, data or minutes."""

import onnx.utils
import pytest
from quick_run import tables_of

from sextant.objects.shipped_model import shipped_model

pytestmark = pytest.mark.skipif(not hasattr(onnx.utils, "extract_model"), reason="onnx is older than 1.8")


@pytest.mark.slow
def test_the_network_is_measured(tmp_path):
    usual, hard, facts, runtimes = tables_of("objects.py", "network", tmp_path)
    assert [len(table["rows"]) for table in (usual, hard)] == [5, 5]
    (row,) = facts["rows"]
    assert row["MB"]["value"] == pytest.approx(shipped_model().stat().st_size / 1e6)
    assert 0.05 < row["GFLOP a frame"]["value"] <= 0.5
    opencv = next(row for row in runtimes["rows"] if row["name"] == "opencv")
    assert 0.1 < opencv["ms a frame"]["value"] < 1000.0
    for name in ("usual.png", "hard.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
