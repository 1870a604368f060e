"""Spreads: differences between people."""

from dataclasses import dataclass

from ..constants import CORRELATION, FROM_0, Both, constant
from .mechanism import Mechanism


@dataclass(frozen=True, kw_only=True)
class Spreads(Mechanism):
    """SDs (ln) of sensitivity and criterion between people, correlated over the channels."""

    equation = "threshold × e^(SD · z), z of cold and warm correlated"
    source = "QST norms (Magerl et al. 2010); no source of the criterion's"
    sensitivity_between: Both[float] = constant("{} sensitivity between people", FROM_0)
    criterion_between: float = constant("criterion between people", FROM_0)
    correlation: float = constant("correlation of cold and warm", CORRELATION)
