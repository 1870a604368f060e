"""The name of the type of arrays."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
