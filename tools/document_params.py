# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Filter of doxygen: prints a header, each parameter with its description from `fields()`."""

import re
import sys
from pathlib import Path

STRUCT = re.compile(r"^struct (\w+) \{$.*?^\};$", re.M | re.S)
LINK = re.compile(r"\[([^]]*)\]\([^)]*\)")
FIELD = re.compile(r"^(  [\w:<>, ]+ (\w+)(?: = [^;]*|\{[^;]*)?;)$", re.M)


def documented(header: str) -> str:
    """The header with a `///<` after each field that has none and is a parameter."""
    if "ParamList fields()" not in header:
        return header
    import sextant  # takes a while

    bound = [getattr(sextant, name, None) for name in STRUCT.findall(header)]
    texts = {  # a struct that is a base or a member of another has its fields
        name: LINK.sub(r"\1", "; ".join(filter(None, [description, allowed])) + (f" {unit}" if unit else ""))
        for params in bound
        if hasattr(params, "fields")
        for name, _, allowed, unit, description in params.fields()
    }

    def with_descriptions(struct: "re.Match[str]") -> str:
        return FIELD.sub(
            lambda field: f"{field[1]}  ///< {texts[field[2]]}" if field[2] in texts else field[1],
            struct.group().replace(
                "ParamList fields();\n", "ParamList fields();  ///< names, ranges, units, descriptions\n"
            ),
        )

    return STRUCT.sub(with_descriptions, header)


if __name__ == "__main__":
    sys.stdout.write(documented(Path(sys.argv[1]).read_text()))
