"""Make the synthetic campaign of the 3 m rig: `python datasets/make_rig3m.py`.

The truth is integrated by MoorDyn, the instruments' flaws and noise come from fixed seeds:
the same command writes the same files.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from synthetic.campaign import PLANS
from synthetic.folder import make_run
from synthetic.rig import Rig


def main() -> None:
    """Write the runs asked for."""
    parser = argparse.ArgumentParser(description="Make the synthetic campaign of the 3 m rig.")
    parser.add_argument("--only", nargs="*", metavar="RUN", help="names of runs, such as run07")
    parser.add_argument("--cache", type=Path, help="folder that keeps MoorDyn's signals")
    parser.add_argument("--target", type=Path, default=Path(__file__).parent / "rig3m")
    arguments = parser.parse_args()
    for plan in PLANS:
        if arguments.only and plan.name not in arguments.only:
            continue
        begun = time.perf_counter()
        make_run(plan, Rig(), arguments.target, arguments.cache)
        print(f"{plan.name}  {time.perf_counter() - begun:6.1f} s  {plan.title}", flush=True)


if __name__ == "__main__":
    main()
