"""Published experiments repeated with this simulator; a new study is a file here and a name below."""

from importlib import import_module

from edl6dof.studies.frame import Study

_FILES = (
    *("zheng2015", "yan2016", "wu2013", "lu_bayard", "guidance", "landing", "hazards", "hu2022", "msl"),
    *("newtonian", "schiaparelli"),
)
_ALL = (import_module(f"edl6dof.studies.{name}").STUDY for name in _FILES)
#: Every study by its name, in the order in which they are listed.
STUDIES: dict[str, Study] = {study.name: study for study in _ALL}
