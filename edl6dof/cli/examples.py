"""Examples at the end of each command's help."""

from __future__ import annotations

EXAMPLES: dict[str, tuple[str, ...]] = {
    "fly": (
        "edl6dof fly tianwen1",
        "edl6dof fly tianwen1 --out runs/heavy --set vehicle.mass.entry_kg=1350",
        "edl6dof fly tianwen1 --out runs/first --save-state 300",
        "edl6dof fly --from runs/first/state.npz --out runs/second",
    ),
    "check": ("edl6dof check my.yaml", "edl6dof check my.yaml my_mc.yaml --set seed=3"),
    "trust": ("edl6dof trust my_law.py", "edl6dof trust received/scenario.yaml"),
    "scenarios": ("edl6dof scenarios", "edl6dof scenarios tianwen1 > mine.yaml"),
    "params": ("edl6dof params vehicle.parachutes", "edl6dof params bank_rate"),
    "schema": ("edl6dof schema > edl6dof.schema.json",),
    "replay": (
        "edl6dof replay runs/tianwen1",
        "edl6dof replay runs/tianwen1 --html flight.html",
        "edl6dof replay runs/tianwen1 --screenshot entry.png --at 120",
        "edl6dof replay runs/tianwen1 --tour --video flight.mp4",
    ),
    "report": ("edl6dof report runs/tianwen1", "edl6dof report runs/tianwen1_mc --pdf"),
    "plot": (
        "edl6dof plot runs/tianwen1 truth.mach truth.height_m",
        "edl6dof plot runs/tianwen1 'truth.rate_*' --from 60 --to 280",
        "edl6dof plot runs/tianwen1 truth.height_m --against truth.mach --out x.pdf",
    ),
    "compare": ("edl6dof compare runs/tianwen1 runs/heavy", "edl6dof compare runs/a_mc runs/b_mc --json"),
    "export": ("edl6dof export runs/tianwen1 --format csv", "edl6dof export runs/tianwen1 - --nesc"),
    "verify": ("edl6dof verify", "edl6dof verify kepler tumbling --plots plots"),
    "validate": ("edl6dof validate", "edl6dof validate viking1_mc -n 1000"),
    "figures": (
        "edl6dof figures tianwen1 -n 30",
        "edl6dof figures tianwen1 --set vehicle.mass.entry_kg=1350",
    ),
    "calibrate": (
        "edl6dof calibrate tianwen1",
        "edl6dof fly runs/calibration-tianwen1/calibrated.yaml --out runs/calibrated",
    ),
    "study": ("edl6dof study", "edl6dof study guidance --only fnpeg --only etpc -n 100"),
    "campaign": (
        "edl6dof campaign tianwen1_mc -n 1000",
        "edl6dof campaign --resume runs/tianwen1_mc",
        "edl6dof campaign tianwen1_mc --until 'p_success +- 0.5%'",
    ),
    "covariance": ("edl6dof covariance tianwen1_mc", "edl6dof covariance tianwen1_mc --at touchdown"),
    "refly": ("edl6dof refly runs/tianwen1_mc 17",),
    "faults": (
        "edl6dof faults tianwen1",
        "edl6dof faults tianwen1 --out runs/map --kinds all --at 'every 10 s'",
        "edl6dof faults tianwen1 --out runs/sensors --sensors",
    ),
    "serve": ("edl6dof serve tianwen1", "edl6dof serve tianwen1_mc --port 4242"),
    "version": ("edl6dof version",),
    "entry": (
        "edl6dof design entry msl --out plan.yaml",
        "edl6dof design entry msl --minimise dispersion",
    ),
    "landing": ("edl6dof design landing tianwen1 --divert-m 600 --figure landing.png",),
}


def examples(command: str) -> str:
    """What stands below the options of a command's help, a line for each example."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in EXAMPLES[command])
