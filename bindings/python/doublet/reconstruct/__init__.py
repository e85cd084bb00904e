"""From a session to an animatable character: stages that read and write files, and the record of what is up to date.

`reconstruct(Job(session, out))` runs all of them; `with_stage` puts a function of yours in the place of one.
"""

from .._lazy import lazy_modules
from .job import Job
from .joint_fit import fit_together
from .options import OPTION_GROUPS, make_options
from .running import reconstruct, recorded_session, run_stage, start_record
from .stage import Stage, with_stage
from .stages import STAGES
from .workspace import Workspace

__all__ = [
    "OPTION_GROUPS",
    "STAGES",
    "Job",
    "Stage",
    "Workspace",
    "fit_together",
    "make_options",
    "reconstruct",
    "recorded_session",
    "run_stage",
    "start_record",
    "with_stage",
]
MODULES = (
    "character",
    "config",
    "fit",
    "job",
    "joint_fit",
    "options",
    "results",
    "run_record",
    "running",
    "simulation",
    "stage",
    "stages",
    "workspace",
)
__getattr__, __dir__ = lazy_modules(__name__, MODULES)
