# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Connections between the markers of a map through images that show several of them, and their weak spots."""

from collections import Counter
from dataclasses import dataclass
from itertools import combinations
from typing import AbstractSet, Collection, Dict, FrozenSet, List, Sequence, Tuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

Key = Tuple[str, int]  # family, id
Pair = Tuple[Key, Key]  # in ascending order
Image = AbstractSet[Key]  # markers in one image, or in the images of several cameras at one instant

FEW_IMAGES = 10  # a connection through fewer images is weak
FEW_IMAGES_OF_A_PAIR = 30  # the same, if all images show the same two markers


@dataclass(frozen=True)
class Cut:
    """A minimum cut: the fewest images whose removal separates some markers from the rest."""

    markers: FrozenSet[Key]  # markers on one side
    images: int  # number of images in the cut
    links: Tuple[Pair, ...]  # pairs in those images: (one of markers, one of the rest), in ascending order

    @property
    def is_weak(self) -> bool:
        """Whether the connection has too few images."""
        return self.images < (FEW_IMAGES_OF_A_PAIR if len(self.links) == 1 else FEW_IMAGES)


def count_links(images: Sequence[Image]) -> Dict[Pair, int]:
    """Returns the number of images that show both markers, by pair; pairs without images are omitted."""
    return dict(Counter(pair for image in images for pair in combinations(sorted(image), 2)))


def components(images: Sequence[Image]) -> List[FrozenSet[Key]]:
    """Returns the connected components, sorted by their first marker."""
    found: List[set] = []
    for image in images:
        touched = [each for each in found if each & image]
        found = [each for each in found if not each & image] + [set(image).union(*touched)]
    return sorted((frozenset(each) for each in found if each), key=min)


def cuts(images: Sequence[Image], anchors: Collection[Key]) -> Dict[Key, Cut]:
    """Computes the minimum cut between each marker and the anchors.

    By the max-flow min-cut theorem, in a graph where only images limit the flow: an image of three markers
    counts once, although it shows three pairs. Of equal cuts, the one closest to the marker is returned.

    :param anchors: markers that define the map frame
    :returns: cuts by marker, anchors excluded; 0 images if the marker is not connected; empty if no image
        shows an anchor
    """
    network = _Network(images, anchors)
    if not network.anchors.intersection(network.keys):
        return {}
    return {key: network.cut(key) for key in network.keys if key not in network.anchors}


def weak_cuts(images: Sequence[Image], found: Collection[Cut]) -> List[Cut]:
    """Returns the distinct weak cuts of cuts(), described from the smaller side, the weakest first."""
    everything = frozenset().union(*images)
    weak = {_seen_from_smaller_side(cut, everything) for cut in found if cut.is_weak}
    return sorted(weak, key=lambda cut: (cut.images, sorted(cut.markers)))


def _seen_from_smaller_side(cut: Cut, everything: FrozenSet[Key]) -> Cut:
    rest = everything - cut.markers
    if not rest or len(cut.markers) <= len(rest):
        return cut
    return Cut(rest, cut.images, tuple(sorted((b, a) for a, b in cut.links)))


class _Network:
    """Flow network: a sink behind the anchors, a node per marker, an entry and an exit node per image set."""

    def __init__(self, images: Sequence[Image], anchors: Collection[Key]):
        self.keys = sorted(frozenset().union(*images))
        self.anchors = set(anchors)
        self._node = {key: 1 + i for i, key in enumerate(self.keys)}
        self._sets = Counter(frozenset(image) for image in images if len(image) > 1)
        self._without_limit = 1 + sum(self._sets.values())
        self._capacity = self._build()

    def _build(self) -> csr_matrix:
        edges = [(self._node[key], 0, self._without_limit) for key in self.keys if key in self.anchors]
        for i, (markers, count) in enumerate(self._sets.items()):
            entrance = 1 + len(self.keys) + 2 * i
            exit_node = entrance + 1
            edges.append((entrance, exit_node, count))
            edges += [(self._node[key], entrance, self._without_limit) for key in markers]
            edges += [(exit_node, self._node[key], self._without_limit) for key in markers]
        size = 1 + len(self.keys) + 2 * len(self._sets)
        rows, columns, values = np.array(edges, dtype=np.int32).reshape(-1, 3).T
        return csr_matrix((values, (rows, columns)), shape=(size, size), dtype=np.int32)

    def cut(self, key: Key) -> Cut:
        """Computes the minimum cut between a marker and the anchors."""
        found = maximum_flow(self._capacity, self._node[key], 0)
        flow = found.flow if hasattr(found, "flow") else found.residual  # its name until scipy 1.8
        rest = self._capacity - flow
        rest.eliminate_zeros()
        reached = set(breadth_first_order(rest, self._node[key], return_predecessors=False).tolist())
        markers = frozenset(each for each in self.keys if self._node[each] in reached)
        links = {(a, b) for image in self._sets for a in image & markers for b in image - markers}
        return Cut(markers, int(found.flow_value), tuple(sorted(links)))
