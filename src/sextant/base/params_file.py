# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Parameter files in the format of `rosparam load`."""

from pathlib import Path
from typing import Any, Dict, Union

import yaml


def read_params_file(path: Union[str, Path]) -> Dict[str, Any]:
    """Reads parameters by name, for sextant.base.strict_params.parse_struct().

    :raises OSError: the file cannot be read
    :raises ValueError: the file is not YAML, or not a mapping from names to values
    """
    try:
        values = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    values = {} if values is None else values
    if not isinstance(values, dict) or not all(isinstance(name, str) for name in values):
        raise ValueError(f"{path}: write `name: value`, one parameter per line")
    return values
