"""A motor that is built in, by parts.motor or parts.can, beside motor.model: a hand does not turn it, and a model fits its frame."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from camgen.errors import Fault
from camgen.machines.loads.tables import Drives
from camgen.parts.catalogue import MOTOR_FACES
from camgen.parts.generator.sizes import Parts
from camgen.parts.motors import HAND_CRANK, STEPPERS, models_of
from camgen.schemas import one_of
from camgen.vocabulary import Wording


def without_hand(words: Wording) -> Wording:
    """The tables with no hand crank beside a motor that is built in.

    Its frame's one model stands in its place; where a frame has several, or none, what the motor gives stays unknown.
    """
    motor = words.data.get("motor")
    parts = words.data.get("parts")
    if not (isinstance(motor, dict) and isinstance(parts, dict)):
        return words
    if "motor" not in parts and "can" not in parts:
        return words
    frame = str(parts.get("motor", "")).lower()
    fitted = f'parts.motor = "{frame}"' if frame in MOTOR_FACES else ""
    fitted = fitted or ("parts.can" if isinstance(parts.get("can"), dict) else "")
    if not fitted or str(motor.get("model", "")).lower() != HAND_CRANK:
        return words
    left = {key: value for key, value in motor.items() if key != "model"}
    models = models_of(frame)
    if len(models) == 1:
        left["model"] = models[0]
        note = f'is read as "{models[0]}", the motor of {fitted}'
    else:
        known = one_of(models) if models else "one of the catalogue"
        note = (
            f"is not read: {fitted} drives the machine, no hand. What it gives is not known until you set motor.model, "
            f"{known}, or motor.torque_n_m"
        )
    data = {**words.data, "motor": left}
    return replace(words, data=data, notes=(*words.notes, f'motor.model = "{HAND_CRANK}" {note}'))


def model_faults(motor: Drives | None, sizes: Parts) -> Iterator[Fault]:
    """A model of another frame than that of the motor that is built in."""
    model = None if motor is None else motor.model
    if model in (None, HAND_CRANK) or sizes.motor not in MOTOR_FACES:
        return
    row = STEPPERS.get(str(model))
    if row is not None and row.frame == sizes.motor:
        return
    models = models_of(sizes.motor)
    known = f"{one_of(models)}, " if models else "no value and motor.torque_n_m, "
    other = f', or parts.motor = "{row.frame}"' if row is not None else ""
    right = f'{known}for the motor of parts.motor = "{sizes.motor}"{other}'
    yield Fault(("motor", "model"), repr(model), right)
