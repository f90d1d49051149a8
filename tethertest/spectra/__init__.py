"""Lines and events of a channel; what to expect is told, never asked from the solver."""

from tethertest.spectra.drive import fit_drive
from tethertest.spectra.events import find_events, slack_intervals
from tethertest.spectra.lines import find_lines
from tethertest.spectra.orders import ORDERS
from tethertest.spectra.spectrum import Spectrum, spectrum

__all__ = ["ORDERS", "Spectrum", "find_events", "find_lines", "fit_drive", "slack_intervals", "spectrum"]
