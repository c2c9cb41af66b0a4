"""Keyword arguments as words of a command line, so that the programs' own parser reads them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Union

Scalar = Union[str, int, float, bool, "os.PathLike[str]", None]
Option = Union[Scalar, Iterable[Scalar]]


def words(options: Mapping[str, Option]) -> list[str]:
    """undecided="keep" becomes --undecided=keep, certify=True --certify; None and False leave an option out.

    A sequence gives an option several times. An underscore at the end avoids Python's own words: from_="g2o".
    """
    found: list[str] = []
    for name, value in options.items():
        option = "--" + name.rstrip("_").replace("_", "-")
        several = isinstance(value, Iterable) and not isinstance(value, (str, bytes))
        for item in value if several else [value]:  # type: ignore[union-attr]
            if item is None or item is False:
                continue
            if item is True:
                found.append(option)
            else:
                found.append(f"{option}={os.fspath(item) if isinstance(item, os.PathLike) else item}")
    return found
