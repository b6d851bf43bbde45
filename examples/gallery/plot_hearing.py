"""
What an infant hears, by age
============================

Thresholds of hearing by age, the time between the ears by the size of the head, and the sound of a cup that falls on
the right of an infant, at both of its ears.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc
from mimoc.base.geometry.spherical_head import interaural_time_s

cup = {"name": "cup", "shape": "cylinder", "radius_cm": 3, "length_cm": 6, "at": {"x_cm": -10, "y_cm": -35, "z_cm": 25}}
spec = mimoc.InfantSpec(
    mimoc=1,
    name="listening",
    age_months=6,
    senses={"hearing": {"output": "waveform"}},
    scene={"objects": [cup]},
)
figure, (levels, times, sound) = plt.subplots(1, 3, figsize=(12, 3.4))
for age_months in (0, 3, 6, 24):
    bundle = mimoc.build(spec.with_(age_months=age_months))
    hearing = bundle.manifest.senses.hearing
    levels.semilogx(hearing.threshold_hz, hearing.threshold_db, label=f"{age_months} months")
    azimuths_deg = np.arange(91)
    times.plot(azimuths_deg, 1e6 * interaural_time_s(np.radians(azimuths_deg), hearing.radius_m))
levels.set(xlabel="frequency [Hz]", ylabel="threshold [dB re 20 µPa]", title="What is just heard")
levels.legend()
times.set(xlabel="azimuth [deg]", ylabel="time between the ears [µs]", title="What the head makes of it")

env = mimoc.make(spec)
env.reset(seed=0)
heard = [env.step(0 * env.action_space.sample())[0]["hearing"] for _ in range(40)]
env.close()
waveform = np.concatenate(heard, axis=1)
loudest = int(np.abs(waveform).max(axis=0).argmax())
part = slice(max(loudest - 60, 0), loudest + 40)
ms = np.arange(waveform.shape[1])[part] / hearing.sample_rate_hz * 1000
for ear, name in enumerate(("left ear", "right ear")):
    sound.plot(ms, waveform[ear, part], label=name)
sound.set(xlabel="time [ms]", ylabel="sound pressure [Pa]", title="A cup falls on its right")
sound.legend()
figure.tight_layout()
plt.show()
