"""Options as keyword arguments: their names, defaults and explanations come from the C++ options structs."""

from __future__ import annotations

import inspect
import re
import textwrap
from typing import Any, Callable, TypeVar

_Function = TypeVar("_Function", bound=Callable[..., Any])


def option_parameters(options_class: Any) -> list[inspect.Parameter]:
    """Keyword parameters with the defaults of the options."""
    return [inspect.Parameter(option["name"], inspect.Parameter.KEYWORD_ONLY, default=option["default"])
            for option in options_class.describe()]


def _explained(options_class: Any) -> str:
    lines = ["Other Parameters", "----------------"]
    for option in options_class.describe():
        lines.append(f"{option['name']} : optional")
        lines.append(textwrap.fill(option["text"], 110, initial_indent="    ", subsequent_indent="    ",
                                   break_on_hyphens=False, break_long_words=False))
    return "\n".join(lines)


def _with_options(doc: str, options_class: Any) -> str:
    """The docstring with the options after its section "Returns"."""
    sections = re.split(r"\n\n(?=(?:Raises|Notes|Examples)\n-)", doc, maxsplit=1)
    return "\n\n".join([sections[0], _explained(options_class), *sections[1:]])


def takes(options_class: Any) -> Callable[[_Function], _Function]:
    """Puts the options into the signature of a function in place of its **keywords, and into its docstring."""

    def decorate(function: _Function) -> _Function:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        setattr(function, "__signature__",
                signature.replace(parameters=own + option_parameters(options_class)))
        function.__doc__ = _with_options(inspect.cleandoc(function.__doc__ or ""), options_class)
        return function

    return decorate


def give_signature(options_class: Any) -> None:
    """The constructor's signature: a source to copy, and every option."""
    source = inspect.Parameter("source", inspect.Parameter.POSITIONAL_OR_KEYWORD, default=None)
    options_class.__signature__ = inspect.Signature([source, *option_parameters(options_class)])
