"""Control of an infant by inverse dynamics and by posture, on a model and its data."""
