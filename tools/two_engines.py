"""Two campaigns of one plan on two engines: case by case, and by distribution.

    python tools/two_engines.py runs/threads runs/gpu

For each figure: in how many cases it is the same bit for bit, the largest difference of a case over the
spread of the figure among the cases, and the probability that the two samples come from one distribution
(two-sample test of Kolmogorov and Smirnov).  Figures of the time before the first event agree case by case;
after it the closed loop makes another flight of the same kind of a difference in the last digit, and
distributions agree.  Exit status 1: a figure whose probability, times the number of figures, is below 1 %.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
from scipy.stats import ks_2samp

from edl6dof.campaign.storage.store import Store

#: Probability, for all figures together, below which two samples are of two distributions.
LEAST = 0.01


def compared(a: pa.Table, b: pa.Table) -> list[tuple[str, int, int, float, float]]:
    """Figure, cases that have it in both, equal ones, largest difference over spread, probability."""
    rows = []
    for name in a.column_names:
        if name == "case" or name.startswith(("truth.", "belief.")) or name not in b.column_names:
            continue
        if not all(pa.types.is_floating(table[name].type) for table in (a, b)):
            continue
        x, y = (np.array(table[name].to_pylist(), dtype=float) for table in (a, b))
        both = np.isfinite(x) & np.isfinite(y)
        if both.sum() < 2:
            continue
        apart, spread = np.max(np.abs(x - y)[both]), np.std(x[both])
        share = 0.0 if apart == 0.0 else float(apart / spread) if spread > 0.0 else np.inf
        probability = float(ks_2samp(x[np.isfinite(x)], y[np.isfinite(y)]).pvalue)
        rows.append((name, int(both.sum()), int(np.sum((x == y)[both])), share, probability))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs=2, type=Path, metavar="FOLDER")
    a, b = (Store(folder) for folder in parser.parse_args().folders)
    if a.plan_text != b.plan_text:
        sys.exit("they fly two plans")
    if not (a.complete and b.complete):
        sys.exit("one of them has not flown to its end")
    rows = compared(a.table().sort_by("case"), b.table().sort_by("case"))
    print(f"{'figure':40} {'cases':>6} {'equal':>6} {'apart':>9} {'p':>8}")
    for name, cases, equal, share, probability in rows:
        print(f"{name:40} {cases:6} {equal:6} {share:9.1e} {probability:8.4f}")
    least, same = (
        min((row[-1] for row in rows), default=1.0) * len(rows),
        sum(row[1] == row[2] for row in rows),
    )
    print(f"least p times {len(rows)} figures: {least:.3f}; {same} figures equal in all cases")
    return 1 if least < LEAST else 0


if __name__ == "__main__":
    sys.exit(main())
