"""The check data that a DAVE-ML file carries of itself: inputs, and the outputs that its author computed.

A model that does not come to them was damaged on its way, or is read here otherwise than its author meant it;
to fly it would be worse than to refuse it.

Source: ANSI/AIAA S-119-2011, ``checkData``; the tolerance is absolute.  Where none stands, one part in a
million of the value counts as equal, a choice of this software.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from edl6dof.config.document.locate import shown
from edl6dof.config.errors import ConfigError, Problem
from edl6dof.interchange.daveml_model import Model
from edl6dof.interchange.xmlfile import line_of, refused, text_of

if TYPE_CHECKING:
    from lxml.etree import _Element

#: Share of the value (of one, where it is smaller) that counts as equal where a file gives no tolerance.
_DEFAULT_TOLERANCE = 1e-6


def check_own_data(model: Model, check_data: _Element) -> None:
    """Evaluate each static shot of a file.

    Raises:
        ConfigError: with every output that is not within its tolerance, and every signal that is not a number
            or not of the model.
    """
    problems = [problem for shot in check_data.iterfind("{*}staticShot") for problem in _of_shot(model, shot)]
    if problems:
        raise ConfigError(problems)


def _of_shot(model: Model, shot: _Element) -> Iterator[Problem]:
    given = {
        identifier: value
        for signal in shot.iterfind("{*}checkInputs/{*}signal")
        for identifier, value in [_signal(model, signal)]
    }
    for signal in shot.iterfind("{*}checkOutputs/{*}signal"):
        identifier, wanted = _signal(model, signal)
        tolerance = _number(model, signal, "tol", _DEFAULT_TOLERANCE * max(1.0, abs(wanted)))
        found = model.evaluate(identifier, given)
        if not abs(found - wanted) <= tolerance:
            message = (
                f"check case {shot.get('name', '')!r} of the file itself is not met: {found:.9g}, "
                f"not {wanted:.9g} (tolerance {tolerance:.3g})"
            )
            yield Problem(shown(model.path), line_of(signal), 1, identifier, message)


def _signal(model: Model, signal: _Element) -> tuple[str, float]:
    """Variable and value of a signal, which is named by its variable or by the variable's name."""
    words = [text_of(part) for tag in ("varID", "signalName") for part in signal.iterfind(f"{{*}}{tag}")]
    name = words[0] if words else ""
    variable = model.named(name)
    if variable is None:
        raise refused(model.path, line_of(signal), f"check data of an unknown variable {name!r}")
    return variable.id, _number(model, signal, "signalValue", None)


def _number(model: Model, signal: _Element, tag: str, default: float | None) -> float:
    part = signal.find(f"{{*}}{tag}")
    if part is None and default is not None:
        return default
    try:
        return float("" if part is None else text_of(part))
    except ValueError:
        raise refused(model.path, line_of(signal), f"<signal> needs a number in <{tag}>") from None
