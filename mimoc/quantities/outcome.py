"""What came of episodes, also while a policy learns."""

from mimoc.quantities.quantity import Quantity

RETURN = Quantity(
    name="return",
    label="Return of an episode",
    about="mean return of the completed episodes",
    over="episode",
    field="total_reward",
    curve="episode_return",
    steps=("run", "train"),
)
SUCCESS = Quantity(
    name="success",
    label="Share of episodes that succeed",
    about="share of the completed episodes that were successful",
    over="episode",
    field="success",
    curve="success_rate",
    steps=("run", "train"),
    limits=(0.0, 1.0),
)
TIME_TO_SUCCESS = Quantity(
    name="time_to_success_s",
    label="Time to success",
    unit="s",
    about="mean simulated time to success",
    over="episode",
    field="time_to_success_s",
    curve="time_to_success_s",
    steps=("run", "train"),
    limits=(0.0, None),
)
EPISODES = Quantity(
    name="episodes",
    label="Completed episodes",
    about="completed episodes",
    over="episode",
    reduce="count",
    field="steps",
    curve="episodes",
    steps=("run", "train"),
)
EPISODE_STEPS = Quantity(
    name="episode_steps",
    label="Length of an episode",
    unit="control steps",
    about="mean length of the completed episodes",
    over="episode",
    field="steps",
    curve="episode_steps",
    steps=(),
    limits=(0.0, None),
)
TRAINED = Quantity("trained_steps", "Control steps of training", about="of all environments", curve="steps", steps=())
UNFINISHED = Quantity("unfinished", "Unfinished episodes", about="under way at that time", curve="unfinished", steps=())
UNFINISHED_RETURN = Quantity(
    name="unfinished_return",
    label="Their return so far",
    about="not comparable with the return of whole episodes",
    curve="unfinished_return",
    steps=(),
)
UNFINISHED_STEPS = Quantity(
    name="unfinished_steps",
    label="Their length so far",
    unit="control steps",
    about="not comparable with the length of whole episodes",
    curve="unfinished_steps",
    steps=(),
)

LEARNING = (SUCCESS, TIME_TO_SUCCESS, RETURN, EPISODE_STEPS)
"""What is drawn of a learning curve."""
SO_FAR = {RETURN: UNFINISHED_RETURN, EPISODE_STEPS: UNFINISHED_STEPS}
"""What there is so far of episodes that have not ended, by what it will be."""
CURVE = (TRAINED, EPISODES, *LEARNING, UNFINISHED, UNFINISHED_RETURN, UNFINISHED_STEPS)
"""All that a learning curve says, but for the time that it took."""
