"""A controller: a spring and a damper that pull a view to zero, and a little joint damping."""

from dataclasses import dataclass

from tpsim import lab


@dataclass(frozen=True)
class Spring:
    """Stiffness [N/m] and damping [Ns/m] along a view; joints are damped by ``still`` [1/s]."""

    view: lab.View
    stiffness: float = 400.0
    damping: float = 60.0
    still: float = 4.0

    def command(self, state, time):
        seen = self.view(state)
        rate = seen.jacobian @ state.dq + seen.drift
        pull = -self.stiffness * seen.value - self.damping * rate
        brake = self.still * state.mass @ state.dq
        return seen.jacobian.T @ pull - brake + state.bias
