"""A vehicle of JSBSim from the text of its file, silent and ready to run."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def version() -> str:
    """Version of the installed module; raises ``ImportError`` when there is none."""
    import jsbsim

    return str(jsbsim.__version__)


def prepare(aircraft: str, step_s: float, properties: Mapping[str, float]) -> Any:
    """The executive of JSBSim with an aircraft (XML), at the state that the ``ic/`` properties describe.

    Further properties are set before the start too, in the order given, such as the rules of integration.
    """
    import jsbsim

    if hasattr(jsbsim, "set_logger"):
        jsbsim.set_logger(jsbsim.DefaultLogger(jsbsim.LogLevel.FATAL))
    jsbsim.FGJSBBase().debug_lvl = 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "aircraft" / "vehicle"
        path.mkdir(parents=True)
        (path / "vehicle.xml").write_text(aircraft, encoding="utf-8")
        executive = jsbsim.FGFDMExec(folder)
        executive.set_debug_level(0)
        executive.load_model("vehicle")
    executive.set_dt(step_s)
    executive.disable_output()
    for name, value in properties.items():
        executive[name] = value
    executive.run_ic()
    return executive
