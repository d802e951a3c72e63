"""Types of NumPy arrays, in Python and of the compiled engine."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.ArrayLike  # what is taken for one
Floats: TypeAlias = npt.NDArray[np.float32]
Doubles: TypeAlias = npt.NDArray[np.float64]
Whole: TypeAlias = npt.NDArray[np.uint32]
Pixels: TypeAlias = npt.NDArray[np.uint8]
Signed: TypeAlias = npt.NDArray[np.int32]
Three: TypeAlias = tuple[Doubles, Doubles, Doubles]
Transfer: TypeAlias = tuple[Whole, Floats] | None  # indices and weights; none on the coarsest level
