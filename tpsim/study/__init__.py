"""Studies: conditions, measures, campaigns, recordings, reports."""
