"""Checks of the valid part of refused data: all mistakes of a file are reported at once.

A refused value is replaced by :data:`REFUSED`.  A check that uses it ends with :class:`NotKnown` and finds
nothing, so no message follows from a value that is refused itself.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NoReturn, TypeVar

from pydantic import BaseModel, Field, ValidationError, create_model, model_validator

from edl6dof.config.errors import Inconsistent
from edl6dof.config.model_paths import Keys, Slot, field_slot, literal_names
from edl6dof.config.wording import meant_key

Subject = TypeVar("Subject")

#: Dotted path of a value, and its problem.
Found = tuple[str, str]


class NotKnown(Exception):
    """A value is used that was refused."""


class _Refused:
    """A value that was refused; every use of it raises :class:`NotKnown`."""

    def _use(self, *_: Any) -> NoReturn:
        raise NotKnown

    __getattr__ = __getitem__ = __call__ = __iter__ = __len__ = __contains__ = _use
    __eq__ = __ne__ = __lt__ = __le__ = __gt__ = __ge__ = __hash__ = __bool__ = _use
    __float__ = __int__ = __index__ = __format__ = __str__ = __neg__ = __abs__ = __round__ = _use
    __add__ = __sub__ = __mul__ = __truediv__ = __floordiv__ = __mod__ = __pow__ = __or__ = _use
    __radd__ = __rsub__ = __rmul__ = __rtruediv__ = __rfloordiv__ = __rmod__ = __rpow__ = __ror__ = _use


REFUSED: Any = _Refused()


def findings(checks: Iterable[Callable[[Subject], Iterable[Found]]], subject: Subject) -> dict[str, str]:
    """Problems that checks find in ``subject``: message by dotted path."""
    found: dict[str, str] = {}
    for check in checks:
        with judging(subject):
            for path, message in check(subject):
                found[path] = message
    return found


@contextmanager
def judging(subject: Any) -> Iterator[None]:
    """Run a check of ``subject``; one that fails on a refused value finds nothing.

    Not every use of such a value raises :class:`NotKnown`: ``", ".join`` raises a ``TypeError`` of its own.
    """
    try:
        yield
    except NotKnown:
        pass
    except Exception:
        if not _holds_refused(subject):
            raise


def _holds_refused(value: Any) -> bool:
    if isinstance(value, BaseModel):
        value = vars(value)
    inside = value.values() if isinstance(value, dict) else value if isinstance(value, list | tuple) else ()
    return value is REFUSED or any(map(_holds_refused, inside))


def partial_model(
    model: type[BaseModel], data: Mapping[str, Any], refused: Collection[Keys]
) -> tuple[Any, dict[Keys, str]]:
    """Make a model of data of which the values at ``refused`` are not valid.

    Returns:
        The model, with :data:`REFUSED` for these values, and the problems that its validators find in the
        other values, by path.
    """
    builder = _Builder(refused)
    return builder.model(model, data, ()), builder.problems


class _Builder:
    def __init__(self, refused: Collection[Keys]):
        self.refused = refused
        self.problems: dict[Keys, str] = {}

    def model(self, model: type[BaseModel], data: Mapping[str, Any], path: Keys) -> Any:
        """A model whose validators have judged what they could, or :data:`REFUSED`."""
        fields, depth = model.model_fields, len(path)
        wrong = {one[depth] for one in self.refused if len(one) > depth and one[:depth] == path}
        missed = {meant_key(str(key), fields) for key in wrong if key not in fields} - data.keys()
        open_fields = [name for name in fields if name in wrong | missed]
        sound = {name: value for name, value in data.items() if name in fields and name not in open_fields}
        try:
            values = dict(vars(_without(model, open_fields).model_validate(sound, strict=False)))
        except ValidationError:
            return REFUSED
        for name in open_fields:
            slot = field_slot(name, fields[name]) if name in data else None
            values[name] = self._value(slot, data.get(name), (*path, name))
        made = model.model_construct(**values)
        decorators = model.__pydantic_decorators__
        for validator in decorators.field_validators.values():
            for name in set(open_fields).intersection(validator.info.fields):
                judges = validator.info.mode == "after" and values[name] is not REFUSED
                if judges and not self._accepts(validator.func, values[name], (*path, name)):
                    vars(made)[name] = REFUSED
        judged = [self._accepts(getattr(model, name), made, path) for name in _after(model)]
        return made if all(judged) else REFUSED

    def _value(self, slot: Slot | None, value: Any, path: Keys) -> Any:
        if slot is None:
            return REFUSED
        if isinstance(value, dict) and slot.models:
            chosen = [model for model in slot.models if _may_be(model, value)]
            return self.model(chosen[0], value, path) if len(chosen) == 1 else REFUSED
        if path in self.refused:
            return REFUSED
        if isinstance(value, dict):
            return {key: self._value(slot.child(key), one, (*path, key)) for key, one in value.items()}
        if isinstance(value, list):
            return [self._value(slot.child(index), one, (*path, index)) for index, one in enumerate(value)]
        return value

    def _accepts(self, check: Callable[[Any], Any], value: Any, path: Keys) -> bool:
        """Note what a validator finds and refuse these values; return false if ``value`` is refused."""
        found: dict[Keys, str] = {}
        with judging(value):
            try:
                check(value)
            except Inconsistent as error:
                found = {steps(below): message for below, message in error.problems.items()}
            except ValueError as error:
                if isinstance(error, ValidationError) or isinstance(error.__cause__, NotKnown):
                    raise
                found = {(): " ".join(str(error).split())}
        for keys, message in found.items():
            self.problems.setdefault((*path, *keys), message)
            _refuse(value, keys)
        return () not in found


def steps(dotted_path: str) -> Keys:
    """Keys and list indices of a dotted path."""
    return tuple(int(part) if part.isdecimal() else part for part in dotted_path.split(".") if part)


def _may_be(model: type[BaseModel], value: Mapping[str, Any]) -> bool:
    """Return whether a mapping has the names by which a union chooses ``model``."""
    names = ((key, literal_names(field_slot(key, info))) for key, info in model.model_fields.items())
    return all(value[key] in allowed for key, allowed in names if allowed and key in value)


def _after(model: type[BaseModel]) -> list[str]:
    """Names of the validators that judge a whole model."""
    found = model.__pydantic_decorators__.model_validators
    return [name for name, validator in found.items() if validator.info.mode == "after"]


def _without(model: type[BaseModel], names: Iterable[str]) -> type[BaseModel]:
    """``model`` with any value for the fields ``names``, and without the validators of the whole."""
    idle: Any = {name: model_validator(mode="after")(lambda self: self) for name in _after(model)}
    loose: Any = {name: (Any, Field(None, validate_default=False)) for name in names}
    return create_model(model.__name__, __base__=model, __validators__=idle, **loose)


def _refuse(inside: Any, keys: Keys) -> None:
    """Put :data:`REFUSED` at ``keys``, or at the nearest value above them."""
    for depth, key in enumerate(keys, start=1):
        held: Any = vars(inside) if isinstance(inside, BaseModel) else inside
        known = key in held if isinstance(held, dict) else isinstance(key, int) and key < len(held)
        if not known:
            return
        inside = held[key]
        if depth == len(keys) or not isinstance(inside, dict | list | BaseModel):
            held[key] = REFUSED
            return
