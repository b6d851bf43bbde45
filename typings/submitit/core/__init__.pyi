from submitit.core import utils as utils
