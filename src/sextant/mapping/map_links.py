# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Which markers of a map were seen together, and what little holds some of them to the rest."""

from collections import Counter
from dataclasses import dataclass
from itertools import combinations
from typing import AbstractSet, Collection, Dict, FrozenSet, List, Sequence, Tuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, maximum_flow

Key = Tuple[str, int]  # family, id
Pair = Tuple[Key, Key]  # in ascending order
Image = AbstractSet[Key]  # the markers that one image shows; of several cameras, those of one instant

FEW_IMAGES = 10  # below which a connection is weak
FEW_IMAGES_OF_A_PAIR = 30  # and below which it is if all of them show the same two markers


@dataclass(frozen=True)
class Cut:
    """The fewest images without which some markers have no connection with the rest."""

    markers: FrozenSet[Key]  # those on one side
    images: int
    links: Tuple[Pair, ...]  # seen in those images: (one of markers, one of the rest), in ascending order

    @property
    def is_weak(self) -> bool:
        return self.images < (FEW_IMAGES_OF_A_PAIR if len(self.links) == 1 else FEW_IMAGES)


def count_links(images: Sequence[Image]) -> Dict[Pair, int]:
    """In how many images each pair of markers is; pairs that are in none are left out."""
    return dict(Counter(pair for image in images for pair in combinations(sorted(image), 2)))


def components(images: Sequence[Image]) -> List[FrozenSet[Key]]:
    """Markers that images connect, in ascending order of their first."""
    found: List[set] = []
    for image in images:
        touched = [each for each in found if each & image]
        found = [each for each in found if not each & image] + [set(image).union(*touched)]
    return sorted((frozenset(each) for each in found if each), key=min)


def cuts(images: Sequence[Image], holders: Collection[Key]) -> Dict[Key, Cut]:
    """For each marker but the holders: the cut that takes the fewest images to part it from them.

    A maximum flow (max-flow min-cut theorem) through a graph whose only limits are the images: one that shows
    three markers counts once, though it makes three pairs. Of equal cuts it is the one nearest to the marker.

    :param holders: markers that hold the frame
    :returns: 0 images for a marker that none connects with a holder; nothing if no image shows a holder
    """
    network = _Network(images, holders)
    if not network.holders.intersection(network.keys):
        return {}
    return {key: network.cut(key) for key in network.keys if key not in network.holders}


def weak_cuts(images: Sequence[Image], found: Collection[Cut]) -> List[Cut]:
    """The weak ones of cuts(), each once and told of its smaller side, the weakest first."""
    everything = frozenset().union(*images)
    weak = {_seen_from_smaller_side(cut, everything) for cut in found if cut.is_weak}
    return sorted(weak, key=lambda cut: (cut.images, sorted(cut.markers)))


def _seen_from_smaller_side(cut: Cut, everything: FrozenSet[Key]) -> Cut:
    rest = everything - cut.markers
    if not rest or len(cut.markers) <= len(rest):
        return cut
    return Cut(rest, cut.images, tuple(sorted((b, a) for a, b in cut.links)))


class _Network:
    """Flow network: a root behind the holders, the markers, and an entrance and an exit a set of markers."""

    def __init__(self, images: Sequence[Image], holders: Collection[Key]):
        self.keys = sorted(frozenset().union(*images))
        self.holders = set(holders)
        self._node = {key: 1 + i for i, key in enumerate(self.keys)}
        self._sets = Counter(frozenset(image) for image in images if len(image) > 1)
        self._without_limit = 1 + sum(self._sets.values())
        self._capacity = self._build()

    def _build(self) -> csr_matrix:
        edges = [(self._node[key], 0, self._without_limit) for key in self.keys if key in self.holders]
        for i, (markers, count) in enumerate(self._sets.items()):
            entrance, leave = self._gates(i)
            edges.append((entrance, leave, count))
            edges += [(self._node[key], entrance, self._without_limit) for key in markers]
            edges += [(leave, self._node[key], self._without_limit) for key in markers]
        size = 1 + len(self.keys) + 2 * len(self._sets)
        rows, columns, values = np.array(edges, dtype=np.int32).reshape(-1, 3).T
        return csr_matrix((values, (rows, columns)), shape=(size, size), dtype=np.int32)

    def _gates(self, i: int) -> Tuple[int, int]:
        entrance = 1 + len(self.keys) + 2 * i
        return entrance, entrance + 1

    def cut(self, key: Key) -> Cut:
        found = maximum_flow(self._capacity, self._node[key], 0)
        rest = self._capacity - found.flow
        rest.eliminate_zeros()
        reached = set(breadth_first_order(rest, self._node[key], return_predecessors=False).tolist())
        markers = frozenset(each for each in self.keys if self._node[each] in reached)
        links = {(a, b) for image in self._sets for a in image & markers for b in image - markers}
        return Cut(markers, int(found.flow_value), tuple(sorted(links)))
