"""The flight software: navigation, mission sequence, guidance, attitude control, allocation, pulse
modulation.

Nothing here may import the truth (``edl6dof.vehicle``, ``edl6dof.environment``, ``edl6dof.sensors``) or
receive ``case`` or ``plant``: the records that both sides share are declared in ``edl6dof.interface``. A
contract test checks this. Kernels get the ``onboard`` record (what the flight computer believes), sensor or
navigation data, and their own memory.
"""
