"""Which files on disk the cases of a plan read: tables, and the vehicles and planets that a sweep exchanges.

Vehicle, planet and scenario files that do not change from case to case are written out in the plan itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from edl6dof.campaign.design.plan import Plan
from edl6dof.config.document.locate import PACKAGE, find_include
from edl6dof.config.document.source import INCLUDES, read_document
from edl6dof.config.model_paths import value_at
from edl6dof.environment.profile_file import profile_path
from edl6dof.environment.terrain import MAP
from edl6dof.scenario.data_files import PROFILES, TABLES


def input_files(plan: Plan) -> list[Path]:
    """Every file that a case of the plan may read, sorted; those that do not exist are left out, as cases
    that name them do not fly.
    """
    found = {MAP}
    files = plan.loaded.document.files
    folder = files[0].resolve().parent if files else Path.cwd()
    for key, path_of in TABLES.items():
        found |= {
            path_of(value_at(model, key))
            for model in (plan.loaded.scenario, plan.loaded.truth)
            if value_at(model, key)
        }
    for model in (plan.loaded.scenario, plan.loaded.truth):
        found |= set(_named(PROFILES, model.atmosphere.profiles, folder))
    exchanged = list(_exchanged(plan))
    for path, value in exchanged:
        found |= set(_named(path, value, folder))
    if exchanged:  # what the new sections leave out takes its default, a table of the package
        found |= set((PACKAGE / "data").rglob("*"))
    found |= {path.with_suffix(".yaml") for path in found if path.suffix == ".npy"}  # what a map is of
    return sorted(path.resolve() for path in found if path.is_file())


def _exchanged(plan: Plan) -> Iterator[tuple[str, Any]]:
    """Dotted path and value of everything but numbers that some cases have instead of what the scenario
    says.
    """
    values = [(target.path, point) for target, points in plan.axes for point in points]
    values += [
        (target.path, item)
        for draw in plan.draws
        for target in draw.targets
        for item in getattr(draw.distribution, "alternatives", [])
    ]
    yield from ((path, value) for path, value in values if isinstance(value, str | Mapping))


def _named(path: str, value: Any, folder: Path) -> Iterator[Path]:
    """The files that a value at a dotted path names, directly or further inside."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _named(f"{path}.{key}", inner, folder)
    elif isinstance(value, str) and value and path in TABLES:
        yield TABLES[path](value)
    elif isinstance(value, str) and path.startswith(f"{PROFILES}."):
        yield profile_path(value)
    elif isinstance(value, str) and path in INCLUDES:
        included = find_include(value, INCLUDES[path], folder)[0]
        if included is not None:
            yield included
            yield from _named(path, read_document(included, {}).data, folder)
