"""The entry guidance laws."""

from __future__ import annotations

from edl6dof.fsw.guidance.entry import constant_bank, drag_tracking
from edl6dof.registry import Family

ENTRY_LAWS = Family(
    "entry guidance law",
    (
        drag_tracking.MEMBER,
        constant_bank.MEMBER,
    ),
)

entry_guidance = ENTRY_LAWS.switch("guide", 4)
