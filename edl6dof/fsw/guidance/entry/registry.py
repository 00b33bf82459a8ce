"""The entry guidance laws.

A member has one kernel, ``guide(params, plan, onboard, nav, memory, out)``, which returns the bank angle
(rad) that the law demands. ``params``, ``plan`` and ``memory`` belong to the member: its settings, the tables
that its function ``plan(onboard, planned)`` made on the ground, and its memory. ``onboard`` is the on-board
model (``ONBOARD`` record). Range to go, crossrange and the measured drag and lift ratios are in ``out``
before the call. Limits, sign, heading alignment and bank rate are applied after it, in
:mod:`~edl6dof.fsw.guidance.entry.reversal.registry`.
"""

from __future__ import annotations

from edl6dof.fsw.guidance.entry.aim_point import to_target
from edl6dof.fsw.guidance.entry.air_data import AIR_DATA, measure_air
from edl6dof.fsw.guidance.entry.laws import (
    adaptive_hinf,
    bank_profile,
    constant_bank,
    dob_sliding,
    drag_tracking,
    ehgo_fl,
    etpc,
    fl,
    fnpeg,
    ftc_dob,
    npc,
    pd_dob,
    stochastic_pc,
)
from edl6dof.fsw.guidance.entry.reversal.registry import STEERING, steer_bank
from edl6dof.kernels import kernel
from edl6dof.records import record
from edl6dof.registry import Family

ENTRY_LAWS = Family(
    "entry guidance law",
    (
        drag_tracking.MEMBER,
        constant_bank.MEMBER,
        npc.MEMBER,
        fnpeg.MEMBER,
        fl.MEMBER,
        ehgo_fl.MEMBER,
        etpc.MEMBER,
        bank_profile.MEMBER,
        dob_sliding.MEMBER,
        ftc_dob.MEMBER,
        pd_dob.MEMBER,
        adaptive_hinf.MEMBER,
        stochastic_pc.MEMBER,
    ),
)

#: Laws that plan their reversals themselves, and fly them with the reversal logic ``own_sign``.
OWN_REVERSALS = (fnpeg.MEMBER.name, stochastic_pc.MEMBER.name)

ENTRY_MEMORY = record(("air", AIR_DATA), ("law", ENTRY_LAWS.memory), ("steering", STEERING))

wanted_bank = ENTRY_LAWS.role(
    "guide", "params", "plan", "onboard", "nav", "memory", "out", own=("params", "plan", "memory")
)


@kernel
def entry_guidance(entry_law, bank_side, onboard, nav, memory, out):
    """Write the commanded bank angle of the entry law into ``out``; ``memory``: ``ENTRY_MEMORY`` record."""
    out.range_to_go, out.crossrange, out.downrange_to_go = to_target(onboard, nav)
    measure_air(onboard, nav, memory.air)
    air = memory.air
    out.drag_ratio, out.drag_trend, out.lift_ratio = air.drag, air.trend, air.lift
    out.least_bank = onboard.guidance.entry.bank_min
    params = onboard.guidance.entry
    wanted = entry_law(params.law, params, onboard.plan, onboard, nav, memory=memory.law, out=out)
    steer_bank(bank_side, onboard, nav, memory.steering, out, wanted=wanted)
