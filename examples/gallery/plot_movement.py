"""
From a recording to a figure
============================

`mimoc run --record` keeps where hands, feet and head are, how fast they move, what they touch and what is looked at.
"""

import subprocess
import sys
import tempfile

import matplotlib.pyplot as plt

import mimoc

folder = tempfile.mkdtemp()
infant = mimoc.InfantSpec(mimoc=1, name="kim", age_months=18, senses={}, task={"kind": "reach"})
mimoc.write_bundle(mimoc.build(infant), f"{folder}/kim")
command = f"run {folder}/kim --policy reach --steps 150 --record {folder}/kept"
subprocess.run([sys.executable, "-m", "mimoc", *command.split()], check=True)

for episode in mimoc.read_recording(f"{folder}/kept"):
    plt.plot(episode.time_s, episode.movement["right_hand_speed_m_s"], label=f"reach {episode.number + 1}")
plt.gca().set(xlabel="time [s]", ylabel="speed of the right hand [m/s]")
plt.legend()
plt.show()
