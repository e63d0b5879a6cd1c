"""The checker's own sets of a chaser's possible states after each event, in ball arithmetic."""

from __future__ import annotations

from flint import arb, arb_mat, fmpq

from safestart.proofs.abort.finite import CwhPushed, burning, times
from safestart.proofs.abort.reached import Reached, axes, column, generator, held, shell, speeds, transition
from safestart.proofs.abort.statement import Asked, Event


class Sets:
    """The sets of one statement."""

    def __init__(self, asked: Asked) -> None:
        self.asked, self.n = asked, arb(asked.n)
        self.share, self.angle = arb(asked.share), arb(asked.angle)
        self.pushed = CwhPushed(asked.n)
        self.before: list[Reached] = []
        self.after: list[Reached] = []
        planned = column([arb(e) for e in (asked.earth.before[0] if asked.earth else asked.start)])
        state = self._believed(planned)
        for k, impulse in enumerate(asked.impulses):
            if k:
                over = transition(self.n, arb(asked.times[k] - asked.times[k - 1]))
                if asked.earth is None:
                    planned = over * (planned + self.given(k - 1))
                else:
                    planned = column([arb(e) for e in asked.earth.before[k]])
                state = self._believed(planned) if asked.anew else self.after[-1].moved(over)
            self.before.append(state)
            if asked.durations[k] > 0:
                whole = asked.durations[k]
                made = Event("made", k, fmpq(0), fmpq(0), [], [], (whole, whole))
                self.after.append(burning(asked, state, made, self.pushed))
            else:
                self.after.append(self._burnt(state, impulse, 1 - self.share, self.angle))

    def _believed(self, planned: arb_mat) -> Reached:
        """A planned state with the errors of navigation."""
        state = Reached(planned).grown([arb(e) for e in self.asked.box])
        if self.asked.ellipsoid:
            state.blocks.append([column([arb(e) for e in m]) for m in self.asked.ellipsoid])
        return state

    def given(self, burn: int) -> arb_mat:
        """What a burn without errors adds to the state at its time, in CWH motion."""
        impulse, whole = [arb(e) for e in self.asked.impulses[burn]], arb(self.asked.durations[burn])
        if whole == 0:
            return speeds(impulse)
        return -1 * (held(self.n, -whole) * column([e / whole for e in impulse]))

    def of(self, event: Event) -> Reached:
        """The set of an event at the planned time of its burn."""
        kind, burn, first, last = event.kind, event.burn, event.first, event.last
        if kind == "start":
            return self.before[0]
        if self.asked.durations[burn] > 0:
            return burning(self.asked, self.before[burn], event, self.pushed)
        before, impulse = self.before[burn], self.asked.impulses[burn]
        if kind == "made":
            return self.after[burn]
        if kind == "partial":
            return self._burnt(before, impulse, arb(0), self.angle)
        if kind == "misdirected":
            angle = arb.min(self.angle + arb(self.asked.misdirected), arb.pi())
            return self._burnt(before, impulse, 1 - self.share, angle)
        return (self._late if kind == "late" else self._stuck)(burn, impulse, first, last)

    def detour(self, event: Event) -> arb:
        """Bound on the distance between the actual position during a late or lasting burn and its equivalent state's:
        less than twice the path at its velocity, as |Phi_pv(t)| < 2 t for n t <= 1/2."""
        last, most = arb(event.last), 1 + self.share
        if event.on[1] > 0:
            size = sum((arb(e) ** 2 for e in self.asked.impulses[event.burn]), arb(0)).sqrt()
            (_, late), (_, on) = times(self.asked, event)
            return 2 * arb(late + on) * most * size / arb(self.asked.durations[event.burn]) * arb(on)
        if event.kind not in ("late", "stuck"):
            return arb(0)
        if event.kind == "stuck":
            return 2 * last * last * most * arb(self.asked.acceleration)
        impulse = self.asked.impulses[event.burn]
        return 2 * last * most * sum((arb(e) ** 2 for e in impulse), arb(0)).sqrt()

    def _burnt(
        self, state: Reached, impulse: list[fmpq], least: arb, angle: arb, back: arb_mat | None = None
    ) -> Reached:
        """Add a burn with its errors as blocks, moved by ``back``."""
        along, one, two, size = axes([arb(e) for e in impulse])
        middle, half, across = shell(least, 1 + self.share, angle)

        def lifted(unit: list[arb], length: arb) -> arb_mat:
            added = speeds([length * size * e for e in unit])
            return added if back is None else back * added

        centre = state.centre + lifted(along, middle)
        return Reached(
            centre, [*state.blocks, [lifted(along, half)], [lifted(one, across), lifted(two, across)]]
        )

    def loose(self, size: arb) -> arb:
        """Largest length of the error of a thrust of this size."""
        _, half, across = shell(1 - self.share, 1 + self.share, self.angle)
        return size * (half * half + across * across).sqrt()

    def _rates(self, span: arb) -> list[arb]:
        """Greatest |d/dt Phi(-t) (0, e)| per unit of |e| in each of the six, over all t in the ball ``span``."""
        moving = generator(self.n) * transition(self.n, -span)
        return [sum((arb(moving[k, j].abs_upper()) ** 2 for j in (3, 4, 5)), arb(0)).sqrt() for k in range(6)]

    def _late(self, burn: int, impulse: list[fmpq], first: fmpq, last: fmpq) -> Reached:
        """Phi(-t) (0, v), t in [first, last]: value and tangent in the middle, a box for the second derivative."""
        middle, half = arb((first + last) / 2), arb((last - first) / 2)
        span = middle + arb(0, 1) * half
        back = transition(self.n, -middle)
        state = self._burnt(self.before[burn], impulse, 1 - self.share, self.angle, back)
        scale = shell(1 - self.share, 1 + self.share, self.angle)[0]
        v = speeds([scale * arb(e) for e in impulse])
        a = generator(self.n)
        state.blocks.append([half * (back * (a * v))])
        second = transition(self.n, -span) * (a * (a * v))
        size = sum((arb(e) ** 2 for e in impulse), arb(0)).sqrt()
        loose = self.loose(size)
        rates = self._rates(arb(0.5) * (1 + arb(0, 1)) * arb(last))
        return state.grown(
            [arb((half * half / 2 * second[k, 0]).abs_upper()) + half * loose * rates[k] for k in range(6)]
        )

    def _stuck(self, burn: int, impulse: list[fmpq], first: fmpq, last: fmpq) -> Reached:
        """int_0^s Phi(-t) (0, a) dt, s in [first, last], after the burn: value, tangent, bend; errors of the thrust."""
        middle, half = arb((first + last) / 2), arb((last - first) / 2)
        along, _, _, _ = axes([arb(e) for e in impulse])
        thrust = arb(self.asked.acceleration)
        scale = shell(1 - self.share, 1 + self.share, self.angle)[0]
        push = [scale * thrust * e for e in along]
        after = self.after[burn]
        state = Reached(after.centre - held(self.n, -middle) * column(push), list(after.blocks))
        state.blocks.append([half * (transition(self.n, -middle) * speeds(push))])
        end = arb(last)
        rates = self._rates(end / 2 + arb(0, 1) * end / 2)
        loose = self.loose(thrust)
        errors = [arb(0)] * 3 + [loose * end] * 3
        bend = half * half / 2 * scale * thrust
        return state.grown([errors[k] + (bend + loose * end * end) * rates[k] for k in range(6)])
