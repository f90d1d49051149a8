"""A tour of tethertest in Python; run it from the root of the repository, or cell by cell in an editor."""

# %% A log as it was logged
import matplotlib as mpl
import numpy as np
import pandas as pd

import tethertest as tt

mpl.use("Agg")  # leave this out in a notebook: every plot() returns the axes it drew on

log = tt.read_log("datasets/rig3m/run04/crank.csv")
print(log.format, [channel.name for channel in log.channels])
print(log.to_pandas().head())

# %% A run: its channels in SI, on one clock
run = tt.load_run("datasets/rig3m/run04")
print(run.file.title, run.rig.cable.length, "m")
measured = tt.condition("datasets/rig3m/run04")
print(measured.to_pandas().describe())
measured.plot(kind="tension").figure.savefig("tension.png")

# %% Lines of the drive
analysis = tt.analyze("datasets/rig3m/run04", channels=["tension_top"])
lines = analysis.to_pandas()
print(lines[lines.verdict != "none"])

# %% Measured against replayed
report = tt.report("datasets/rig3m/run04")
print(report.comparison.verdict.value, report.comparison.reasons[0])
print(report.to_pandas()[["name", "channel", "error", "limit", "verdict"]])
report.plot(channel="tension_top").set_xlim(30.0, 35.0)

# %% The solver alone, driven by a motion that you have
time = np.arange(0.0, 6.0, 0.01)
heave = pd.Series(0.1 * np.sin(2.0 * np.pi * 0.5 * time) * np.clip(time, 0.0, 1.0) ** 2, index=time)
scene = tt.Scene(
    name="3 m cable",
    cable=tt.Cable(length=3.0, length_state="equilibrium", mass_per_length=0.05, axial_stiffness=2000.0),
    geometry=tt.Geometry("vertical"),
    bottom=tt.Bottom("measured", "vertical"),
    top=tt.Top("platform", mass=1.5, static_tension=8.0, hover_stiffness=50.0),
    output=tt.Output(duration=5.9, rate=200.0, gauges=(0.0, 0.5, 1.0)),
)
response = tt.solve(scene, measured=heave)
print(response.status.value, f"error {response.error.numerical:.1e}")
print(response.to_pandas().max())

# %% Similitude: any variables, and a rig against its prototype
groups = tt.pi_groups(
    [tt.Variable("F", "N"), tt.Variable("w", "1/s"), tt.Variable("m", "kg"), tt.Variable("l", "m")]
)
print([group.name for group in groups])
similarity = tt.scale("rigs/rig3m.toml", frequency="0.3 Hz", amplitude="0.1 m", mode="soft")
print(similarity.to_pandas()[["name", "ratio", "level"]])
similarity.plot().figure.savefig("similarity.png")
