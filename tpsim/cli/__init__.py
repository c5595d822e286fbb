"""The command line: ``tpsim run``, ``teach``, ``learn``, ``reproduce``, ``push``, ..."""
