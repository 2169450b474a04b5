# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
import pytest

from sextant.nodes.base.registration_check import is_forgotten


@pytest.mark.parametrize(
    "publishers, expected",
    [
        (["/other"], False),  # nobody registers nodes again
        (["/other", "/registration_keeper"], True),
        (["/robot/registration_keeper_host_1_2"], True),
        (["/my_registration_keeper"], False),
        (["/registration_keeper", "/node"], False),
    ],
)
def test_a_node_is_forgotten_only_beside_a_keeper(publishers, expected):
    state = [[["/topic", publishers]], [], [["/service", ["/service_node"]]]]
    assert is_forgotten(state, "/node") is expected
    assert not is_forgotten(state, "/service_node")
