# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What several tests of the page for placing photos begin with."""

import pytest


@pytest.fixture
def folder(tmp_path):
    """Of photos, empty."""
    folder = tmp_path / "photos"
    folder.mkdir()
    return folder


@pytest.fixture
def served(folder):
    """The page of a map that is begun in the folder."""
    from served_page import Served  # only here: no other test needs a server

    from sextant.place_maps.map_draft import MapDraft

    served = Served(MapDraft(folder / "map.txt"))
    yield served
    served.close()
