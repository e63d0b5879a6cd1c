"""Small errors put into functions: one changed comparison, operator, constant or statement each.

A mutant is the code of one function. It takes the place of the function's own code, so every importer runs it. Left
alone are texts, annotations, defaults, what a ``raise`` says, and compiled kernels, whose code Numba has already read.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.BitOr: ast.BitAnd,
    ast.BitAnd: ast.BitOr,
}
Function = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Mutant:
    """One error in the function ``name`` (its path within the module) of the module at ``path``."""

    path: Path
    file: str
    name: str
    line: int
    change: str
    place: tuple[int, ...]
    number: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line} {self.name}: {self.change}"

    @property
    def key(self) -> str:
        """Of its function."""
        return f"{self.path} {self.name}"

    def code(self) -> CodeType | None:
        """The function's code with the error; None where the module defines the function only while it runs."""
        tree = ast.parse(self.path.read_text(encoding="utf-8"))
        function = _at(tree, self.place)
        assert isinstance(function, Function)
        next(apply for at, (_, apply) in enumerate(_edits(function)) if at == self.number)()
        return _code(compile(ast.fix_missing_locations(tree), str(self.path), "exec"), self.name.split("."))


def probed(path: Path) -> Iterator[tuple[str, CodeType]]:
    """Each function that has mutants, as code that first tells ``builtins.reached`` the function's name."""
    text = path.read_text(encoding="utf-8")
    for name, place in _functions(ast.parse(text)):
        tree = ast.parse(text)
        function = _at(tree, place)
        assert isinstance(function, Function)
        if not _kernel(function):
            told = ast.parse(f"__import__('builtins').reached({str(path)!r}, {name!r})").body
            # Behind the docstring, so that it stays one.
            function.body[ast.get_docstring(function) is not None : 0] = told
            code = _code(compile(ast.fix_missing_locations(tree), str(path), "exec"), name.split("."))
            if code is not None:
                yield name, code


def mutants(path: Path, shown: str) -> Iterator[Mutant]:
    """All mutants of the module's functions, in the order of the text."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    for name, place in _functions(tree):
        function = _at(tree, place)
        assert isinstance(function, Function)
        if not _kernel(function):
            for number, ((node, change), _) in enumerate(_edits(function)):
                yield Mutant(path, shown, name, node.lineno, change, place, number)


def _kernel(function: Function) -> bool:
    return any("compiled" in ast.unparse(one) for one in function.decorator_list)


def _functions(tree: ast.AST, names: tuple[str, ...] = (), place: tuple[int, ...] = ()) -> Iterator[tuple]:
    for number, node in enumerate(getattr(tree, "body", [])):
        if isinstance(node, Function):
            yield ".".join((*names, node.name)), (*place, number)
        elif isinstance(node, ast.ClassDef):
            yield from _functions(node, (*names, node.name), (*place, number))


def _at(tree: ast.AST, place: tuple[int, ...]) -> ast.AST:
    for number in place:
        tree = tree.body[number]  # type: ignore[attr-defined]
    return tree


def _edits(function: Function) -> Iterator[tuple]:
    """What can be changed in the body: ((node, text), a function that changes it)."""
    seen: list[ast.AST] = list(function.body)
    while seen:
        node = seen.pop(0)
        if isinstance(node, ast.Raise | ast.JoinedStr | ast.Assert):
            if isinstance(node, ast.Raise):
                yield (node, "no raise"), lambda n=node: _replace(function, n, ast.Pass())
            continue
        yield from _edits_of(function, node)
        # An annotation computes nothing; ``strict=`` of zip is a second check of lengths that are equal.
        strict = isinstance(node, ast.keyword) and node.arg == "strict"
        seen += [
            child for field, child in _children(node) if field not in ("annotation", "returns") and not strict
        ]


def _children(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    for field, value in ast.iter_fields(node):
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, ast.AST):
                yield field, one


def _edits_of(function: Function, node: ast.AST) -> Iterator[tuple]:
    if isinstance(node, ast.Compare):
        for k, old in enumerate(node.ops):
            new = COMPARISONS[type(old)]
            text = f"{type(old).__name__} -> {new.__name__} in {ast.unparse(node)}"
            yield (node, text), lambda k=k, new=new: node.ops.__setitem__(k, new())
    elif isinstance(node, ast.BinOp | ast.AugAssign) and type(node.op) in OPERATORS:
        new_op = OPERATORS[type(node.op)]
        text = f"{type(node.op).__name__} -> {new_op.__name__} in {ast.unparse(node)}"
        yield (node, text), lambda: setattr(node, "op", new_op())
    elif isinstance(node, ast.BoolOp):
        turned = ast.Or if isinstance(node.op, ast.And) else ast.And
        text = f"{type(node.op).__name__} -> {turned.__name__} in {ast.unparse(node)}"
        yield (node, text), lambda: setattr(node, "op", turned())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield (
            (node, f"without {type(node.op).__name__}: {ast.unparse(node)}"),
            lambda: _replace(function, node, node.operand),
        )
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        value = not node.value if isinstance(node.value, bool) else node.value + 1
        yield (node, f"{node.value} -> {value}"), lambda: setattr(node, "value", value)
    elif isinstance(node, ast.Return) and node.value is not None and not _is_none(node.value):
        yield (
            (node, f"None for {ast.unparse(node.value)}"),
            lambda: setattr(node, "value", ast.Constant(None)),
        )
    elif isinstance(node, ast.Expr) and not isinstance(node.value, ast.Constant | ast.Yield | ast.YieldFrom):
        yield (node, f"without {ast.unparse(node)}"), lambda: _replace(function, node, ast.Pass())
    elif isinstance(node, ast.Break | ast.Continue):
        other: ast.stmt = ast.Continue() if isinstance(node, ast.Break) else ast.Break()
        yield (
            (node, f"{type(node).__name__} -> {type(other).__name__}"),
            lambda: _replace(function, node, other),
        )


def _is_none(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _replace(within: ast.AST, old: ast.AST, new: ast.AST) -> None:
    """Put ``new`` in the place of ``old``."""
    for parent in ast.walk(within):
        for field, value in ast.iter_fields(parent):
            if value is old:
                setattr(parent, field, ast.copy_location(new, old))
                return
            if isinstance(value, list) and any(one is old for one in value):
                value[[one is old for one in value].index(True)] = ast.copy_location(new, old)
                return


def _code(module: CodeType, names: list[str]) -> CodeType | None:
    """The code of the function of this path within the module's code."""
    found: CodeType | None = module
    for name in names:
        assert found is not None
        found = next(
            (one for one in found.co_consts if isinstance(one, CodeType) and one.co_name == name), None
        )
        if found is None:
            return None
    return found
