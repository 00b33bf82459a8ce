"""The one declaration of a parameter: a pydantic field with unit suffix, bounds, meaning and status.

From it follow the YAML check, the JSON schema, the reference table (``edl6dof params``), the record field
that compiled code reads (:mod:`edl6dof.config.dtype`) and the dotted path used by ``--set``.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Mapping
from dataclasses import dataclass
from math import inf, sqrt
from typing import Annotated, Any, ClassVar, Literal, Self, TypeVar

from annotated_types import MaxLen
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator
from pydantic.config import JsonDict
from pydantic.fields import FieldInfo

from edl6dof.config.errors import Inconsistent
from edl6dof.config.units import split_unit

#: published: printed by a named source; derived: calculated from published data; recalled: quoted in the
#: literature, not re-read; estimate: engineering estimate, free to change; calibrated:
#: found by ``edl6dof calibrate`` from published figures; design: a choice of this software
#: (gain, rate, switch), no claim on hardware.
Status = Literal["published", "derived", "recalled", "estimate", "calibrated", "design"]

#: Marks of numbers in YAML comments.
STATUS_MARKS: dict[str, Status] = {
    "P": "published",
    "D": "derived",
    "R": "recalled",
    "E": "estimate",
    "C": "calibrated",
    "S": "design",
}

REQUIRED: Any = ...

Vec3 = tuple[float, float, float]

Value = TypeVar("Value")

_KEY = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,39}")
_LONGEST_TITLE = 200


def _key(value: str) -> str:
    if not _KEY.fullmatch(value):
        raise ValueError(f"must be at most 40 letters, digits and _, the first a letter (got {value[:60]!r})")
    return value


def _title(value: str) -> str:
    if not value.isprintable() or not 0 < len(value.strip()) <= _LONGEST_TITLE:
        raise ValueError(
            f"must be one line of at most {_LONGEST_TITLE} printable characters (got {value[:60]!r})"
        )
    return value


#: A name that dotted paths, columns and variables of other programs are made of.
Key = Annotated[str, AfterValidator(_key)]
#: A name that is only shown: in headings and in the headers of files.
Title = Annotated[str, AfterValidator(_title)]


@dataclass(frozen=True)
class Within:
    """Annotation of a field: largest magnitude of its numbers where the field itself has no bound."""

    largest: float

    def __get_pydantic_core_schema__(self, source: Any, handler: Callable[[Any], Any]) -> Any:
        """Give pydantic the bound, so that larger numbers are reported with file and line."""
        return self._narrowed(handler(source))

    def _narrowed(self, schema: Any) -> Any:
        if schema["type"] in ("float", "int"):
            return {**self.bounds(schema["type"] == "int", schema), **schema}
        inner = {
            key: self._narrowed(schema[key])
            for key in ("schema", "items_schema")
            if isinstance(schema.get(key), dict)
        }
        if isinstance(items := schema.get("items_schema"), list):
            inner["items_schema"] = [self._narrowed(item) for item in items]
        return {**schema, **inner} if schema["type"] in ("nullable", "default", "list", "tuple") else schema

    def bounds(self, whole: bool, own: Container[str]) -> dict[str, float]:
        """Bounds by pydantic name on the sides without bounds in ``own``; whole numbers must fit 64 bits."""
        largest = int(min(self.largest, 2**63 - 1)) if whole else self.largest
        sides = {"ge": (("ge", "gt"), -largest), "le": (("le", "lt"), largest)}
        return {
            name: value
            for name, (same, value) in sides.items()
            if abs(value) < inf and not any(key in own for key in same)
        }


_PLAIN = (str, int, float)


class Params(BaseModel):
    """Base of every parameter model: unknown keys, wrong types, infinite and absurd numbers are errors."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False, validate_default=True
    )

    #: Largest magnitude by printed unit, where numbers of this model are smaller than the unit allows.
    largest: ClassVar[Mapping[str, float]] = {}

    def __hash__(self) -> int:
        """Hash the model's own numbers and texts only, which is quick; equality compares the rest.

        A model can then be the key of a cache of results computed from it; lists of a model are never
        changed.
        """
        return hash((type(self), *(value for value in vars(self).values() if isinstance(value, _PLAIN))))

    @classmethod
    def decided_by(cls, key: str) -> Iterable[str]:
        """Keys whose values follow from the choice ``key``, unless they are given."""
        return ()

    def __init_subclass__(cls, **options: Any) -> None:
        """Bound every number."""
        super().__init_subclass__(**options)
        for name, info in vars(cls).items():
            if isinstance(info, FieldInfo):
                unit = split_unit(name)[1]
                info.metadata.append(Within(cls.largest.get(unit.label, unit.largest)))


class Hardware(Params):
    """Base of the parameters of a vehicle and its parts, none of which is larger than a ship."""

    largest = {"m": 200.0, "m2": 50e3}


#: Annotation of a list field: slots of its record array; a longer list is a validation error.
Capacity = MaxLen


def param(
    default: Any,
    meaning: str,
    *,
    status: Status = "design",
    source: str = "",
    record: bool = True,
    factory: Callable[[], Any] | None = None,
    printed: float | None = None,
    usual: tuple[float, float, str] | None = None,
    **bounds: Any,
) -> Any:
    """Declare one parameter.

    Args:
        default: default value in the unit of the name's suffix, or ``REQUIRED``.
        meaning: one line for the reference table.
        status: origin of the default value, such as ``published`` or ``estimate``.
        source: report, paper or rule behind the default value.
        record: whether compiled code needs it (``False`` for names, files and Python-side switches).
        factory: makes the default instead of ``default`` (for lists and sub-models).
        printed: the number in ``source``, if the default is another one (:class:`PrintedParams`).
        usual: smallest and largest usual value, and the reason.
        **bounds: ``gt``, ``ge``, ``lt``, ``le``, ``min_length``, ``max_length`` as in pydantic.
    """
    extra: JsonDict = {"status": status, "source": source, "record": record}
    if printed is not None:
        extra["printed"] = printed
    if usual is not None:
        extra["usual"] = list(usual)
    first = {"default": default} if factory is None else {"default_factory": factory}
    return Field(**first, description=meaning, json_schema_extra=extra, **bounds)


def group(model: type[Params], meaning: str, *, record: bool = True) -> Any:
    """Declare a sub-model that may be left out of the file when every one of its parameters has a default."""
    return Field(default_factory=model, description=meaning, json_schema_extra={"record": record})


def section(meaning: str, *, record: bool = True) -> Any:
    """Declare a sub-model that the file must contain."""
    return Field(..., description=meaning, json_schema_extra={"record": record})


def extra_of(info: FieldInfo) -> JsonDict:
    """Arguments of :func:`param` that pydantic does not know: ``status``, ``source``, ``record``, ..."""
    extra = info.json_schema_extra
    return extra if isinstance(extra, dict) else {}


def unit_vector(value: Vec3) -> Vec3:
    """Scale a direction to unit length; a direction of unit length, to rounding, is returned unchanged.

    Raises:
        ValueError: the length is not one within 1e-3.
    """
    length = sqrt(value[0] * value[0] + value[1] * value[1] + value[2] * value[2])
    if abs(length - 1.0) > 1e-3:
        raise ValueError(f"must be a unit vector, its length is {length:.4f}")
    if abs(length - 1.0) < 1e-15:
        return value
    return (value[0] / length, value[1] / length, value[2] / length)


def unique_names(items: list[Any]) -> list[Any]:
    """Return a list of items if all names in it differ.

    Raises:
        ValueError: a name is given twice.
    """
    names = [item.name for item in items]
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"names must be unique; given twice: {', '.join(twice)}")
    return items


def stated(value: Value | None) -> Value:
    """Return a value of an optional field that an earlier check requires.

    Raises:
        ValueError: the value is missing.
    """
    if value is None:
        raise ValueError("a value is missing that a check before should have asked for")
    return value


class PrintedParams(Params):
    """Parameters of a law in two named sets: as its paper prints them, and as they are flown here.

    A field declares both: its default is flown, ``printed`` is the number of the paper; a default of status
    published is both.  With ``settings: as_printed`` every such field has the number of the paper and any
    other number is refused, so that no detuned law has the name of the paper.
    """

    settings: Literal["flown", "as_printed"] = param(
        "flown",
        "flown: the defaults of this software; as_printed: the numbers of the paper",
        record=False,
    )

    @model_validator(mode="before")
    @classmethod
    def _take_printed(cls, given: Any) -> Any:
        """Give every field its printed number if the file gives none."""
        if isinstance(given, dict) and given.get("settings") == "as_printed":
            return {**cls.printed(), **given}
        return given

    @model_validator(mode="after")
    def _named_truly(self) -> Self:
        if self.settings == "as_printed" and (wrong := self._other_than_printed()):
            raise Inconsistent(wrong)
        return self

    @classmethod
    def decided_by(cls, key: str) -> Iterable[str]:
        """Fields with a printed number, if ``key`` is ``settings``, which chooses their numbers."""
        return cls.printed() if key == "settings" else ()

    @classmethod
    def printed(cls) -> dict[str, Any]:
        """Numbers of the paper by field name."""
        found = {}
        for name, info in cls.model_fields.items():
            extra = extra_of(info)
            if "printed" in extra:
                found[name] = extra["printed"]
            elif extra.get("status") == "published":
                found[name] = info.default
        return found

    def _other_than_printed(self) -> dict[str, str]:
        return {
            name: f"is {value:g} with settings: as_printed (got {own:g}): leave it out, or say flown"
            for name, value in self.printed().items()
            if (own := getattr(self, name)) != value
        }
