# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A file of parameters of the nodelet sextant/LandmarkSlam, as `rosparam load` takes it."""

from pathlib import Path
from typing import Any, Dict, Union

import yaml


def read_values(path: Union[str, Path]) -> Dict[str, Any]:
    """Parameters by name, for sextant.base.strict_params.parse_struct().

    :raises OSError: it cannot be read
    :raises ValueError: it is no YAML, or no table
    """
    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    values = {} if values is None else values
    if not isinstance(values, dict) or not all(isinstance(name, str) for name in values):
        raise ValueError(f"{path}: write `name: value`, a parameter a line")
    return values
