"""The commands, each a module with `register(commands)`, which adds its parser."""

from . import (
    animate,
    edit,
    edit_character,
    evaluate,
    export_cloth,
    import_calibration,
    new_session,
    reconstruct,
    scan,
    stages,
    study,
    synthesize,
    train_body,
    view,
)

#: In the order of the help.
COMMANDS = (
    reconstruct,
    stages,
    new_session,
    import_calibration,
    scan,
    edit,
    edit_character,
    animate,
    view,
    export_cloth,
    evaluate,
    study,
    synthesize,
    train_body,
)
