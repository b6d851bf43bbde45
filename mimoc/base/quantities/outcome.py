"""What came of episodes, also while a policy learns."""

from functools import partial

from mimoc.base.quantities.quantity import Quantity

_of_episodes = partial(Quantity, over="episode", steps=("run", "train"))

RETURN = _of_episodes(
    "return",
    "Return of an episode",
    about="mean return of the completed episodes",
    field="total_reward",
    curve="episode_return",
)
SUCCESS = _of_episodes(
    "success", "Share of episodes that succeed", about="of the completed ones", curve="success_rate", limits=(0.0, 1.0)
)
TIME_TO_SUCCESS = _of_episodes(
    "time_to_success_s", "Time to success", "s", "mean simulated time", curve="time_to_success_s", limits=(0.0, None)
)
EPISODES = _of_episodes(
    "episodes",
    "Completed episodes",
    about="number of episodes that ended",
    reduce="count",
    field="steps",
    curve="episodes",
)

_of_learning = partial(Quantity, over="episode", steps=())

EPISODE_STEPS = _of_learning(
    "episode_steps",
    "Length of an episode",
    "control steps",
    "mean length of the completed episodes",
    curve="episode_steps",
    limits=(0.0, None),
)
TRAINED = _of_learning("trained_steps", "Control steps of training", about="of all environments", curve="steps")
UNFINISHED = _of_learning("unfinished", "Unfinished episodes", about="under way at that time", curve="unfinished")
UNFINISHED_RETURN = _of_learning(
    "unfinished_return", "Their return so far", about="not that of whole ones", curve="unfinished_return"
)
UNFINISHED_STEPS = _of_learning(
    "unfinished_steps", "Their length so far", "control steps", "not that of whole ones", curve="unfinished_steps"
)

LEARNING = (SUCCESS, TIME_TO_SUCCESS, RETURN, EPISODE_STEPS)  # What is drawn of a learning curve.
SO_FAR = {RETURN: UNFINISHED_RETURN, EPISODE_STEPS: UNFINISHED_STEPS}
"""What there is so far of episodes that have not ended, by what it will be."""
CURVE = (TRAINED, EPISODES, *LEARNING, UNFINISHED, UNFINISHED_RETURN, UNFINISHED_STEPS)
"""All that a learning curve says, but for the time that it took."""
