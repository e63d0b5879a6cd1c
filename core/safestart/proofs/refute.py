"""The checker's NO_GO: weighted margins that no thrust history brings above the claim, for every end in question."""

from __future__ import annotations

from flint import arb, arb_mat, fmpq

from safestart.proofs.balls import Motion
from safestart.proofs.statement import Stated
from safestart.proofs.strict import ProofRejected
from safestart.proofs.weights import Weight


def refute(stated: Stated) -> int:
    """Check a NO_GO at the current precision; raise :class:`ProofRejected` if an end is not refuted. Returns 0."""
    Refutation(stated).check()
    return 0


class Refutation:
    """The multipliers of one statement."""

    def __init__(self, stated: Stated) -> None:
        self.stated, self.d, self.dt = stated, stated.d, stated.dt
        self.motion, self.limits = Motion(stated), stated.limits

    def check(self) -> None:
        """Check that every end is refuted; without a row at the end, check only the part's first end."""
        for first, last, weights in self.stated.parts:
            path = [(w, *self._along(w, arb(w.time))) for w in weights if w.time is not None]
            at_end = [w for w in weights if w.time is None]
            for k in range(first, (last if at_end else first) + 1):
                self._end(k, path, at_end)

    def _end(self, k: int, path: list[tuple[Weight, arb, arb_mat]], at_end: list[Weight]) -> None:
        """Weights >= 0 of margins up to T = k dt whose sum no thrust history brings above the claim < 0."""
        horizon = self.dt * k
        counted = [row for row in path if row[0].time is not None and row[0].time <= horizon]
        counted += [(w, *self._along(w, arb(horizon))) for w in at_end]
        total, bound, carried = self._weigh(k, counted)
        bound += (carried * arb_mat(2 * self.d, 1, [arb(e) for e in self.stated.start]))[0, 0]
        claim = arb(self.stated.claim)
        if not (total > 0 and bound < 0 and bound <= claim * total and claim < 0):
            raise ProofRejected(
                f"sum of weighted margins <= margin_m < 0 for every thrust until {float(arb(horizon)):.9g} s: the "
                f"bound is {float(bound):.9g} m over weights {float(total):.9g}, the claim {float(claim):.9g} m"
            )

    def staying(self) -> tuple[arb, arb, arb_mat]:
        """For `stay`: the weights' sum; level and covector (1, 2 d) of a bound level + covector x0 on their margins."""
        (_, last, weights), *_ = self.stated.parts
        return self._weigh(last, [(w, *self._along(w, arb(w.time))) for w in weights if w.time is not None])

    def _weigh(self, k: int, counted: list[tuple[Weight, arb, arb_mat]]) -> tuple[arb, arb, arb_mat]:
        """Weights' sum, level and covector of weighted margins up to T = k dt, under the worst thrust."""
        horizon = self.dt * k
        sorted_in: dict[int, list[tuple[arb, arb_mat]]] = {}
        total = bound = arb(0)
        for weight, level, covector in counted:
            time = horizon if weight.time is None else weight.time
            j = int((time / self.dt).floor())
            sorted_in.setdefault(j, []).append((arb(time - self.dt * j), covector))
            total, bound = total + arb(weight.value), bound + level
        phi, held = self.motion.over(arb(self.dt))
        carried, a_max = arb_mat(1, 2 * self.d), arb(self.stated.a_max)
        for j in reversed(range(k + 1)):
            pull, carried = carried * held, carried * phi
            for s, covector in sorted_in.get(j, []):
                phi_s, held_s = self.motion.over(s)
                pull, carried = pull + covector * held_s, carried + covector * phi_s
            bound += a_max * sum((pull[0, i].abs_upper() ** 2 for i in range(self.d)), arb(0)).sqrt()
        return total, bound, carried

    def _along(self, weight: Weight, time: arb) -> tuple[arb, arb_mat]:
        """Level and covector of a row: value times its margin at the state x is at most level + covector x."""
        value, limits, d, w = arb(weight.value), self.limits, self.d, self.motion.w
        pull, level, scale = [arb(e) for e in weight.pull], value * arb(limits.radius), arb(limits.rest_scale)
        if weight.face == "speed":
            scale = arb(limits.scale)
            return value * scale * arb(limits.most), arb_mat(
                1, 2 * d, [arb(0)] * d + [-scale * e for e in pull]
            )
        if weight.face in self.stated.faces:
            normal, offset = self.stated.faces[weight.face]
            share = value / arb(sum((e * e for e in normal), fmpq(0))).sqrt()
            pull, level = [share * arb(e) for e in normal], share * arb(offset)
        elif weight.face == "hold":
            level += sum((e * arb(h) for e, h in zip(pull, limits.hold or [], strict=True)), arb(0))
        angle = w * time
        c, s = angle.cos(), angle.sin()
        x, y, *z = c * pull[0] - s * pull[1], s * pull[0] + c * pull[1], *pull[2:]
        if weight.face != "rest":
            return level, arb_mat(1, 2 * d, [-x, -y, *(-e for e in z)] + [arb(0)] * d)
        return level, arb_mat(
            1, 2 * d, [scale * w * y, -scale * w * x, *(arb(0) for _ in z), *(-scale * e for e in (x, y, *z))]
        )
