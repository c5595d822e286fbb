"""What somebody else adds to tpsim, with its public names alone."""
