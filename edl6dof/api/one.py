"""Functions about one flight, as ``import edl6dof`` offers them: light, what they need is loaded when they
are called.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from edl6dof.api.wording import in_python, scenario_name

if TYPE_CHECKING:
    from edl6dof.api.campaigns import CampaignResult
    from edl6dof.api.flights import Flight, RecordedFlight
    from edl6dof.scenario.loading import LoadedScenario

#: Changes of a scenario: texts ``"dotted.path=value"``; or data by dotted path, or nested as in a file.
Overrides = Iterable[str] | Mapping[str, Any]


def activate(*scenarios: str | Path | LoadedScenario) -> None:
    """Load the plugins of what is to be flown, before the flight software is imported that they join."""
    from edl6dof.plugins import activate

    activate([one for one in scenarios if isinstance(one, str | Path)])


@in_python()
def load(name_or_path: str | Path, overrides: Overrides = ()) -> LoadedScenario:
    """Read and validate a scenario file, or a shipped scenario by name.

    Args:
        name_or_path: ``"scenarios/tianwen1.yaml"`` or ``"tianwen1"``.
        overrides: texts ``"dotted.path=value"``; or a mapping of dotted paths, or nested as in a file.

    Raises:
        ConfigError: with every problem found, each with file, line and key, and what was probably meant.
        TypeError: an argument is of a wrong kind.
    """
    from edl6dof.api.overrides import texts

    name = scenario_name(name_or_path)
    activate(name)
    from edl6dof.scenario.loading import load_scenario

    return load_scenario(name, texts(overrides))


@in_python(save_state="save_at_s")
def fly(
    scenario: LoadedScenario | str | Path | None = None,
    overrides: Overrides = (),
    *,
    out: str | Path | None = None,
    replay: bool = True,
    force: bool = False,
    start: Any = None,
    **options: Any,
) -> Flight:
    """Fly a scenario and return the flight, as ``edl6dof fly`` does.

    Args:
        scenario: file, name of a shipped one, or what :func:`load` returned; none with ``start``.
        overrides: as of :func:`load`, of a scenario that is not loaded yet.
        out: folder to write, as the command does; none if not given.
        replay: whether the 3D replay is among its files.
        force: whether a run that is there may be replaced.
        start: saved state, or its file, to go on from: it brings its scenario.
        options: ``save_at_s``, ``progress`` and more, of :func:`edl6dof.sim.flight.fly`.

    Raises:
        ConfigError: the scenario is wrong, or ``out`` cannot be written.
        TypeError: an argument is of a wrong kind, or there are overrides of a scenario that is loaded.
    """
    if start is not None and scenario is None:
        activate()
        from edl6dof.api.public import continued

        loaded, options["start"] = continued(start, overrides)
    elif scenario is None:
        raise TypeError("name a scenario, such as 'tianwen1', or go on from a saved state with start=")
    else:
        loaded = _loaded(scenario, overrides)
        options["start"] = start
    from edl6dof.api.public import fly as fly_scenario

    flight = fly_scenario(loaded, **options)
    if out is not None:
        flight.save(out, replay=replay, force=force)
    return flight


def _loaded(scenario: LoadedScenario | str | Path, overrides: Overrides) -> LoadedScenario:
    if isinstance(scenario, str | Path):
        return load(scenario, overrides)
    if not hasattr(scenario, "document"):
        scenario_name(scenario)  # which says what it may be
    if overrides:
        raise TypeError("the scenario is loaded already: give the overrides to edl6dof.load")
    return scenario


@in_python()
def open_run(folder: str | Path) -> RecordedFlight | CampaignResult:
    """Open the folder of a flight, or of a campaign: what flying it returned, from its files.

    Args:
        folder: of a run or a campaign.

    Raises:
        ConfigError: it is neither, or a file is missing or damaged.
    """
    if (Path(folder) / "campaign.json").is_file():
        activate(folder)
    from edl6dof.api.public import open_run as open_folder

    return open_folder(folder)


@in_python()
def report(
    run: str | Path | Flight | RecordedFlight | CampaignResult,
    *,
    out: str | Path | None = None,
    pdf: bool = False,
    png: bool = False,
    force: bool = False,
) -> list[Path]:
    """Write the report of a run or a campaign, as ``edl6dof report`` does; returns what was written.

    Args:
        run: its folder, or what :func:`open_run` returned, or :func:`fly` with ``out``.
        out: file to write; ``report.html`` in the folder if not given.
        pdf: write one PDF for papers instead.
        png: write a picture of each figure for papers instead.
        force: whether files that are there may be replaced.

    Raises:
        ConfigError: there is nothing to report on, or a file must not be replaced.
    """
    from edl6dof.api.public import report as write_report

    return write_report(run, out, pdf, png, force)


@in_python(**{"at": "at_s", "from": "start_s", "to": "end_s", "length": "length_s", "tour": "page"})
def replay(
    *runs: str | Path | Flight | RecordedFlight | CampaignResult,
    web: bool = False,
    html: str | Path | None = None,
    screenshot: str | Path | None = None,
    at_s: float | None = None,
    page: str = "",
    video: str | Path | None = None,
    start_s: float | None = None,
    end_s: float | None = None,
    length_s: float | None = None,
    fps: float = 24.0,
    force: bool = False,
) -> list[Path]:
    """Show the 3D replay of runs, or write it, as ``edl6dof replay`` does; returns what was written.

    Args:
        runs: folders, or what :func:`open_run` returned, or :func:`fly` with ``out``; the first may be a
            campaign's.
        web: show it in the browser.
        html: page to write instead.
        screenshot: picture (PNG) to write instead.
        at_s: time of the picture, s.
        page: page in front.
        video: film (MP4) to write instead.
        start_s: first time of the film, s.
        end_s: last time of the film, s.
        length_s: how long the film is, s; as long as the flight, or 60 s, if not given.
        fps: its frames per second.
        force: whether files that are there may be replaced.

    Raises:
        ConfigError: there is no such replay, or the options do not fit together.
        TypeError: no run is named.
    """
    if not runs:
        raise TypeError("name a run, such as 'runs/tianwen1'")
    activate(*(one for one in runs[:1] if isinstance(one, str | Path)))
    from edl6dof.api.public import replay as show_replay

    return show_replay(
        runs,
        web=web,
        html=html,
        screenshot=screenshot,
        at_s=at_s,
        page=page,
        video=video,
        start_s=start_s,
        end_s=end_s,
        length_s=length_s,
        fps=fps,
        force=force,
    )
