"""Go-no-go as a process: its two documents, what each method says of one start and of many, what it refuses."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import pytest

from safestart.errors import InvalidInput
from safestart.processes.go_no_go import atlases
from safestart.processes.go_no_go.method_registry import METHODS, decide_by
from safestart.processes.go_no_go.methods import plain
from safestart.processes.go_no_go.one_start import ONE_START, GoNoGoAnswer
from safestart.processes.go_no_go.run import answer
from safestart.processes.go_no_go.spec import GoNoGoInputs, GoNoGoOutputs
from safestart.runtime.progress import Context

POINT: dict[str, Any] = {"omega_t_deg_s": 2, "a_max_m_s2": 0.05}
PLANE = [{"x_m": x, "y_m": y} for x, y in ((9.364, 81.044), (0, 40), (200, 20), (5.1, 33.3))]
SPACE = [state | {"z_m": z} for state, z in zip(PLANE, (0, 7.7, -3, 60), strict=True)]
NOT_TAKEN = sorted(GoNoGoInputs.model_fields.keys() - plain.KNOWN)


@pytest.fixture(autouse=True)
def no_atlas_yet(monkeypatch: pytest.MonkeyPatch) -> None:
    """Atlases that other tests left in memory would answer in the place of the solver."""
    monkeypatch.setattr(atlases, "_kept", OrderedDict())


def asked(**inputs: Any) -> dict[str, Any]:
    return answer(GoNoGoInputs.model_validate(POINT | inputs), Context()).document()


HELD = {"question": "synchronize", "after_arrival": "hold"}


@pytest.mark.parametrize("more", [{}, {"method": "exact", "proofs": True}, HELD])
def test_the_documents_are_their_models_field_by_field(more: dict[str, Any]) -> None:
    found = answer(GoNoGoInputs.model_validate(POINT | {"states": PLANE[:1]} | more), Context())
    # What a hold after the end is said of is asked for by name.
    absent = {"proof_url"} if more == HELD else {"proof_url", "hold_after"}
    assert list(found.document()) == [name for name in GoNoGoOutputs.model_fields if name not in absent]
    flat = found.document_of_one()
    assert list(flat) == [name for name in GoNoGoAnswer.model_fields if name not in absent]
    GoNoGoAnswer.model_validate(flat)
    assert flat["face_margins_m"] == dict(
        zip(found.document()["faces"], found.document()["face_margins_m"][0], strict=True)
    )


@pytest.mark.parametrize("states", [PLANE, SPACE], ids=["plane", "space"])
@pytest.mark.parametrize("rest", ["lvlh", "body"])
@pytest.mark.parametrize("method", METHODS)
def test_a_start_alone_as_among_others(method: str, rest: str, states: list[dict[str, Any]]) -> None:
    """Margins and proofs to the last bit, sentences to the letter."""
    more = {"method": method, "rest": rest, "proofs": METHODS[method].proves}
    together = asked(states=states, **more)
    for k, state in enumerate(states):
        alone = asked(states=[state], **more)
        for name, column in alone.items():
            if isinstance(column, list) and name != "faces":
                assert column == together[name][k : k + 1], name
            else:
                assert column == together[name], name


def test_the_methods_can_be_found() -> None:
    for name in METHODS:
        assert callable(decide_by(name))
        assert f"{name}: {METHODS[name].text}." in ONE_START.parameters["method"].text


@pytest.mark.parametrize("name", NOT_TAKEN)
@pytest.mark.parametrize("method", ["certified", "paper", "closed_form"])
def test_the_closed_forms_refuse_what_they_do_not_know(name: str, method: str) -> None:
    more = {name: "synchronize" if name == "question" else 0.001}
    with pytest.raises(InvalidInput, match=f"where {name} is given") as refused:
        asked(states=PLANE, method=method, **more)
    assert refused.value.field == "method"


def test_defaults_that_are_given_ask_for_nothing() -> None:
    given = {name: GoNoGoInputs.model_fields[name].default for name in NOT_TAKEN}
    assert len(given) >= 11
    for method in METHODS:
        assert asked(states=PLANE, method=method, **given) == asked(states=PLANE, method=method)


@pytest.mark.parametrize("rest", ["lvlh", "body"])
def test_the_papers_conditions_certify_nothing(rest: str) -> None:
    """They are not sound, so their sentence says that they hold, not that the start is certified."""
    found = asked(states=PLANE, method="paper", rest=rest)
    held = [reason for word, reason in zip(found["verdict"], found["reason"], strict=True) if word == "GO"]
    assert held != []
    assert all(reason.startswith("the paper's conditions hold with ") for reason in held)
    assert [reason for reason in found["reason"] if "certif" in reason or "prove" in reason] == []
