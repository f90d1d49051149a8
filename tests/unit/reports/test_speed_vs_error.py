"""Time at equal error beside MoorDyn, and the pages of targets, peers and stability."""

from __future__ import annotations

from reports.speed_vs_error.peers import PeerRun, PeerScene
from reports.speed_vs_error.tables import peers_page, targets_table
from reports.speed_vs_error.targets import Target
from reports.stability.__main__ import stability_page
from reports.stability.battery import Check

PEERS = PeerScene(
    "taut",
    "closed form",
    (
        PeerRun("plain", 25, 1e-3, 4e-3),
        PeerRun("plain", 100, 5e-3, 3e-4),
        PeerRun("extrapolated", 50, 2e-3, 1e-4),
        PeerRun("MoorDyn", 100, 0.8, 4e-3),
        PeerRun("MoorDyn", 400, 6.0, 2e-4),
        PeerRun("MoorDyn", 800, 20.0, 1e-5),
    ),
)


def test_time_at_equal_error_is_that_of_the_cheapest_run_as_good() -> None:
    assert PEERS.ratios() == ((100, 800.0, "plain", 25), (400, 3000.0, "extrapolated", 50))


def test_pages_say_what_was_asked_and_found() -> None:
    assert "| top | 1 N | 2 N | missed | value |" in targets_table([Target("top", "1 N", "2 N", False)])
    assert "| 400 | 3000 | extrapolated, 50 |" in peers_page([PEERS], "python")
    page = stability_page([Check("long", "bounded", "bounded", True)], "python -m reports.stability")
    assert "Written by `python -m reports.stability`" in page
    assert "| long | bounded | bounded | met |" in page
