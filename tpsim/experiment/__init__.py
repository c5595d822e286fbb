"""Experiments: recordings, metrics, campaigns, reports and figures."""
