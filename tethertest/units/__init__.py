"""Text with units at the edges, bare SI inside: the only place that imports pint."""

from tethertest.units.channels import KINDS, Kind, UnitScale, channel_scale
from tethertest.units.dimensions import dimension_of
from tethertest.units.text import Quantity, format_quantity, parse_quantity

__all__ = [
    "KINDS",
    "Kind",
    "Quantity",
    "UnitScale",
    "channel_scale",
    "dimension_of",
    "format_quantity",
    "parse_quantity",
]
