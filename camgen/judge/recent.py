"""Functions of angles that keep what was asked last: where a cam turns evenly, all steps of Newton's method ask for the same angles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from camgen.geometry.rings import Floats

_KNOWN = 8  # answers that are kept

Answer = TypeVar("Answer")


class Recent(Generic[Answer]):
    """A function of angles, of any shape, with its last answers."""

    def __init__(self, function: Callable[[Floats], Answer]) -> None:
        self._function = function
        self._answers: dict[tuple[tuple[int, ...], bytes], Answer] = {}

    def __call__(self, theta: ArrayLike) -> Answer:
        """What the function gives; the same object for the same angles."""
        angles = np.asarray(theta, float)
        key = angles.shape, angles.tobytes()
        if key not in self._answers:
            if len(self._answers) >= _KNOWN:
                del self._answers[next(iter(self._answers))]
            self._answers[key] = self._function(angles)
        return self._answers[key]
