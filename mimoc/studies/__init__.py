"""Studies done with mimoc: the experiments of its paper, and trials of motor milestones and of movement."""
