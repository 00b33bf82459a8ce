"""The folder of a study: findings as JSON, the table as Parquet, drawings as PNG."""

from __future__ import annotations

from pathlib import Path

from edl6dof import __version__
from edl6dof.config.document.jsontext import json_text
from edl6dof.config.units import split_unit
from edl6dof.report.matplotlib_figure import write_figure
from edl6dof.studies.study import Report, Study


def write_study(study: Study, report: Report, folder: Path) -> None:
    """Write every file of a study into ``folder``, which exists."""
    (folder / "summary.json").write_text(to_json(study, report), encoding="utf-8")
    write_table(study, report, folder / "runs.parquet")
    for drawing in report.drawings:
        write_figure(drawing, folder / f"{drawing.key}.png")


def to_json(study: Study, report: Report) -> str:
    """Findings as JSON text; what could not be formed is null."""
    return json_text({**study.as_dict(report), "edl6dof_version": __version__})


def write_table(study: Study, report: Report, path: Path) -> None:
    """Write the table of runs as Parquet, the unit of each column in its metadata."""
    import pyarrow.parquet as pq

    schema = report.table.schema
    for index, column in enumerate(schema):
        schema = schema.set(
            index, column.with_metadata({"unit": split_unit(column.name.rpartition(".")[2])[1].label})
        )
    schema = schema.with_metadata(
        {"study": study.name, "source": study.source, "edl6dof_version": __version__}
    )
    pq.write_table(report.table.cast(schema), path, compression="zstd")
