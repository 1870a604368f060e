"""A layout: display elements at their places on the body."""

from __future__ import annotations

from dataclasses import dataclass

from thermicon.base.words.clean_text import name_fault

from .rig import AnyRig, Rig
from .rigfile import RigError


@dataclass(frozen=True, slots=True)
class Element:
    """One display element.

    Parameters
    ----------
    rig
        What it is made of, and the skin under it.
    name
        By which icon sets address it; empty where it is the only one.

    Raises
    ------
    RigError
        For a name that no element of a set can have.

    Examples
    --------
    >>> Element(Rig.load("thenar"), "left")
    Element(rig=Rig('thenar', ...), name='left')
    """

    rig: Rig
    name: str = ""

    def __post_init__(self) -> None:
        if self.name and (wrong := name_fault(self.name)):
            raise RigError(f"element: {wrong}")


@dataclass(frozen=True, slots=True)
class Layout:
    """Several display elements; a layout of one element is its rig.

    Parameters
    ----------
    elements
        The elements in their order.

    Raises
    ------
    RigError
        Without elements, and where one of several has no name, or the name of another.

    Examples
    --------
    >>> rig = Rig.load("thenar")
    >>> Layout((Element(rig),)).alone is rig
    True
    """

    elements: tuple[Element, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "elements", tuple(self.elements))
        names = [element.name for element in self.elements]
        if not names:
            raise RigError("a layout needs at least one element")
        if len(names) > 1 and "" in names:
            raise RigError("of several elements each needs a name; give all of them one")
        if again := next((name for place, name in enumerate(names) if name in names[:place]), None):
            raise RigError(f"two elements are called {again}; give each a name of its own")

    @staticmethod
    def of(rig: AnyLayout, site: str | None = None) -> Layout:
        """A layout as it is, or one with a single element, whose rig is that of `Rig.of`.

        >>> Layout.of("thenar").alone.name
        'thenar'
        """
        return rig if isinstance(rig, Layout) else Layout((Element(Rig.of(rig, site)),))

    @property
    def alone(self) -> Rig:
        """The rig of the only element; raises RigError, with a cure, where there are several."""
        if len(self.elements) > 1:
            names = ", ".join(element.name for element in self.elements)
            raise RigError(f"a layout of several elements ({names}) cannot be taken yet; give the rig of one element")
        return self.elements[0].rig


AnyLayout = Layout | AnyRig
"""What is taken where a layout is needed: the layout, or what is taken where a rig is."""
