"""What the line analysis is told beforehand: natural frequencies, crank harmonics, lines of the motion."""

from __future__ import annotations

import numpy as np

from tethertest.records.channel import Channel
from tethertest.records.lines import ChannelLines, Expectation
from tethertest.records.run import Run
from tethertest.records.scene import Scene
from tethertest.solver import modes
from tethertest.solver.linear.transfer import tension_transfer
from tethertest.solver.motion import crank_slider

#: highest integer order for which a crank harmonic is stated
_HIGHEST_ORDER = 5
#: crank angles per turn in the Fourier sums
_ANGLES = 720


def crank_displacement_orders(rod_ratio: float) -> dict[int, float]:
    """Return the displacement amplitude of orders 2 and up over order 1, for an in-line crank-slider."""
    angle = 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES
    spectrum = np.abs(np.fft.rfft(crank_slider(1.0, rod_ratio, angle)))
    return {order: float(spectrum[order] / spectrum[1]) for order in range(2, _HIGHEST_ORDER + 1)}


def expectation(
    run: Run, scene: Scene, channel: Channel, frequency: float, motion: ChannelLines | None
) -> Expectation:
    """Return what to expect in one channel.

    Parameters
    ----------
    run : Run
        Its drive says whether there is a crank.
    scene : Scene
        The replayed scene.
    channel : Channel
        Tension or strain at a place on the cable, or the motion itself.
    frequency : float
        Drive frequency as fitted [Hz].
    motion : ChannelLines or None
        Lines of the measured bottom motion.
    """
    orders: dict[str, float] = {}
    ratio = run.rig.drive.rod_ratio
    if run.file.drive.kind == "crank-slider" and ratio is not None:
        displacement = crank_displacement_orders(ratio)
        gain = dict.fromkeys(displacement, 1.0)
        if channel.at is not None and channel.kind in {"tension", "strain"}:
            axis = frequency * np.array([1, *displacement], dtype=np.float64)
            transfer = np.abs(tension_transfer(scene, axis, np.array([channel.at]))[:, 0])
            gain = {order: float(transfer[i + 1] / transfer[0]) for i, order in enumerate(displacement)}
        orders = {str(order): amplitude * gain[order] for order, amplitude in displacement.items()}
    return Expectation(natural_frequencies=modes(scene).frequencies, crank_orders=orders, input_lines=motion)
