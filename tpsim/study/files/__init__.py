"""Files of a study: run folders, trials and models, written once and checked when read."""
