"""For the reference: functions of the package that have the name of a wing, which else is shown in their place."""

from __future__ import annotations

import ast
from typing import Any

from griffe import Extension, Function, GriffeLoader, Module, ObjectNode


class Functions(Extension):
    """Keeps `camgen.design`, the function, as `camgen.design_`, and so each whose name a wing has."""

    def __init__(self) -> None:
        super().__init__()
        self._functions: dict[str, Function] = {}

    def on_function_instance(
        self, *, node: ast.AST | ObjectNode, func: Function, **kwargs: Any
    ) -> None:
        """Notes a function before the wing of its name is read."""
        if func.path == f"camgen.{func.name}":
            self._functions[func.name] = func

    def on_module(self, *, mod: Module, loader: GriffeLoader, **kwargs: Any) -> None:
        """Gives the functions back to the package."""
        if mod.path == "camgen":
            mod.members.update({f"{name}_": func for name, func in self._functions.items()})
