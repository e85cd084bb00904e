"""From a session to an animatable character: `Job(session, out).run_all()`, or `.run(["template", "rig"])`; what is up to date is
not run again. `job.replace("segment", mine)` puts a function of yours in the place of a stage's work.
"""

from .. import _doublet
from .._lazy import lazy_modules
from .options import OPTION_GROUPS, make_options
from .recorded_session import recorded_session

if hasattr(_doublet, "Reconstruction"):  # in a build of all rooms; studies need fewer
    from .job import Job
    from .stages import STAGES

__all__ = ["OPTION_GROUPS", "STAGES", "Job", "make_options", "recorded_session"]
MODULES = ("config", "job", "options", "stages")
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
