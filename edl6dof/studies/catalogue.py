"""All studies, in the order in which they are listed; a new one is a file here and a line below."""

from __future__ import annotations

from edl6dof.studies import (
    guidance,
    hazards,
    hu2022,
    landing,
    lu_bayard,
    msl,
    newtonian,
    schiaparelli,
    wu2013,
    yan2016,
    zheng2015,
)
from edl6dof.studies.frame import Study

STUDIES: dict[str, Study] = {
    one.STUDY.name: one.STUDY
    for one in (
        *(zheng2015, yan2016, wu2013, lu_bayard, guidance, landing, hazards, hu2022, msl, newtonian),
        schiaparelli,
    )
}
