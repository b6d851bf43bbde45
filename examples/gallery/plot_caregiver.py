"""
A caregiver's answers
=====================

An infant kicks, and the caregiver over it smiles .4 s later, unless it has just done so. At the right is what the
infant sees of a smile.
"""

import matplotlib.pyplot as plt
import numpy as np

import mimoc

answers = {"to": "kick", "by": ["smile"], "delay_ms": 400, "pause_ms": 1500}
senses = {"vision": {"width_px": 96, "height_px": 96, "acuity": "off"}}
scene = {"caregiver": {"distance_cm": 30, "answers": answers}}
env = mimoc.make(mimoc.InfantSpec(mimoc=1, name="answered", age_months=4, senses=senses, scene=scene))
observation, _ = env.reset(seed=0)
caregiver = env.unwrapped.caregiver
names = [env.unwrapped.model.actuator(int(index)).name for index in env.unwrapped.actuation.actuators]
legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names], np.float32)
lengths, smiles, seen = [], [], None
for step in range(400):
    observation = env.step(legs if step % 120 > 60 else -legs)[0]
    lengths.append(100 * np.mean(caregiver.infant.leg_lengths_m(env.unwrapped.data)))
    smiles.append(caregiver.expression == "happy")
    seen = observation["eye_left"] if smiles[-1] else seen
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5), width_ratios=(2, 1), layout="constrained")
times = 0.01 * np.arange(400)
left.plot(times, lengths, label="hip to foot, mean of both legs")
left.fill_between(times, min(lengths), max(lengths), where=smiles, alpha=0.2, label="smile")
left.set_xlabel("time [s]")
left.set_ylabel("length [cm]")
left.legend()
right.imshow(seen)
right.set_axis_off()
plt.show()
