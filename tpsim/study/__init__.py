"""Studies: conditions, measures, runs, recordings, reports."""
