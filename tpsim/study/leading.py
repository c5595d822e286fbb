"""Leads that begin where a site is by itself: off the way that it goes undisturbed."""

from dataclasses import replace

import numpy as np

from tpsim.errors import ArgumentError
from tpsim.study.condition import Condition, Lead
from tpsim.study.record import Record
from tpsim.world.rollout import RECORD_PERIOD


def led_off(twin: Record, lead: Lead) -> Condition:
    """The condition of an undisturbed trial with a site led off the way that it goes by itself.

    Parameters
    ----------
    twin : Record
    lead : Lead
        Its origin is of no account.
    """
    names = {site: name for name, site in twin.task.sites().items()}
    own = twin[f"{names[lead.site]}_position"][twin.trial.time >= lead.start - 1e-9]
    steps = round((lead.duration + lead.rest) / RECORD_PERIOD) + 1
    if len(own) < steps:
        raise ArgumentError(
            f"a lead of {lead.duration + lead.rest:g} s from {lead.start:g} s on goes beyond "
            f"the trial, which ends at {twin.trial.time[-1]:.2f} s"
        )
    way = () if np.ptp(own, axis=0).max() < 1e-3 else tuple(map(tuple, own[:steps].tolist()))
    lead = replace(lead, origin=tuple(own[0].tolist()), carried=way)
    return replace(twin.condition, lead=(lead,))
