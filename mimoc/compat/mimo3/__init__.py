"""MIMo3's environments on mimoc's runtime: change the import, and keep the program.

Importing this package lets MIMo3's ids be mimoc's:

    >>> import gymnasium
    >>> import mimoc.compat.mimo3
    >>> env = gymnasium.make("MIMoReach-v0", age=9)
    >>> observation, info = env.reset(seed=0)
    >>> env.unwrapped.infant.age_months
    9.0

What a program imports from anywhere in `mimo_infant` is here, by the same name.
"""

from mimoc.compat.mimo3 import mimo_utils as mimo_utils
from mimoc.compat.mimo3.environment import MIMoEnv as MIMoEnv
from mimoc.compat.mimo3.keywords import (
    BENCHMARK_XML as BENCHMARK_XML,
    BENCHMARK_XML_V2 as BENCHMARK_XML_V2,
    CATCH_XML as CATCH_XML,
    DEFAULT_PROPRIOCEPTION_PARAMS as DEFAULT_PROPRIOCEPTION_PARAMS,
    DEFAULT_TOUCH_PARAMS as DEFAULT_TOUCH_PARAMS,
    DEFAULT_TOUCH_PARAMS_V2 as DEFAULT_TOUCH_PARAMS_V2,
    DEFAULT_VESTIBULAR_PARAMS as DEFAULT_VESTIBULAR_PARAMS,
    DEFAULT_VISION_PARAMS as DEFAULT_VISION_PARAMS,
    REACH_XML as REACH_XML,
    ROLL_OVER_XML as ROLL_OVER_XML,
    SCENE_DIRECTORY as SCENE_DIRECTORY,
    SELFBODY_XML as SELFBODY_XML,
    STANDUP_XML as STANDUP_XML,
)
from mimoc.compat.mimo3.modules import (
    ActuationModel as ActuationModel,
    MuscleModel as MuscleModel,
    PositionalModel as PositionalModel,
    SimpleProprioception as SimpleProprioception,
    SimpleVestibular as SimpleVestibular,
    SimpleVision as SimpleVision,
    SpringDamperModel as SpringDamperModel,
    TrimeshTouch as TrimeshTouch,
)
from mimoc.compat.mimo3.tasks import (
    MIMoCatchEnv as MIMoCatchEnv,
    MIMoDummyEnv as MIMoDummyEnv,
    MIMoMuscleDummyEnv as MIMoMuscleDummyEnv,
    MIMoReachEnv as MIMoReachEnv,
    MIMoRollOverEnv as MIMoRollOverEnv,
    MIMoSelfBodyEnv as MIMoSelfBodyEnv,
    MIMoStandupEnv as MIMoStandupEnv,
    MIMoV2DummyEnv as MIMoV2DummyEnv,
    register_ids,
)

register_ids()
