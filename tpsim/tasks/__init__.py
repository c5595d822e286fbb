"""The built-in tasks, each with its study; they use nothing that a user cannot."""

STUDIES = {
    "cup-and-sugar": "tpsim.tasks.cup_and_sugar.study:cup_and_sugar",
    "cup": "tpsim.tasks.cup_and_sugar.study:cup",
    "sugar": "tpsim.tasks.cup_and_sugar.study:sugar",
    "pointing": "tpsim.tasks.pointing.study:pointing",
    "serve": "tpsim.tasks.serve.study:serve",
    "tracking": "tpsim.tasks.tracking.study:tracking",
    "tracking-left": "tpsim.tasks.tracking.study:left",
    "tracking-right": "tpsim.tasks.tracking.study:right",
    "tracking-compromise": "tpsim.tasks.tracking.study:compromise",
    "transfer": "tpsim.tasks.transfer.study:transfer",
}
"""Built-in studies by their short names, for :func:`tpsim.study.reference.load_study`."""
