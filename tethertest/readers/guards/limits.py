"""How much a log may ask of this machine: every limit of the readers of containers, with its reason.

A log from a rig stays far below all of them; a file above one is damaged, made to do harm, or must be split.
"""

from __future__ import annotations

from typing import Final

#: decompressed bytes of one gzip or zip member: a day of ten channels at 100 Hz as text; it is held in memory
DECOMPRESSED_BYTES: Final = 2**30
#: decompressed bytes per compressed byte: numbers as text shrink 3 to 20 times, deflate ends at 1032
COMPRESSION_RATIO: Final = 200
#: the ratio is judged from here on: shorter files are harmless, and may well be all zeros [bytes]
RATIO_FROM: Final = 16 * 2**20
#: files in one archive: a run has a few; the list of names alone costs half a kilobyte each
MEMBERS: Final = 10_000
#: bytes of an archive's list of members, before it is read
DIRECTORY_BYTES: Final = MEMBERS * 200
#: numbers in one table of HDF5, MATLAB or MDF: an hour of 27 channels at 1 kHz; 800 MB as float64
CELLS: Final = 100_000_000
#: cells of one worksheet, blanks before the last cell of a row included: Excel's 1,048,576 rows of 19 columns
SHEET_CELLS: Final = 20_000_000
#: bytes of a JSON log: its values as objects take up to 25 times their text
JSON_BYTES: Final = 128 * 2**20
#: lists and objects in a JSON log, each of them a row: half an hour at 1 kHz
JSON_LISTS: Final = 2_000_000
#: columns of one table: a distributed fibre sensor has some thousands of points
COLUMNS: Final = 20_000
#: bytes of one line of a text log, or of blank lines one after the other: the widest table, 50 signs a column
LINE_BYTES: Final = 2**20
#: bytes of a text log among which its layout is looked for
LAYOUT_BYTES: Final = 16 * 2**20
#: groups, structs or lists inside each other: exports have two or three levels
DEPTH: Final = 32
#: objects of one file (groups, data sets, variables, blocks), so that a walk through it ends
OBJECTS: Final = 100_000
#: bytes of one attribute or header text that is read: units and names are short
TEXT_BYTES: Final = 65_536
