# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
from sextant.mapping.map_links import Cut, components, count_links, cuts, weak_cuts

A, B, C, D, E = (("tag36h11", id) for id in range(5))


def images(**counts):
    """E.g. AB=3: three images that show A and B."""
    return [{globals()[name] for name in shown} for shown, count in counts.items() for _ in range(count)]


def test_links_count_the_images_of_each_pair():
    assert count_links(images(AB=2, ABC=1, C=5)) == {(A, B): 3, (A, C): 1, (B, C): 1}
    assert count_links([]) == {}


def test_components_are_what_images_connect():
    assert components(images(AB=1, CD=1, E=1)) == [{A, B}, {C, D}, {E}]
    assert components(images(AB=1, CD=1, BC=1)) == [{A, B, C, D}]
    assert components([set()]) == []


def test_a_chain_is_as_strong_as_its_weakest_link():
    found = cuts(images(AB=50, BC=4, CD=60), [A])
    assert found == {
        B: Cut(frozenset([B, C, D]), 50, ((B, A),)),
        C: Cut(frozenset([C, D]), 4, ((C, B),)),
        D: Cut(frozenset([C, D]), 4, ((C, B),)),
    }


def test_ways_add_up_and_an_image_counts_once():
    assert cuts(images(AB=30, AC=6, BC=7), [A])[C] == Cut(frozenset([C]), 13, ((C, A), (C, B)))
    assert cuts(images(AB=30, ABC=6), [A])[C].images == 6
    assert cuts(images(ABC=6, CD=9, BD=9), [A])[D].images == 6


def test_several_hold_the_frame():
    assert cuts(images(AC=3, BC=4), [A, B])[C].images == 7


def test_without_a_connection():
    assert cuts(images(AB=3, CD=5), [A])[C] == Cut(frozenset([C, D]), 0, ())
    assert cuts(images(AB=3), [E]) == {} == cuts([], [A])


def test_few_images_are_weak_and_of_one_pair_more_are():
    pair, several = ((A, B),), ((A, B), (A, C))
    assert [Cut(frozenset([A]), n, pair).is_weak for n in (9, 10, 29, 30)] == [True, True, True, False]
    assert [Cut(frozenset([A]), n, several).is_weak for n in (0, 9, 10)] == [True, True, False]


def test_weak_cuts_are_reported_once_and_by_their_smaller_side():
    shown = images(AB=5, BC=60, CD=60, DE=3)
    found = weak_cuts(shown, list(cuts(shown, [A]).values()))
    assert found == [Cut(frozenset([E]), 3, ((E, D),)), Cut(frozenset([A]), 5, ((A, B),))]
