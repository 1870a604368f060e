"""Front doors that load a room when one of its names is first asked for, so that a command loads what it needs."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def door(package: str, rooms: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package whose names, separated by spaces, are listed by their modules.

    >>> door("thermicon.icons", {"model.icon": "Icon"})("Icon").__name__
    'Icon'
    """
    places = {name: module for module, names in rooms.items() for name in names.split()}

    def loaded(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f"{package}.{places[name]}"), name)
        setattr(import_module(package), name, value)
        return value

    return loaded
