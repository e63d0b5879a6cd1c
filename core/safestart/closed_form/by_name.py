"""The closed forms by name: the sound certificate, and the conditions of paper 000, which are not sound."""

from __future__ import annotations

from typing import Literal

from safestart.closed_form import certified, paper
from safestart.model.scenario import Bools, Floats, Grid, Rest, Scenario

ClosedForm = Literal["certified", "paper"]


def go_of(name: ClosedForm, scenario: Scenario, points: Floats, rest: Rest = Rest.LVLH) -> Bools:
    """Whether the closed form says GO to starts at rest (..., 2) or (..., 3), body frame, m; (...)."""
    if name == "paper":
        return paper.certify(scenario, points, rest).safe
    return certified.certify(scenario, points, rest).go


def map_of(
    name: ClosedForm, scenario: Scenario, grid: Grid, rest: Rest = Rest.LVLH
) -> certified.CertifiedMap | paper.MapCertificate:
    """Margin (m), mask (GO) and the corridor's cells of a grid, (ny, nx), and the share of GO in the corridor."""
    find = paper.certify_grid if name == "paper" else certified.certify_grid
    return find(scenario, grid, rest)
